"""The three stands as geometry: boards, sills and walls fitted to one object.

All are made of boxes standing on the table. Frame: table point below the object, z up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.geometry import (
    part_corners,
    part_triangles,
    quat_to_matrix,
)
from maniskill_taskgrasp.assets.objects.model import ObjectModel, Part
from maniskill_taskgrasp.errors import InputError

Array = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]  # x0, x1, y0, y1 [m]

RAIL_HEIGHT = 0.04  # [m]
SADDLE_FROM = 0.12  # [m] objects this long lie on two saddles with room for the hand between.
STUBBY = 0.018  # [m] round objects this short do too: a screw rolls off the straight on boards.
SADDLE = 0.012  # [m] length of a saddle along the object.
GROOVE = 0.19  # Half gap of a groove over the width in it: a round thing touches 22 degrees aside,
# where a 16-sided part has the middle of a facet.
BOARD = 0.004  # [m] thickness of boards and walls.
CLEARANCE = 0.0005  # [m] between an object and each wall, less where the wall is low:
LEAN = 0.02  # [rad] it leans by no more than this.
FOOTHOLD = 0.0015  # [m] least distance of the centre of mass from the edge of its support.
FLAT = 0.55  # Share of the middle extent up to which the thinnest makes a flat thing.


@dataclass(frozen=True)
class Stand:
    """A fixture and the object's pose in it."""

    parts: tuple[Part, ...]
    height: float
    """[m] of the object origin above the table."""
    rotation: Array
    """(3, 3) object to world."""


def rail(model: ObjectModel) -> Stand:
    """Boards under the lying object that leave its sides free.

    Tried in turn, and the first that carries the centre of mass is taken: two grooved saddles near
    the ends of a long object or a stubby round one, whose groove keeps it from rolling; two boards
    along the middle; two boards across near the ends or at the very ends.

    Raises:
        InputError: none carries it.
    """
    rotation = _lying(model)
    for boards in _rail_layouts(model, rotation):
        lows = [lower_surface(model, rotation, _grid(board)) for board in boards]
        if all(np.isfinite(low).any() for low in lows) and _carries(model, rotation, boards, lows):
            lift = RAIL_HEIGHT - min(float(low.min()) for low in lows)
            parts = [
                _board((x0, y0, 0.0), (x1, y1, float(low.min()) + lift))
                for (x0, x1, y0, y1), low in zip(boards, lows, strict=True)
            ]
            return Stand(tuple(parts), lift, rotation)
    raise InputError(f"no rail carries {model.name!r}; take table, rack or holder")


def _lying(model: ObjectModel) -> Array:
    """Rotation of the object lying, its x axis ahead."""
    flat = next((p for p in model.resting_poses if p.name == "lying"), model.resting_poses[0])
    rotation = quat_to_matrix(flat.quat_wxyz)
    ahead = rotation[:2, 0]
    if np.linalg.norm(ahead) < 0.5:
        return rotation
    c, s = ahead / np.linalg.norm(ahead)
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ rotation


def _rail_layouts(model: ObjectModel, rotation: Array) -> list[list[Rectangle]]:
    """Footprints of the boards of each layout that `rail` tries."""
    points, com = outline(model, rotation), rotation @ model.com
    (x0, y0), (x1, y1) = points[:, :2].min(0), points[:, :2].max(0)
    length, width = float(x1 - x0), min(float(y1 - y0), sorted(model.grasped_extents_m)[1])
    near, thick = GROOVE * width, max(0.0015, min(BOARD, width / 8))
    sides = [(com[1] - near - thick, com[1] - near), (com[1] + near, com[1] + near + thick)]
    long = min(SADDLE, length / 6)
    ends, tips = (
        [(x0 + inset, x0 + inset + long), (x1 - inset - long, x1 - inset)]
        for inset in (0.09 * length, 0.0)
    )
    middle = (com[0] - 0.3 * length, com[0] + 0.3 * length)
    layouts = [
        [(*middle, *side) for side in sides],
        [(*end, float(y0), float(y1)) for end in ends],
        [(*end, float(y0), float(y1)) for end in tips],
    ]
    stubby = length <= STUBBY and model.affordance.roundness == "a"
    if length >= SADDLE_FROM or stubby:
        layouts.insert(0, [(*end, *side) for end in ends for side in sides])
    return layouts


def _grid(board: Rectangle) -> Array:
    """(n, 2) [m] points over a board's top."""
    x0, x1, y0, y1 = board
    axes = np.meshgrid(np.linspace(x0, x1, 13), np.linspace(y0, y1, 13))
    return np.stack(axes, axis=-1).reshape(-1, 2)


def _carries(
    model: ObjectModel, rotation: Array, boards: list[Rectangle], lows: list[Array]
) -> bool:
    """Whether the points where the boards touch enclose the centre of mass by `FOOTHOLD`."""
    from scipy.spatial import ConvexHull, QhullError

    touching = np.concatenate(
        [_grid(b)[low < low.min() + 3e-4] for b, low in zip(boards, lows, strict=True)]
    )
    try:
        edges = ConvexHull(touching).equations
    except QhullError:
        return False
    com = (rotation @ model.com)[:2]
    margin = FOOTHOLD * min(1.0, min(model.extents_m) / 0.01)
    return bool((edges[:, :2] @ com + edges[:, 2]).max() < -margin)


def rack(model: ObjectModel) -> Stand:
    """Two walls that keep a flat object on edge, two sills below it that keep a round one still.

    Raises:
        InputError: the object is not flat.
    """
    a, b, c = model.extents_m
    if c > FLAT * b:
        raise InputError(
            f"a rack holds flat things on edge, and {model.name!r} is {100 * b:.1f} x "
            f"{100 * c:.1f} cm across; take table, rail or holder"
        )
    rotation = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])  # y up, z sideways
    points = outline(model, rotation)
    wall = float(np.clip(0.3 * b, 0.003, 0.03))
    middle, reach = float((rotation @ model.com)[0]), 0.25 * a
    sills = [(middle + s * reach - 0.003, middle + s * reach + 0.003, -c / 2, c / 2)
             for s in (-1, 1)]  # fmt: skip
    lows = [float(lower_surface(model, rotation, _grid(sill)).min()) for sill in sills]
    lift = max(min(0.004, wall / 3) - min(lows), 0.0003 - float(points[:, 2].min()))
    inside = points[points[:, 2] + lift < wall + 0.001, 1]
    gap = min(CLEARANCE, LEAN * wall / 2)
    low, high = float(inside.min()) - gap, float(inside.max()) + gap
    half = min(reach + 0.006, a / 2)
    walls = [(low - BOARD, low), (high, high + BOARD)]
    parts = [_board((middle - half, y0, 0.0), (middle + half, y1, wall)) for y0, y1 in walls]
    for (x0, x1, _, _), bottom in zip(sills, lows, strict=True):
        parts.append(_board((x0, low, 0.0), (x1, high, bottom + lift)))
    return Stand(tuple(parts), lift, rotation)


def holder(model: ObjectModel) -> Stand:
    """A square well that keeps a long object upright, its slimmer end down.

    Raises:
        InputError: the object is not long and slim.
    """
    a, b, _ = model.extents_m
    if b > 0.05 or a < 1.5 * b:
        raise InputError(
            f"a holder keeps rods upright, and {model.name!r} is {100 * a:.1f} x {100 * b:.1f} cm; "
            "take table, rail or rack"
        )
    deep = float(np.clip(0.35 * a, 0.008, 0.06))
    options = []
    for sign in (1, -1):
        rotation = np.array([[0, 0, -sign], [0, 1.0, 0], [sign, 0, 0]])
        points = outline(model, rotation)
        lift = -float(points[:, 2].min())
        sunk = points[points[:, 2] + lift < deep + 0.001, :2]
        options.append((float(np.ptp(sunk, axis=0).sum()), rotation, lift, sunk))
    _, rotation, lift, sunk = min(options, key=lambda option: round(option[0], 4))
    gap = min(CLEARANCE, LEAN * deep / 2)
    (x0, y0), (x1, y1) = sunk.min(0) - gap, sunk.max(0) + gap
    parts = (
        _board((x0 - BOARD, y0 - BOARD, 0.0), (x0, y1 + BOARD, deep)),
        _board((x1, y0 - BOARD, 0.0), (x1 + BOARD, y1 + BOARD, deep)),
        _board((x0, y0 - BOARD, 0.0), (x1, y0, deep)),
        _board((x0, y1, 0.0), (x1, y1 + BOARD, deep)),
    )
    return Stand(parts, lift, rotation)


def _board(low: tuple[float, float, float], high: tuple[float, float, float]) -> Part:
    """Box part between two corners."""
    x, y, z = ((p + q) / 2 for p, q in zip(low, high, strict=True))
    i, j, k = ((q - p) / 2 for p, q in zip(low, high, strict=True))
    return Part("box", (float(x), float(y), float(z)), size=(float(i), float(j), float(k)))


def lower_surface(model: ObjectModel, rotation: Array, points: Array) -> Array:
    """(n,) [m] lowest height of the turned object over horizontal points (n, 2); inf beside it."""
    triangles = np.concatenate([part_triangles(part) for part in model.parts]) @ rotation.T
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    kept = np.abs(area) > 1e-14
    a, u, v, area = a[kept], u[kept], v[kept], area[kept]
    w = points[:, None] - a[None, :, :2]
    s = (w[..., 0] * v[:, 1] - w[..., 1] * v[:, 0]) / area
    t = (u[:, 0] * w[..., 1] - u[:, 1] * w[..., 0]) / area
    hit = (s >= -1e-9) & (t >= -1e-9) & (s + t <= 1 + 1e-9)
    heights: Array = np.where(hit, a[:, 2] + s * u[:, 2] + t * v[:, 2], np.inf).min(axis=1)
    return heights


def outline(model: ObjectModel, rotation: Array) -> Array:
    """(n, 3) [m] corners of the turned object's parts and points along their edges."""
    steps = np.linspace(0, 1, 9)[:, None]
    clouds = [np.concatenate([part_corners(part) for part in model.parts])]
    for part in model.parts:
        triangles = part_triangles(part)
        for i, j in ((0, 1), (1, 2), (2, 0)):
            between = triangles[:, i, None] * (1 - steps) + triangles[:, j, None] * steps
            clouds.append(between.reshape(-1, 3))
    return np.concatenate(clouds) @ rotation.T
