"""A mesh file read with suspicion: what is not a graspable solid is refused in one line."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.meshheader import promise
from maniskill_taskgrasp.errors import InputError, echo

if TYPE_CHECKING:
    import trimesh

SUFFIXES = (".stl", ".obj", ".ply", ".glb", ".gltf", ".off", ".3mf")
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
MAX_BYTES = 150_000_000  # Read nothing larger: some 3 million triangles.
MAX_FACES = 2_000_000
MIN_SIZE, MAX_SIZE = 0.005, 1.0  # [m] longest extent of what a hand can take.
MIN_THICKNESS = 0.0005  # [m] thinner is a surface, not a solid.
GREY = (150, 155, 165, 255)
IN_METRES = (".glb", ".gltf")  # Their specification says so.


@dataclass(frozen=True)
class RawMesh:
    """A mesh as read, scaled to metres."""

    mesh: trimesh.Trimesh
    units: str
    note: str
    """How the units came to be known."""


def read_mesh(path: Path, units: str | None = None) -> RawMesh:
    """Read a mesh file of any format in `SUFFIXES` and scale it to metres.

    Args:
        units: "m", "cm" or "mm"; None infers them from the size, and the note says so.

    Raises:
        InputError: not a file, not a mesh, empty, non-finite, flat, too large, or of a size that
            no hand can take.
    """
    if units is not None and units not in UNITS:
        raise InputError(f"unknown units {echo(units)}: m, cm or mm would do")
    mesh = read_surface(path)
    longest = float(mesh.extents.max())
    if units is not None:
        note = f"units {units} as given"
    else:
        units, note = infer_units(longest, path.suffix.lower())
    size = longest * UNITS[units]
    if not MIN_SIZE <= size <= MAX_SIZE:
        raise InputError(
            f"{echo(path.name)} is {_readable(size)} long ({note}): from {_readable(MIN_SIZE)} to "
            f"{_readable(MAX_SIZE)} would do; give --units m, cm or mm if they were misread"
        )
    mesh.apply_scale(UNITS[units])
    thin = _thickness(mesh.vertices)
    if thin < MIN_THICKNESS:
        raise InputError(
            f"{echo(path.name)} is {_readable(thin)} thick: a solid of at least "
            f"{_readable(MIN_THICKNESS)} would do"
        )
    return RawMesh(mesh, units, note)


def read_surface(path: Path) -> trimesh.Trimesh:
    """The mesh of a file of any format in `SUFFIXES`, in the file's own units.

    Raises:
        InputError: not a file, not a mesh, empty, non-finite, flat or too large.
    """
    check_file(path)
    mesh = _load(path)
    _check_geometry(mesh, path)
    mesh.merge_vertices()
    return mesh


def infer_units(longest: float, suffix: str) -> tuple[str, str]:
    """Units that make the longest extent that of a thing for the hand, and the reasoning."""
    if suffix in IN_METRES:
        return "m", f"units m, as {suffix} files are"
    units = "m" if longest <= 1.0 else "cm" if longest <= 40.0 else "mm"
    return units, f"units {units} inferred from a longest extent of {longest:.4g}"


def check_file(path: Path) -> None:
    """Refuse without reading it what is no mesh file, or one cut short or too large.

    Raises:
        InputError: one of these.
    """
    if not path.is_file():
        raise InputError(f"no mesh file {echo(path.name)} in {echo(path.parent)}")
    shown = echo(path.name)
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"{shown} is no mesh file: {', '.join(SUFFIXES)} would do")
    size = path.stat().st_size
    if size == 0:
        raise InputError(f"{shown} is empty")
    promised = promise(path)
    if promised is not None and promised.least_bytes > size:
        raise InputError(
            f"{shown} is cut short or no mesh: its header promises {promised.faces:,} faces, so "
            f"{promised.least_bytes:,} bytes at least, and {size:,} are there"
        )
    if promised is not None and promised.faces > MAX_FACES:
        raise _too_many(path, promised.faces)
    if size > MAX_BYTES:
        raise InputError(
            f"{shown} has {size / 1e6:.0f} MB: at most {MAX_BYTES / 1e6:.0f} MB would do; "
            "simplify it first"
        )


def _too_many(path: Path, faces: int) -> InputError:
    return InputError(
        f"{echo(path.name)} has {faces:,} faces: at most {MAX_FACES:,} would do; simplify it first"
    )


def _load(path: Path) -> trimesh.Trimesh:
    import trimesh

    try:
        # Unprocessed: trimesh would drop vertices that are no numbers without a word.
        mesh = coloured_mesh(trimesh.load_scene(path, process=False))
    except MemoryError:
        raise InputError(f"{echo(path.name)} needs more memory than there is") from None
    except Exception as error:  # Readers of damaged files raise anything.
        first = str(error).strip().splitlines()[:1]
        detail = f" ({first[0][:80]})" if first else ""
        raise InputError(f"cannot read {echo(path.name)} as a mesh{detail}") from None
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise InputError(f"{echo(path.name)} holds no triangles")
    return mesh


def coloured_mesh(scene: Any) -> Any:
    """All triangles of a trimesh scene as one mesh with a colour a face; None if there are none."""
    import trimesh

    meshes = []
    for geometry in scene.dump():
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            plain = trimesh.Trimesh(geometry.vertices, geometry.faces, process=False)
            colour = np.asarray(_main_colour(geometry), dtype=np.uint8)
            plain.visual = trimesh.visual.ColorVisuals(
                plain, face_colors=np.tile(colour, (len(plain.faces), 1))
            )
            meshes.append(plain)
    return trimesh.util.concatenate(meshes) if meshes else None


def _main_colour(geometry: Any) -> Any:
    """RGBA of a mesh's material or vertices, a plain grey where it has none."""
    visual = geometry.visual
    if visual is None or not visual.defined:
        return GREY
    material = getattr(visual, "material", None)
    return visual.main_color if material is None else material.main_color


def _check_geometry(mesh: trimesh.Trimesh, path: Path) -> None:
    shown = echo(path.name)
    if len(mesh.faces) > MAX_FACES:
        raise _too_many(path, len(mesh.faces))
    if mesh.faces.max() >= len(mesh.vertices) or mesh.faces.min() < 0:
        raise InputError(f"{shown} has faces of vertices that do not exist")
    mesh.remove_unreferenced_vertices()
    with np.errstate(over="ignore", invalid="ignore"):
        longest = np.ptp(mesh.vertices, axis=0).max()
    if not np.isfinite(longest):
        raise InputError(f"{shown} has vertices that are not finite numbers")
    if longest <= 0 or _thickness(mesh.vertices) <= 1e-6 * longest:
        raise InputError(f"{shown} is flat: a solid would do")
    if mesh.area <= 0:
        raise InputError(f"{shown} has no face with an area: a solid would do")


def _thickness(points: NDArray[np.float64]) -> float:
    """Least extent of points (n, 3), along an axis of the file or across the best plane."""
    extents = np.ptp(points, axis=0)
    unit = (points - points.mean(axis=0)) / extents.max()
    normal = np.linalg.eigh(unit.T @ unit)[1][:, 0]
    return float(min(extents.min(), np.ptp(unit @ normal) * extents.max()))


def _readable(metres: float) -> str:
    for unit, size in (("km", 1000.0), ("m", 1.0), ("cm", 0.01)):
        if metres >= size:
            return f"{metres / size:.3g} {unit}"
    return f"{metres / 0.001:.3g} mm"
