"""Solids of revolution about x: their drawn mesh and the fewest convex parts that follow it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.model import Part

Array = NDArray[np.float64]

MAX_RINGS = 4
CORNERS = (32, 32, 32, 20, 16)  # Around a part of that many rings: the GPU allows 64.
POLYGON = 16  # Up to as many drawn sides, a flat and not a corner is turned down.
POINT = 1e-9  # [m] a smaller radius is a point on the axis.
BULGE = 1.5e-3  # [m] a part may bridge a hollow of the profile this deep (the bar is 2 mm)
BULGE_SHARE = 0.06  # and not deeper than this share of the largest radius.


def lathe_mesh(profile: Array, sides: int, closed: bool = True) -> tuple[Array, NDArray[np.int64]]:
    """Closed mesh of a profile (n, 2) of (x, radius) turned about x.

    Args:
        profile: from low to high x; a radius of 0 is drawn as a point.
        sides: corners around; fewer than a round shape's turn a flat, not a corner, to -z.
        closed: True: end discs are added; False: the profile is a closed loop (a ring).
    """
    points = [(x, r) for x, r in profile]
    if closed:
        if points[0][1] > POINT:
            points.insert(0, (points[0][0], 0.0))
        if points[-1][1] > POINT:
            points.append((points[-1][0], 0.0))
    shift = 0.5 if sides <= POLYGON else 0.0
    angle = (np.arange(sides) + shift) * 2 * np.pi / sides - np.pi / 2
    vertices: list[tuple[float, float, float]] = []
    rows = []
    for x, r in points:
        if closed and r <= POINT:
            rows.append([len(vertices)] * sides)
            vertices.append((x, 0.0, 0.0))
        else:
            rows.append([len(vertices) + j for j in range(sides)])
            vertices += [(x, r * np.cos(t), r * np.sin(t)) for t in angle]
    if not closed:
        rows.append(rows[0])
    faces = []
    for low, high in pairwise(rows):
        for j in range(sides):
            k = (j + 1) % sides
            faces += [(low[j], low[k], high[k]), (low[j], high[k], high[j])]
    kept = np.array([f for f in faces if len(set(f)) == 3])
    return np.array(vertices), kept


def lathe_sections(profile: Array, flat: float, sides: int = 0) -> tuple[Part, ...]:
    """Convex parts, end to end along x, of a turned profile (n, 2) of (x, radius).

    A section grows while its part would leave the profile by at most `BULGE`. Straight round
    sections become cylinders.

    Args:
        flat: z extent over y extent of the cross section.
        sides: corners of the cross section; 0 means round.
    """
    bulge = min(BULGE, BULGE_SHARE * float(profile[:, 1].max()))
    parts, start = [], 0
    while start < len(profile) - 1:
        end = start + 1
        while end < len(profile) - 1 and _misfit(profile[start : end + 2]) <= bulge:
            end += 1
        section = _simplified(_upper_hull(profile[start : end + 1]))
        if np.ptp(section[:, 0]) > 1e-9:
            parts.append(_section_part(section, flat, sides))
        start = end
    return tuple(parts)


def _section_part(hull: Array, flat: float, sides: int) -> Part:
    if len(hull) == 2 and np.ptp(hull[:, 1]) < 1e-9 and flat == 1.0 and not sides:
        half = float(np.ptp(hull[:, 0]) / 2)
        return Part(
            "cylinder", (float(hull[:, 0].mean()), 0.0, 0.0), size=(float(hull[0, 1]), half)
        )
    count = sides or CORNERS[int((hull[:, 1] > POINT).sum())]
    angle = (np.arange(count) + 0.5) * 2 * np.pi / count - np.pi / 2
    # Round sections: corners a little outside the circle, so that the volume is the circle's.
    grow = 1.0 if sides else np.sqrt(2 * np.pi / count / np.sin(2 * np.pi / count))
    corners = []
    for x, r in hull:
        if r <= POINT:
            corners.append((x, 0.0, 0.0))
        else:
            corners += [(x, r * grow * np.cos(t), r * grow * flat * np.sin(t)) for t in angle]
    return Part("convex", vertices=np.array(corners))


def _upper_hull(profile: Array) -> Array:
    """Corners of the upper convex hull of a profile with x never falling."""
    hull: list[Array] = []
    for point in profile:
        while hull and point[0] - hull[-1][0] < 1e-9 and len(hull) == 1 and point[1] > hull[-1][1]:
            hull.pop()
        while len(hull) >= 2 and _turn(hull[-2], hull[-1], point) >= -1e-12:
            hull.pop()
        hull.append(point)
    if len(hull) >= 2 and abs(hull[-1][0] - hull[-2][0]) < 1e-9:
        hull.pop()
    return np.array(hull)


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _misfit(profile: Array) -> float:
    """[m] how far the part for a stretch of profile would rise above it or stay below it."""
    hull = _upper_hull(profile)
    if len(hull) < 2:
        return 0.0
    sloping = np.diff(profile[:, 0]) > 1e-9
    ends = np.concatenate([profile[:-1][sloping], profile[1:][sloping]])
    rise = np.interp(ends[:, 0], hull[:, 0], hull[:, 1]) - ends[:, 1]
    kept = _simplified(hull)
    sag = hull[:, 1] - np.interp(hull[:, 0], kept[:, 0], kept[:, 1])
    return float(max(rise.max(), sag.max()))


def _simplified(hull: Array) -> Array:
    """Hull corners thinned to `MAX_RINGS`, dropping those that cost least area."""
    points = list(hull)
    while len(points) > MAX_RINGS:
        cost = [
            abs(_turn(points[i - 1], points[i], points[i + 1])) for i in range(1, len(points) - 1)
        ]
        points.pop(1 + int(np.argmin(cost)))
    return np.array(points)
