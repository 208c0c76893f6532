"""Convex parts as pure geometry: rotations, corners, surfaces, insides. NumPy and SciPy only."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from maniskill_taskgrasp.assets.objects.model import Part

Array = NDArray[np.float64]

CIRCLE_CORNERS = 32  # Corners that stand for a circle when a round part is turned into points.
MAX_CORNERS = 64  # Of a convex part: the GPU back end's limit.
MAX_GROWTH = 1.03  # By which a part of few corners may outgrow the shape it stands for.
CANDIDATES_PER_POINT = 24  # Surface samples that each evenly spread point is chosen from.


def quat_to_matrix(quat_wxyz: ArrayLike) -> Array:
    """(3, 3) rotation of a unit quaternion, w first."""
    w, x, y, z = np.asarray(quat_wxyz, dtype=float)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def matrix_to_quat(matrix: ArrayLike) -> tuple[float, float, float, float]:
    """Unit quaternion, w first and not negative, of a (3, 3) rotation."""
    m = np.asarray(matrix, dtype=float)
    # Shepperd's method in its symmetric form: the eigenvector is never badly conditioned.
    k = np.array(
        [
            [m.trace(), m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [0, m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [0, 0, m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]],
            [0, 0, 0, m[2, 2] - m[0, 0] - m[1, 1]],
        ]
    )
    q = np.linalg.eigh(k, UPLO="U")[1][:, -1]
    q = -q if q[0] < 0 else q
    return (float(q[0]), float(q[1]), float(q[2]), float(q[3]))


def rotation_between(start: ArrayLike, end: ArrayLike) -> Array:
    """(3, 3) shortest rotation that takes direction `start` to direction `end`."""
    a = np.asarray(start, dtype=float) / np.linalg.norm(start)
    b = np.asarray(end, dtype=float) / np.linalg.norm(end)
    cross, cosine = np.cross(a, b), float(a @ b)
    if cosine < -1 + 1e-12:
        side = np.eye(3)[np.argmin(np.abs(a))]
        axis = np.cross(a, side) / np.linalg.norm(np.cross(a, side))
        return 2 * np.outer(axis, axis) - np.eye(3)
    k = np.array([[0, -cross[2], cross[1]], [cross[2], 0, -cross[0]], [-cross[1], cross[0], 0]])
    return np.eye(3) + k + k @ k / (1 + cosine)


def part_corners(part: Part, circle: int = CIRCLE_CORNERS) -> Array:
    """(n, 3) [m] points whose convex hull is the part, in the frame the part is placed in."""
    return _local_corners(part, circle) @ quat_to_matrix(part.quat_wxyz).T + part.position


def _local_corners(part: Part, circle: int) -> Array:
    if part.kind == "box":
        return np.array(part.size) * _CUBE
    if part.kind == "cylinder":
        radius, half = part.size
        ring = _ring(circle) * radius
        return np.concatenate([np.insert(ring, 0, x, axis=1) for x in (-half, half)])
    if part.kind == "sphere":
        return _ball(circle) * part.size[0]
    if part.kind == "capsule":
        radius, half = part.size
        ball = _ball(circle) * radius
        low, high = ball[ball[:, 0] <= 0], ball[ball[:, 0] > 0]
        return np.concatenate([low - np.array([half, 0, 0]), high + np.array([half, 0, 0])])
    assert part.vertices is not None
    return part.vertices


_CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


@lru_cache(maxsize=8)
def _ring(n: int) -> Array:
    angle = (np.arange(n) + 0.5) * 2 * np.pi / n  # A facet, not an edge, faces each axis.
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


@lru_cache(maxsize=8)
def _ball(n: int) -> Array:
    """(m, 3) unit sphere, n points along a great circle and m about n^2 / 5."""
    m = n * n // 5
    i = np.arange(m) + 0.5  # Fibonacci lattice: even without poles.
    polar, turn = np.arccos(1 - 2 * i / m), np.pi * (1 + 5**0.5) * i
    sine = np.sin(polar)
    return np.stack([np.cos(turn) * sine, np.sin(turn) * sine, np.cos(polar)], axis=1)


def parts_bounds(parts: Sequence[Part]) -> Array:
    """(2, 3) [m] lower and upper corner of the parts' axis-aligned box; round parts exact."""
    boxes = []
    for part in parts:
        rotation = quat_to_matrix(part.quat_wxyz)
        if part.kind == "box":
            reach = np.abs(rotation) @ np.array(part.size)
        elif part.kind == "sphere":
            reach = np.full(3, part.size[0])
        elif part.kind == "capsule":
            reach = np.abs(rotation[:, 0]) * part.size[1] + part.size[0]
        elif part.kind == "cylinder":
            along = np.abs(rotation[:, 0])
            reach = along * part.size[1] + np.sqrt(np.clip(1 - along**2, 0, 1)) * part.size[0]
        else:
            corners = part_corners(part)
            boxes.append([corners.min(0), corners.max(0)])
            continue
        boxes.append([part.position - reach, part.position + reach])
    stacked = np.array(boxes)
    return np.stack([stacked[:, 0].min(0), stacked[:, 1].max(0)])


def depth_inside(part: Part, points: Array) -> Array:
    """(n,) [m] how deep each point lies inside the part; negative outside, where it is a bound."""
    local = (points - part.position) @ quat_to_matrix(part.quat_wxyz)
    if part.kind == "box":
        return (np.array(part.size) - np.abs(local)).min(1)
    if part.kind == "sphere":
        return part.size[0] - np.linalg.norm(local, axis=1)
    if part.kind == "capsule":
        radius, half = part.size
        local[:, 0] -= np.clip(local[:, 0], -half, half)
        return radius - np.linalg.norm(local, axis=1)
    if part.kind == "cylinder":
        radius, half = part.size
        return np.minimum(half - np.abs(local[:, 0]), radius - np.hypot(local[:, 1], local[:, 2]))
    planes = part.hull[1]
    return -(local @ planes[:, :3].T + planes[:, 3]).max(1)


def local_hull(part: Part) -> tuple[Array, Array]:
    """Triangles (m, 3, 3) [m] and outward planes (k, 4) of a part before it is placed."""
    from scipy.spatial import ConvexHull  # 0.1 s to import; primitives never need it.

    corners = _local_corners(part, CIRCLE_CORNERS)
    hull = ConvexHull(corners)
    return corners[hull.simplices], np.unique(hull.equations.round(9), axis=0)


def part_triangles(part: Part) -> Array:
    """(m, 3, 3) [m] triangles of the part's surface (winding not defined), placed."""
    return part.hull[0] @ quat_to_matrix(part.quat_wxyz).T + part.position


def spread_points(parts: Sequence[Part], n: int, seed: int) -> NDArray[np.float32]:
    """(n, 3) float32 [m] points on the outside of the parts' union, evenly spread.

    Random area-weighted samples, without those inside another part, thinned by taking the
    farthest sample from all taken so far.
    """
    rng = np.random.default_rng(seed)
    triangles = [part_triangles(part) for part in parts]
    owner = np.repeat(np.arange(len(parts)), [len(t) for t in triangles])
    corners = np.concatenate(triangles)
    edge_u, edge_v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.linalg.norm(np.cross(edge_u, edge_v), axis=1)
    picked = rng.choice(len(corners), CANDIDATES_PER_POINT * n, p=area / area.sum())
    u, v = rng.random((2, len(picked), 1))
    flip = u + v > 1
    u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
    points = corners[picked, 0] + u * edge_u[picked] + v * edge_v[picked]
    outside = np.ones(len(points), dtype=bool)
    for index, part in enumerate(parts):
        own = owner[picked] == index
        points[own] = _onto_surface(part, points[own])
    for index, part in enumerate(parts):
        outside &= (owner[picked] == index) | (depth_inside(part, points) < 1e-4)
    points = points[outside] if outside.sum() >= n else points
    return _farthest(points, n).astype(np.float32)


def _onto_surface(part: Part, points: Array) -> Array:
    """Points of a round part's facets (n, 3) moved out to the round surface itself."""
    if part.kind not in ("sphere", "capsule", "cylinder"):
        return points
    rotation, radius = quat_to_matrix(part.quat_wxyz), part.size[0]
    local = (points - part.position) @ rotation
    axis = np.zeros_like(local)
    if part.kind != "sphere":
        axis[:, 0] = np.clip(local[:, 0], -part.size[1], part.size[1])
    out = local - axis
    length = np.linalg.norm(out, axis=1, keepdims=True)
    # The end discs of a cylinder are flat already.
    side = np.abs(local[:, :1]) < part.size[1] - 1e-9 if part.kind == "cylinder" else length > 0
    moved = np.where(side, axis + out * radius / np.maximum(length, 1e-12), local)
    placed: Array = moved @ rotation.T + part.position
    return placed


def _farthest(points: Array, n: int) -> Array:
    """(n, 3) of the points, each the farthest from those before it; the first is the outermost."""
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(0), axis=1)))]
    distance = np.linalg.norm(points - points[chosen[0]], axis=1)
    while len(chosen) < n:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return points[chosen]


def few_corners(points: Array, count: int = MAX_CORNERS, outgrow: float = np.inf) -> Array:
    """(m <= count, 3) [m] corners whose convex hull has nearly the shape and volume of the points'.

    Args:
        points: (n, 3) [m] not all in one plane.
        outgrow: [m] by which the corners may stand outside the points' hull to make up for volume.
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    corners = points[hull.vertices]
    if len(corners) <= count:
        return corners
    middle, size = (corners.min(0) + corners.max(0)) / 2, np.ptp(corners, axis=0)
    i = np.arange(count) + 0.5
    polar, turn = np.arccos(1 - 2 * i / count), np.pi * (1 + 5**0.5) * i
    sine = np.sin(polar)
    directions = np.stack([np.cos(turn) * sine, np.sin(turn) * sine, np.cos(polar)])
    # Corners farthest in directions spread over the shape stretched to a cube: flat things keep
    # their rims.
    chosen = corners[np.unique(np.argmax((corners - middle) / size @ directions, axis=0))]
    farthest = float(np.linalg.norm(chosen - middle, axis=1).max())
    most = min(MAX_GROWTH, 1 + outgrow / farthest)
    grow = min((hull.volume / ConvexHull(chosen).volume) ** (1 / 3), most)
    kept: Array = middle + (chosen - middle) * grow
    return kept
