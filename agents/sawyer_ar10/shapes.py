"""The few shapes the robot's pictures are made of, as triangle soups, and their smooth shading.

A soup is an (n, 3, 3) array: triangle, corner, coordinate; outer faces turn counter-clockwise.
Units are the caller's.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.robot_model import rotation

Array = NDArray[np.float64]
Soup = Array

CREASE = np.deg2rad(35.0)  # Faces that meet at more than this keep a sharp edge between them.


def skin(rings: Array, closed: bool = True) -> Soup:
    """Quads between successive rings of points, cut into triangles.

    Args:
        rings: (k, n, 3) points; each ring runs counter-clockwise as seen from the last one.
        closed: whether a ring's last point is followed by its first.
    """
    after = np.roll(rings, -1, axis=1) if closed else rings[:, 1:]
    before = rings if closed else rings[:, :-1]
    a, b, c, d = before[:-1], after[:-1], after[1:], before[1:]
    quads = np.stack([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)], axis=2)
    return quads.reshape(-1, 3, 3)


def fan(loop: Array) -> Soup:
    """Triangles from the centre of a convex loop (n, 3) to its edges."""
    centre = np.broadcast_to(loop.mean(axis=0), loop.shape)
    return np.stack([centre, loop, np.roll(loop, -1, axis=0)], axis=1)


def closed_skin(rings: Array) -> Soup:
    """`skin` with its first and last ring filled in."""
    return np.concatenate([skin(rings), fan(rings[0, ::-1]), fan(rings[-1])])


def place(soup: Soup, xyz: Sequence[float] = (0, 0, 0), rpy: Sequence[float] = (0, 0, 0)) -> Soup:
    """The soup turned by fixed-axis `rpy` [rad], then moved by `xyz`."""
    return soup @ rotation(rpy).T + np.asarray(xyz, dtype=float)


def revolve(profile: Sequence[tuple[float, float]], sectors: int = 56) -> Soup:
    """Body of revolution about z through `profile`, (radius, z) from the lowest point up."""
    angles = np.linspace(0.0, 2.0 * np.pi, sectors, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles), np.zeros(sectors)], axis=1)
    height = np.array([0.0, 0.0, 1.0])
    return closed_skin(np.stack([radius * circle + z * height for radius, z in profile]))


def cylinder(radius: float, length: float, bevel: float = 0.0, sectors: int = 24) -> Soup:
    """Cylinder along z about the origin, its rims bevelled."""
    half, inner = length / 2.0, radius - bevel
    rims = [(inner, -half), (radius, -half + bevel), (radius, half - bevel), (inner, half)]
    return revolve(rims if bevel else [rims[0], rims[-1]], sectors)


def plate(
    discs: Sequence[tuple[float, float, float]],
    thickness: float,
    axis: str = "z",
    bevel: float = 0.2,
    sectors: int = 40,
) -> Soup:
    """Sheet cut to the convex hull of discs, centred on the plane through the origin.

    Args:
        discs: (u, v, radius); u and v are the two coordinates that follow `axis` cyclically:
            x, y for "z"; y, z for "x"; z, x for "y".
        thickness: extent along `axis`.
        axis: which coordinate axis is normal to the sheet.
        bevel: width of the broken edges.
        sectors: points of the outline.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, sectors, endpoint=False)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    table = np.array(discs, dtype=float)
    reach = np.round(ways @ table[:, :2].T + table[:, 2], 9)  # Ties must not hang on a last bit.
    farthest = np.argmax(reach, axis=1)
    half = thickness / 2.0
    rings = []
    for inset, height in ((bevel, -half), (0, -half + bevel), (0, half - bevel), (bevel, half)):
        outline = table[farthest, :2] + (table[farthest, 2:] - inset) * ways
        rings.append(np.column_stack([outline, np.full(sectors, height)]))
    return np.roll(closed_skin(np.stack(rings)), "zxy".index(axis), axis=2)


def loft(sections: Sequence[tuple[float, float, float, float]], corner_points: int = 5) -> Soup:
    """Rounded rectangles stacked along z: (z, half width x, half width y, corner radius) each."""
    quarter = np.linspace(0.0, np.pi / 2.0, corner_points)
    angles = np.concatenate([quarter + turn * np.pi / 2.0 for turn in range(4)])
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    signs = np.repeat([[1, 1], [-1, 1], [-1, -1], [1, -1]], corner_points, axis=0)
    rings = []
    for z, half_x, half_y, radius in sections:
        outline = signs * (np.array([half_x, half_y]) - radius) + radius * ways
        rings.append(np.column_stack([outline, np.full(len(angles), z)]))
    return closed_skin(np.stack(rings))


def rounded_box(size: Sequence[float], radius: float, steps: int = 4) -> Soup:
    """Box about the origin with all edges and corners rounded."""
    half_x, half_y, half_z = np.asarray(size, dtype=float) / 2.0
    slopes = np.linspace(-np.pi / 2.0, 0.0, steps + 1)
    lower = [
        (
            -half_z + radius * (1.0 + np.sin(slope)),
            half_x - radius * (1.0 - np.cos(slope)),
            half_y - radius * (1.0 - np.cos(slope)),
            max(radius * np.cos(slope), 1e-3 * radius),
        )
        for slope in slopes
    ]
    return loft([*lower, *((-z, x, y, r) for z, x, y, r in reversed(lower))], steps + 1)


def _corner_angles(soup: Soup) -> Array:
    """(n, 3) [rad] angle of each triangle at each of its corners."""
    ahead = np.roll(soup, -1, axis=1) - soup
    ahead /= np.linalg.norm(ahead, axis=2, keepdims=True)
    cosines = -np.sum(ahead * np.roll(ahead, 1, axis=1), axis=2)
    return np.arccos(np.clip(cosines, -1.0, 1.0))


def _corner_normals(soup: Soup, keys: NDArray[np.int64], crease: float) -> Array:
    """(3 n, 3) unit normal of every corner: its face and the neighbours within `crease`.

    Faces count by their angle at the corner, so it does not matter along which diagonal a quad is
    cut into triangles.
    """
    across = np.cross(soup[:, 1] - soup[:, 0], soup[:, 2] - soup[:, 0])
    units = np.repeat(across / np.linalg.norm(across, axis=1, keepdims=True), 3, axis=0)
    weighted = units * _corner_angles(soup).reshape(-1, 1)
    order = np.argsort(keys, kind="stable")
    starts = np.flatnonzero(np.diff(keys[order], prepend=-1))
    normals = np.empty_like(units)
    for corners in np.split(order, starts[1:]):
        near = units[corners] @ units[corners].T >= np.cos(crease)
        normals[corners] = near.astype(float) @ weighted[corners]
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def shade(soup: Soup, crease: float = CREASE) -> tuple[Array, Array, NDArray[np.int64]]:
    """Vertices (v, 3), unit normals (v, 3) and triangles (f, 3) of a soup, smooth up to `crease`.

    Triangles without area are left out. Coordinates should be of the order of millimetres: points
    within 1e-4 of each other are taken for one.
    """
    across = np.cross(soup[:, 1] - soup[:, 0], soup[:, 2] - soup[:, 0])
    soup = soup[np.linalg.norm(across, axis=1) > 1e-6]
    points = soup.reshape(-1, 3)
    _, keys = np.unique(np.round(points, 4), axis=0, return_inverse=True)
    normals = _corner_normals(soup, keys.ravel(), crease)
    corners = np.round(np.column_stack([points, normals]), 4) + 0.0
    vertices, faces = np.unique(corners, axis=0, return_inverse=True)
    return vertices[:, :3], vertices[:, 3:], faces.reshape(-1, 3)
