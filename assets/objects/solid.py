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
        return np.ptp(np.concatenate([p.vertices for p in self.pieces]), axis=0)

    @property
    def grasped_box(self) -> tuple[Array, Array]:
        """Centre and extents [m] of what people grasp: the held pieces, else all."""
        held = [p.vertices for p in self.pieces if p.grasped] or [p.vertices for p in self.pieces]
        points = np.concatenate(held)
        return (points.min(0) + points.max(0)) / 2, np.ptp(points, axis=0)


def assemble(pieces: Sequence[Piece]) -> Solid:
    """Pieces moved into the object frame: centred, axes sorted by extent, right-handed."""
    points = np.concatenate([p.vertices for p in pieces])
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
    """Volume [m^3], centre of mass (3,) [m] and inertia (3, 3) [m^2] of 1 kg, of the union."""
    import trimesh

    meshes = [trimesh.Trimesh(p.vertices, p.faces) for p in solid.pieces]
    union = trimesh.boolean.union(meshes, engine="manifold") if len(meshes) > 1 else meshes[0]
    volume = float(union.volume)
    return volume, union.center_mass, union.moment_inertia / volume
