"""Pieces put together: the object frame, the coloured mesh, and the mesh's mass properties."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.pieces import Piece

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solid:
    """An assembled object in the object frame."""

    pieces: tuple[Piece, ...]
    design_to_object: Array
    """(3, 3) rotation; its first column is where the design's +x (up when standing) points."""

    @property
    def extents(self) -> Array:
        """(3,) [m] of all pieces along x, y, z."""
        return np.ptp(solid_points(self.pieces), axis=0)

    @property
    def grasped_box(self) -> tuple[Array, Array]:
        """Centre and extents [m] of what people grasp: the held pieces, else all."""
        held = [p for p in self.pieces if p.grasped]
        points = np.concatenate([p.vertices for p in held]) if held else solid_points(self.pieces)
        return (points.min(0) + points.max(0)) / 2, np.ptp(points, axis=0)


def solid_points(pieces: Sequence[Piece]) -> Array:
    """(n, 3) [m] corners of all pieces but drawn labels, whose thickness is only ink."""
    return np.concatenate([p.vertices for p in pieces if p.parts])


def assemble(pieces: Sequence[Piece]) -> Solid:
    """Pieces moved into the object frame: centred, axes sorted by extent, right-handed."""
    points = solid_points(pieces)
    extents = np.ptp(points, axis=0)
    # Nearly equal extents keep their order, so that a tie does not turn the object.
    order = np.argsort(-extents.round(5), kind="stable")
    rotation = np.eye(3)[order]
    if np.linalg.det(rotation) < 0:
        rotation[2] *= -1
    centre = (points.min(0) + points.max(0)) / 2
    moved = tuple(p.at(*(-centre)).rotated(rotation) for p in pieces)
    return Solid(moved, rotation)


def to_mesh(solid: Solid) -> trimesh.Trimesh:
    """Coloured mesh of all pieces, each of them closed."""
    import trimesh

    meshes = []
    for piece in solid.pieces:
        mesh = trimesh.Trimesh(piece.vertices, piece.faces, process=False)
        colour = trimesh.visual.color.hex_to_rgba(piece.colour)
        mesh.visual = trimesh.visual.ColorVisuals(mesh, face_colors=[colour] * len(piece.faces))
        meshes.append(mesh)
    joined: trimesh.Trimesh = trimesh.util.concatenate(meshes)  # type: ignore[assignment]
    return joined


def mass_properties(solid: Solid) -> tuple[float, Array, Array]:
    """Volume [m^3], centre of mass (3,) [m] and inertia (3, 3) [m^2] of 1 kg, of the union.

    Drawn labels, which no part stands for, do not count.
    """
    union = union_mesh([(p.vertices, p.faces) for p in solid.pieces if p.parts])
    volume = float(union.volume)
    return volume, union.center_mass, union.moment_inertia / volume


def union_mesh(bodies: Sequence[tuple[Array, NDArray[np.int64]]]) -> trimesh.Trimesh:
    """One surface around closed bodies (vertices, faces) that may overlap."""
    import trimesh

    meshes = [trimesh.Trimesh(vertices, faces) for vertices, faces in bodies]
    if len(meshes) == 1:
        return meshes[0]
    return trimesh.boolean.union(meshes, engine="manifold")


def thinned(mesh: trimesh.Trimesh, faces: int) -> trimesh.Trimesh:
    """The mesh with at most about that many faces."""
    if len(mesh.faces) <= faces:
        return mesh
    return mesh.simplify_quadric_decimation(face_count=faces)
