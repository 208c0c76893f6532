"""The vocabulary that objects are built from: coloured solids that know their collision parts.

Every maker centres its solid on the origin of the design frame unless it says otherwise; `at`
and `turn` then place it. Lengths are metres, angles degrees, colours "#rrggbb".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from maniskill_taskgrasp.assets.objects.geometry import (
    matrix_to_quat,
    quat_to_matrix,
    rotation_between,
)
from maniskill_taskgrasp.assets.objects.lathe import lathe_mesh, lathe_sections
from maniskill_taskgrasp.assets.objects.model import Part

Array = NDArray[np.float64]
Point = tuple[float, float, float]

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
SIDES = 40  # Facets around a drawn circle.
MAX_ROUNDING = 0.0024  # [m] of a drawn box: the corners of its collision box stick out < 2 mm.


@dataclass(frozen=True)
class Piece:
    """A closed coloured solid and the convex parts that stand for it in physics."""

    vertices: Array
    """(n, 3) [m]"""
    faces: NDArray[np.int64]
    """(m, 3), outward winding."""
    colour: str
    parts: tuple[Part, ...]
    grasped: bool = False
    """True: part of what people grasp, whose extents the data set states."""

    def at(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Piece:
        """The piece shifted."""
        shift = np.array([x, y, z])
        parts = tuple(replace(p, position=_point(p.position + shift)) for p in self.parts)
        return replace(self, vertices=self.vertices + shift, parts=parts)

    def rotated(self, rotation: Array) -> Piece:
        """The piece turned about the origin by a (3, 3) rotation."""
        parts = tuple(
            replace(
                p,
                position=_point(rotation @ p.position),
                quat_wxyz=matrix_to_quat(rotation @ quat_to_matrix(p.quat_wxyz)),
            )
            for p in self.parts
        )
        return replace(self, vertices=self.vertices @ rotation.T, parts=parts)

    def turn(self, axis: Point, degrees: float) -> Piece:
        """The piece turned about an axis through the origin."""
        half = np.radians(degrees) / 2
        x, y, z = np.sin(half) * np.array(axis) / np.linalg.norm(axis)
        return self.rotated(quat_to_matrix((np.cos(half), x, y, z)))

    def along(self, axis: Point) -> Piece:
        """The piece turned so that its +x points along the axis."""
        return self.rotated(rotation_between(X, axis))

    def held(self) -> Piece:
        """The piece marked as what people grasp."""
        return replace(self, grasped=True)

    def seen_only(self) -> Piece:
        """The piece without collision: a label or a thin wire, within 2 mm of other parts."""
        return replace(self, parts=())


def _point(values: ArrayLike) -> Point:
    x, y, z = np.asarray(values, dtype=float)
    return (float(x), float(y), float(z))


def box(x: float, y: float, z: float, colour: str, rounding: float = 0.0) -> Piece:
    """Cuboid with extents x, y, z; `rounding` is the radius of its drawn edges."""
    half = np.array([x, y, z]) / 2
    part = Part("box", size=_point(half))
    radius = min(rounding, MAX_ROUNDING, *(half * 0.95))
    if radius <= 0:
        corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * half
        return convex(corners, colour, part)
    steps = np.linspace(0, np.pi / 2, 4)
    eighth = [
        (np.cos(p) * np.cos(t), np.cos(p) * np.sin(t), np.sin(p)) for p in steps for t in steps
    ]
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    points = [(half - radius + radius * np.array(e)) * s for s in signs for e in eighth]
    return convex(np.array(points), colour, part)


def convex(points: ArrayLike, colour: str, part: Part | None = None) -> Piece:
    """Convex hull of points (n, 3) [m]; its collision part is itself unless one is given."""
    from scipy.spatial import ConvexHull

    cloud = np.unique(np.asarray(points, dtype=float).round(7), axis=0)
    hull = ConvexHull(cloud)
    index = np.full(len(cloud), -1)
    index[hull.vertices] = np.arange(len(hull.vertices))
    vertices, faces = cloud[hull.vertices], index[hull.simplices]
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Piece(vertices, faces, colour, (part or Part("convex", vertices=vertices),))


def rod(radius: float, length: float, colour: str) -> Piece:
    """Straight cylinder along x."""
    half = length / 2
    return turned([(-half, radius), (half, radius)], colour)


def ball(radius: float, colour: str) -> Piece:
    """Sphere."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, SIDES // 2 + 1)
    vertices, faces = lathe_mesh(radius * np.stack([np.sin(angles), np.cos(angles)], 1), SIDES)
    return Piece(vertices, faces, colour, (Part("sphere", size=(radius,)),))


def pill(radius: float, length: float, colour: str) -> Piece:
    """Rod along x with round ends, `length` over all."""
    half = length / 2 - radius
    angles = np.linspace(-np.pi / 2, np.pi / 2, SIDES // 2 + 2)
    profile = radius * np.stack([np.sin(angles), np.cos(angles)], 1)
    profile[:, 0] += np.where(angles < 0, -half, half)
    vertices, faces = lathe_mesh(profile, SIDES)
    return Piece(vertices, faces, colour, (Part("capsule", size=(radius, half)),))


def turned(
    profile: Sequence[Point2],
    colour: str,
    flat: float = 1.0,
    sides: int = SIDES,
    hollow: tuple[float, float] = (0.0, 0.0),
) -> Piece:
    """Solid of revolution about x.

    Args:
        profile: (x, radius) [m] from one end to the other, x never falling.
        flat: the z extent is this share of the y extent (an oval bottle).
        sides: corners of the cross section; 6 makes a hexagon with a flat below.
        hollow: (depth, radius) [m] of a drawn dent in the +x end, at most 2 mm deep.
    """
    outline = np.array(profile, dtype=float)
    drawn, (depth, radius) = outline, hollow
    if depth > 0:
        top = outline[-1, 0]
        drawn = np.concatenate([outline, [(top, radius), (top - depth, radius * 0.93)]])
    vertices, faces = lathe_mesh(drawn, sides)
    parts = lathe_sections(outline, flat, sides if sides < SIDES else 0)
    return Piece(vertices * [1, 1, flat], faces, colour, parts)


Point2 = tuple[float, float]


def slab(outline: Sequence[Point2], thickness: float, colour: str) -> Piece:
    """Convex outline (x, y) raised along z."""
    points = [(x, y, z) for x, y in outline for z in (-thickness / 2, thickness / 2)]
    return convex(points, colour)


def bent(path: Sequence[Point], radius: float, colour: str, stride: int = 1) -> Piece:
    """Round bar along a polyline; a capsule stands for every `stride` segments of it."""
    points = np.array(path, dtype=float)
    vertices, faces = _tube(points, radius)
    nodes = points[sorted({*range(0, len(points), stride), len(points) - 1})]
    parts = []
    for start, end in pairwise(nodes):
        length = float(np.linalg.norm(end - start))
        quat = matrix_to_quat(rotation_between(X, end - start))
        parts.append(Part("capsule", _point((start + end) / 2), quat, (radius, length / 2)))
    return Piece(vertices, faces, colour, tuple(parts))


def _tube(points: Array, radius: float, sides: int = 16) -> tuple[Array, NDArray[np.int64]]:
    """Mesh of a round bar with round ends along points (n, 3); frames carried without twist."""
    tangents = np.gradient(points, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    frame = rotation_between(X, tangents[0])
    rings, angle = [], np.arange(sides) * 2 * np.pi / sides
    circle = np.stack([np.zeros(sides), np.cos(angle), np.sin(angle)], 1)
    # Domes: rings (shift along the bar, share of the radius), closed by a fan.
    dome = [(radius * np.sin(t), np.cos(t)) for t in np.pi / 2 * np.array([0.0, 0.35, 0.7, 0.98])]
    last = len(points) - 1
    for i, (point, tangent) in enumerate(zip(points, tangents, strict=True)):
        frame = rotation_between(frame[:, 0], tangent) @ frame
        ends = [(-s, r) for s, r in dome[::-1]] if i == 0 else dome if i == last else [(0.0, 1.0)]
        rings += [point + frame[:, 0] * s + circle @ frame.T * radius * r for s, r in ends]
    return _skin(np.array(rings))


def _skin(rings: Array) -> tuple[Array, NDArray[np.int64]]:
    """Closed mesh over rings (k, n, 3) that follow each other, ends closed by fans."""
    count, sides = rings.shape[:2]
    vertices = np.concatenate(
        [rings.reshape(-1, 3), rings[0].mean(0)[None], rings[-1].mean(0)[None]]
    )
    faces = []
    for i in range(count - 1):
        for j in range(sides):
            a, b = i * sides + j, i * sides + (j + 1) % sides
            faces += [(a, b, b + sides), (a, b + sides, a + sides)]
    first, last = count * sides, count * sides + 1
    for j in range(sides):
        k = (j + 1) % sides
        faces += [(first, k, j), (last, (count - 1) * sides + j, (count - 1) * sides + k)]
    return vertices, np.array(faces)


def ring(outer: float, inner: float, width: float, colour: str, wedges: int = 8) -> Piece:
    """Ring about x with radii `outer` > `inner`; physics has `wedges` straight blocks."""
    half = width / 2
    profile = np.array([(-half, inner), (-half, outer), (half, outer), (half, inner)])
    vertices, faces = lathe_mesh(profile, SIDES, closed=False)
    # Wedge corners lie on a circle that keeps the ring's area and so its volume.
    step = 2 * np.pi / wedges
    keep = np.sqrt(step / np.sin(step))
    parts = []
    for i in range(wedges):
        angles = np.array([i, i + 1]) * step
        corners = [
            (x, r * keep * np.cos(t), r * keep * np.sin(t))
            for x in (-half, half)
            for r in (inner, outer)
            for t in angles
        ]
        parts.append(Part("convex", vertices=np.array(corners)))
    return Piece(vertices, faces, colour, tuple(parts))


def arc(radius: float, start: float, end: float, steps: int, plane: str = "xy") -> list[Point]:
    """Points on a circle about the origin from angle `start` to `end` [degrees]."""
    turns = np.radians(np.linspace(start, end, steps + 1))
    pairs = [(float(radius * np.cos(t)), float(radius * np.sin(t))) for t in turns]
    order = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}[plane]
    points = []
    for pair in pairs:
        point = [0.0, 0.0, 0.0]
        point[order[0]], point[order[1]] = pair
        points.append((point[0], point[1], point[2]))
    return points
