"""An object's surface as small flat patches in cells: coarse to search, fine to measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.geometry import depth_inside, part_triangles
from maniskill_taskgrasp.assets.objects.model import ObjectModel, Part

Array = NDArray[np.float64]

CELLS = 64
CELL_PATCHES = 48
SAMPLES = 6144  # Patches on the faces of all parts, hidden ones too, of which cells are made.
EDGE_STEP = 0.004  # [m] between patches on sharp edges, which random points of the faces miss.
SHARP = 0.9  # Cosine between the normals of two faces below which their edge is sharp.
HIDDEN = 1e-4  # [m] deeper than this inside another part, a point is not on the surface.
OVERHANG = 5e-4  # [m] by which a patch may stick out of its part before it is made smaller.


@dataclass(frozen=True)
class Surface:
    """Patches of an object's collision surface, object frame."""

    centres: NDArray[np.float32]
    """(CELLS, 3) [m]"""
    patches: NDArray[np.float32]
    """(CELLS, CELL_PATCHES, 3, 3) [m] middle and two half axes of the patches nearest each
    centre; on a sharp edge the second half axis is zero, and small cells repeat their patches."""


_surfaces: dict[int, tuple[ObjectModel, Surface]] = {}


def surface_of(model: ObjectModel) -> Surface:
    """The surface of a model; made once for each."""
    if id(model) not in _surfaces:  # The model is kept too, so its id stays its own.
        _surfaces[id(model)] = model, make_surface(model.parts)
    return _surfaces[id(model)][1]


def make_surface(parts: Sequence[Part], seed: int = 0) -> Surface:
    """Cells of patches on the outside of the union of convex parts."""
    rng = np.random.default_rng(seed)
    triangles = [part_triangles(part) for part in parts]
    found = [*_on_faces(triangles, rng), *(_on_edges(part) for part in triangles)]
    owner = np.repeat([*range(len(parts))] * 2, [len(patches) for patches in found])
    patches = np.concatenate(found)
    outside = np.ones(len(patches), dtype=bool)
    for index, part in enumerate(parts):
        outside &= (owner == index) | (depth_inside(part, patches[:, 0]) < HIDDEN)
    if outside.any():
        patches, owner = patches[outside], owner[outside]
    few = patches[:: max(1, len(patches) // (16 * CELLS)), 0]
    centres = few[_farthest(few[None], CELLS)[0]]
    apart = (centres**2).sum(1) - 2 * patches[:, 0] @ centres.T  # Squared distance, but for |p|^2.
    chosen = _cells(patches[:, 0], apart.argmin(1))
    patches, owner = patches[chosen], owner[chosen]
    for index, part in enumerate(parts):
        patches[owner == index] = _within(part, patches[owner == index])
    return Surface(centres.astype(np.float32), patches.astype(np.float32))


def _on_faces(triangles: list[Array], rng: np.random.Generator) -> list[Array]:
    """(n, 3, 3) patches spread evenly over the area, for each part."""
    corners = np.concatenate(triangles)
    owner = np.repeat(np.arange(len(triangles)), [len(t) for t in triangles])
    edge_u, edge_v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.linalg.norm(np.cross(edge_u, edge_v), axis=1) / 2
    # One sample in each of equal slices of the area: evener than independent ones.
    slices = (np.arange(SAMPLES) + rng.random(SAMPLES)) / SAMPLES
    picked = np.searchsorted(np.cumsum(area) / area.sum(), slices).clip(max=len(area) - 1)
    u, v = rng.random((2, SAMPLES, 1))
    flip = u + v > 1
    u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
    points = corners[picked, 0] + u * edge_u[picked] + v * edge_v[picked]
    half_width = np.sqrt(area.sum() / (CELLS * CELL_PATCHES)) / 2
    along = _unit(edge_u[picked])
    across = edge_v[picked]
    across = _unit(across - (across * along).sum(1, keepdims=True) * along)
    patches = np.stack([points, half_width * along, half_width * across], axis=1)
    return [patches[owner[picked] == index] for index in range(len(triangles))]


def _within(part: Part, patches: Array) -> Array:
    """Patches (n, 3, 3) of a part, those smaller that reach beyond the edge of their face."""
    out = np.arange(len(patches))
    for _ in range(3):
        middle, first, second = patches[out].swapaxes(0, 1)
        tips = [middle + a * first + b * second for a in (-1, 1) for b in (-1, 1)]
        depth = depth_inside(part, np.concatenate(tips)).reshape(4, -1).min(0)
        out = out[depth < -OVERHANG]
        patches[out, 1:] /= 2
    return patches


def _on_edges(triangles: Array) -> Array:
    """(n, 3, 3) patches along the sharp edges of a convex part."""
    edges = _sharp_edges(triangles)
    length = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    pieces = np.maximum(1, np.ceil(length / EDGE_STEP)).astype(int)
    edge = np.repeat(np.arange(len(edges)), pieces)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    half_axis = ((edges[:, 1] - edges[:, 0]) / (2 * pieces)[:, None])[edge]
    middle = edges[edge, 0] + (2 * number[:, None] + 1) * half_axis
    return np.stack([middle, half_axis, np.zeros_like(middle)], axis=1)


def _sharp_edges(triangles: Array) -> Array:
    """(n, 2, 3) [m] ends of the edges of a convex part between faces of different direction."""
    corners, faces = np.unique(triangles.reshape(-1, 3).round(7), axis=0, return_inverse=True)
    faces = faces.reshape(-1, 3)
    normals = _unit(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    outward = triangles[:, 0] - corners.mean(0)
    normals *= np.sign((outward * normals).sum(1, keepdims=True))
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    of_face = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    sides, of_face = sides[order], of_face[order]
    twice = np.nonzero((sides[1:] == sides[:-1]).all(1))[0]
    cosine = (normals[of_face[twice]] * normals[of_face[twice + 1]]).sum(1)
    return np.asarray(corners[sides[twice[cosine < SHARP]]])


def _unit(vectors: Array) -> Array:
    """(n, 3) of length 1; zero stays zero."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True).clip(min=1e-12))


def _cells(points: Array, cell_of: NDArray[np.int64]) -> NDArray[np.int64]:
    """(CELLS, CELL_PATCHES) evenly spread points (n, 3) of each cell."""
    size = int(np.bincount(cell_of, minlength=CELLS).max())
    members = np.zeros((CELLS, max(size, CELL_PATCHES)), dtype=np.int64)
    for cell in range(CELLS):
        members[cell] = np.resize(np.nonzero(cell_of == cell)[0], members.shape[1])
    chosen = _farthest(points[members], CELL_PATCHES)
    return np.take_along_axis(members, chosen, axis=1)


def _farthest(groups: Array, count: int) -> NDArray[np.int64]:
    """(g, count) indices into points (g, n, 3): each the farthest from those before it."""
    chosen = np.zeros((len(groups), count), dtype=np.int64)
    rows = np.arange(len(groups))
    outward = groups - groups.mean(1, keepdims=True)
    chosen[:, 0] = (outward**2).sum(-1).argmax(1)
    gap = np.full(groups.shape[:2], np.inf)
    for i in range(1, count):
        away = groups - groups[rows, chosen[:, i - 1], None]
        np.minimum(gap, np.einsum("gni,gni->gn", away, away), out=gap)
        chosen[:, i] = gap.argmax(1)
    return chosen
