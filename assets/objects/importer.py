"""A user's mesh turned into an object on equal terms with the catalogue's."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.affordance import describe, middle_box
from maniskill_taskgrasp.assets.objects.closeness import remarks
from maniskill_taskgrasp.assets.objects.decompose import (
    MAX_DRAWN_FACES,
    convex_parts,
    mend,
)
from maniskill_taskgrasp.assets.objects.geometry import part_corners
from maniskill_taskgrasp.assets.objects.meshfile import SUFFIXES, RawMesh, read_mesh
from maniskill_taskgrasp.assets.objects.model import ObjectModel, Part
from maniskill_taskgrasp.assets.objects.recipe import FRICTION
from maniskill_taskgrasp.assets.objects.settle import settled_poses, steady_stands
from maniskill_taskgrasp.assets.objects.solid import thinned, union_mesh
from maniskill_taskgrasp.assets.objects.stable import candidate_poses
from maniskill_taskgrasp.errors import InputError, echo

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

DENSITY = 300.0  # [kg/m^3] of hollow household things; used when no mass is given.
MIN_MASS, MAX_MASS = 0.001, 5.0  # [kg] what a user may give.
MAX_GUESS = 1.0  # [kg] the data set's cap, also of a guessed mass.
MAX_NAME = 60
ASKEW = 0.85  # Share of the axis-aligned box's volume below which the smallest box is taken.
FORMAT = 3  # Raised when the stored form of imported objects changes.


@dataclass(frozen=True)
class Origin:
    """Where a mesh comes from, and whose it is."""

    source: str
    licence: str = "not stated"
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    """Direction in the file that points up when the thing stands."""


def object_from_mesh(
    raw: RawMesh, name: str, mass: float | None, origin: Origin
) -> tuple[ObjectModel, tuple[str, ...]]:
    """The object and notes on what was assumed.

    Raises:
        InputError: the mesh cannot be cut into parts, or rests in no pose.
    """
    notes = [raw.note]
    mesh = mend(raw.mesh)
    if len(mesh.faces) < 4:
        raise InputError(f"{echo(name)} has too few faces with an area to enclose anything")
    placing = _object_frame(mesh)
    mesh.apply_transform(placing)
    drawn = thinned(raw.mesh.copy(), MAX_DRAWN_FACES)
    drawn.apply_transform(placing)
    parts = _parts(mesh, name)
    notes += remarks(mesh, parts)
    closed = bool(mesh.is_volume)
    body = mesh if closed else _union(parts)
    if not closed:
        notes.append("mesh not closed: volume and inertia are those of its convex parts")
    if mass is None:
        mass = float(np.clip(DENSITY * body.volume, MIN_MASS, MAX_GUESS))
        notes.append(f"mass {mass:.3f} kg guessed at {DENSITY:.0f} kg/m^3, at most {MAX_GUESS} kg")
    model = _described(name, mesh, body, parts, mass, _upright(placing[:3, :3], origin))
    model = replace(
        model, source=origin.source, licence=origin.licence, watertight=closed, mesh=lambda: drawn
    )
    return _rested(model), tuple(notes)


def _described(
    name: str,
    mesh: trimesh.Trimesh,
    body: trimesh.Trimesh,
    parts: tuple[Part, ...],
    mass: float,
    upright: Array,
) -> ObjectModel:
    """The object by its shape; `body` is the closed one whose volume counts.

    Raises:
        InputError: a mass that no hand can take.
    """
    if not MIN_MASS <= mass <= MAX_MASS:
        raise InputError(f"mass {mass} kg: from {MIN_MASS} to {MAX_MASS} kg would do")
    com, unit_inertia = body.center_mass, body.moment_inertia / body.volume
    held_center, held = middle_box(mesh, com)
    points = np.concatenate([mesh.vertices, _corners(parts)])
    return ObjectModel(
        name=name,
        extents_m=_triple(mesh.extents),
        mass_kg=mass,
        com=com,
        inertia=unit_inertia * mass,
        friction=FRICTION["plastic"],
        rigidity="rigid",
        affordance=describe(name, held.tolist(), mass, points),
        split="imported",
        parts=parts,
        resting_poses=tuple(candidate_poses(parts, com, unit_inertia, upright)),
        grasped_center=_triple(held_center),
        grasped_extents_m=_triple(held),
        material="plastic",
        category="imported",
        volume_m3=float(body.volume),
    )


def _triple(row: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in row)
    return x, y, z


def _parts(mesh: trimesh.Trimesh, name: str) -> tuple[Part, ...]:
    try:
        parts = convex_parts(mesh)
    except Exception as error:  # CoACD and Qhull raise anything.
        raise InputError(
            f"cannot cut {echo(name)} into convex parts: {type(error).__name__}"
        ) from None
    if not parts:
        raise InputError(f"{echo(name)} encloses no volume")
    return parts


def _rested(model: ObjectModel) -> ObjectModel:
    """The model with the poses and stands that physics keeps."""
    (poses,) = settled_poses([model])
    if not poses:
        raise InputError(f"{echo(model.name)} stays in no pose on a table")
    model = replace(model, resting_poses=poses)
    (stands,) = steady_stands([model])
    return replace(model, stands=stands)


def _object_frame(mesh: trimesh.Trimesh) -> Array:
    """(4, 4) from the file's frame to the object's.

    The file's axes are kept where its box is nearly the smallest; a mesh lying askew is turned.
    """
    rotation = np.eye(3)
    box = mesh.bounding_box_oriented
    if box.volume < ASKEW * np.prod(mesh.extents):
        rotation = np.asarray(box.primitive.transform)[:3, :3].T
    order = np.argsort(-np.ptp(mesh.vertices @ rotation.T, axis=0).round(5), kind="stable")
    rotation = rotation[order]
    if np.linalg.det(rotation) < 0:
        rotation[2] *= -1
    turned = mesh.vertices @ rotation.T
    placing = np.eye(4)
    placing[:3, :3] = rotation
    placing[:3, 3] = -(turned.min(0) + turned.max(0)) / 2
    return placing


def _upright(rotation: Array, origin: Origin) -> Array:
    """(3, 3) design frame to object frame: the first column is the file's up direction."""
    up = rotation @ np.array(origin.up)
    side = np.eye(3)[int(np.argmin(np.abs(up)))]
    face = np.cross(up, side) / np.linalg.norm(np.cross(up, side))
    return np.stack([up, np.cross(face, up), face], axis=1)


def _union(parts: Sequence[Part]) -> trimesh.Trimesh:
    import trimesh

    hulls = [trimesh.Trimesh(part_corners(part)).convex_hull for part in parts]
    return union_mesh([(hull.vertices, hull.faces) for hull in hulls])


def _corners(parts: Sequence[Part]) -> Array:
    return np.concatenate([part_corners(part) for part in parts])


def plain_name(path: Path) -> str:
    """Object name of a file: its stem in lower case, words apart."""
    words = re.sub(r"[^0-9a-z-]+", " ", path.stem.lower()).strip(" -")
    return words[:MAX_NAME] or "unnamed"


def mesh_files(folder: Path) -> Iterator[Path]:
    """Mesh files in a folder and below, in order."""
    yield from sorted(p for p in folder.rglob("*") if p.suffix.lower() in SUFFIXES and p.is_file())


def fingerprint(path: Path, units: str | None, mass: float | None) -> str:
    """Key that changes with the file's content and with how it is read."""
    digest = hashlib.sha256(path.read_bytes())
    digest.update(f"|{units}|{mass}|{FORMAT}".encode())
    return digest.hexdigest()[:32]


def import_file(
    path: Path, units: str | None = None, mass: float | None = None, name: str | None = None
) -> tuple[ObjectModel, tuple[str, ...]]:
    """Object made from a mesh file; nothing is stored.

    Raises:
        InputError: one line that says what is wrong with the file and what would do.
    """
    raw = read_mesh(path, units)
    return object_from_mesh(raw, name or plain_name(path), mass, Origin(source=path.name))
