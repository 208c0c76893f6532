"""How an object is offered to the hand: on the table, or out of a rail, rack or holder, and why.

Measured (docs/objects.md): this hand takes nothing thinner than 1.5 cm from a bare table and spans
nothing wider than 8.5 cm. People take such things from a stand too, so there are three.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.geometry import (
    matrix_to_quat,
    part_corners,
    part_triangles,
    quat_to_matrix,
)
from maniskill_taskgrasp.assets.objects.model import ObjectModel, Part
from maniskill_taskgrasp.errors import InputError, unknown_name

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

KINDS = ("table", "rail", "rack", "holder")
FIXTURE_FRICTION = 0.6  # Planed wood.
MIN_HEIGHT = 0.015  # [m] lower than this, fingertips meet the table before the object.
MAX_SPAN = 0.085  # [m] wider than this, thumb and fingers do not oppose.
RAIL_HEIGHT = 0.04  # [m]
SADDLE_FROM = 0.12  # [m] objects this long lie on two saddles with room for the hand between.
LIP = 0.004  # [m] thickness of boards and walls.
CLEARANCE = 0.0005  # [m] between an object and each wall that keeps it upright.


@dataclass(frozen=True)
class Presentation:
    """A fixture and where the object starts in it; frame: table point below the object, z up."""

    kind: str
    """One of `KINDS`."""
    parts: tuple[Part, ...]
    position: Vector
    """[m] object origin."""
    quat_wxyz: tuple[float, float, float, float]
    reason: str


def present(model: ObjectModel, presentation: str = "auto", rest: int = 0) -> Presentation:
    """The object as offered to the hand.

    Args:
        presentation: "auto" (the rule of `choose`), "stand" (the rule, never the bare table), or
            one of `KINDS`.
        rest: index into `model.resting_poses`; only the table uses it beyond the choice.

    Raises:
        InputError: unknown presentation, or an object that the fixture cannot hold.
    """
    if presentation not in ("auto", "stand", *KINDS):
        raise unknown_name(
            "presentation",
            presentation,
            ("auto", "stand", *KINDS),
            "auto, stand, table, rail, rack and holder",
        )
    kind, reason = choose(model, rest)
    if presentation == "stand" and kind == "table":
        kind, reason = _stand(model), "a stand was asked for"
    elif presentation in KINDS and presentation != kind:
        kind, reason = presentation, f"{presentation} was asked for"
    if kind == "table":
        return _table(model, rest, reason)
    return {"rail": _rail, "rack": _rack, "holder": _holder}[kind](model, reason)


def choose(model: ObjectModel, rest: int = 0) -> tuple[str, str]:
    """Kind of presentation for an object in one of its resting poses, and the reason.

    What counts is the portion that people grasp. Table, if its top is at least `MIN_HEIGHT` above
    the table and it is narrower than `MAX_SPAN`. Otherwise the rack if it is wider than the span
    or people grasp it across its thinnest extent; else the rail. What no stand would help stays on
    the table.
    """
    pose = model.resting_poses[rest]
    corners = _grasped_corners(model) @ quat_to_matrix(pose.quat_wxyz).T
    height, width = float(corners[:, 2].max() + pose.height), _narrow_width(corners)
    thin = min(model.grasped_extents_m)
    if height >= MIN_HEIGHT and width <= MAX_SPAN:
        return "table", f"{100 * height:.1f} cm high and {100 * width:.1f} cm wide: within reach"
    if thin > MAX_SPAN:
        return "table", f"{100 * thin:.1f} cm across at the thinnest: no stand helps"
    what = (
        f"{100 * height:.1f} cm high, below {100 * MIN_HEIGHT:.1f} cm"
        if height < MIN_HEIGHT
        else f"{100 * width:.1f} cm wide, above {100 * MAX_SPAN:.1f} cm"
    )
    if _stand(model) == "rack":
        return "rack", f"{what}: stood on edge, to be taken across its {100 * thin:.1f} cm"
    return "rail", f"{what}: raised by {100 * RAIL_HEIGHT:.0f} cm, so that fingers reach below it"


def _stand(model: ObjectModel) -> str:
    thin, middle, _ = sorted(model.grasped_extents_m)
    across_thin = model.affordance.grasped_dimension == "c"
    return "rack" if middle > MAX_SPAN or (across_thin and middle >= 2 * thin) else "rail"


def _grasped_corners(model: ObjectModel) -> Array:
    """(n, 3) [m] points of the parts within the box around what people grasp, object frame."""
    points = _dense(model)
    reach = np.array(model.grasped_extents_m) / 2 + 0.001
    return points[(np.abs(points - model.grasped_center) <= reach).all(axis=1)]


def _narrow_width(corners: Array) -> float:
    """[m] smallest horizontal width of a point cloud over all yaws (1 degree steps)."""
    yaw = np.radians(np.arange(180))
    across = corners[:, :2] @ np.stack([np.cos(yaw), np.sin(yaw)])
    return float(np.ptp(across, axis=0).min())


def _corners(model: ObjectModel, rotation: Array) -> Array:
    return np.concatenate([part_corners(part) for part in model.parts]) @ rotation.T


def _table(model: ObjectModel, rest: int, reason: str) -> Presentation:
    pose = model.resting_poses[rest]
    return Presentation("table", (), (0.0, 0.0, pose.height), pose.quat_wxyz, reason)


def _lower_surface(model: ObjectModel, rotation: Array, points: Array) -> Array:
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
    return np.where(hit, a[:, 2] + s * u[:, 2] + t * v[:, 2], np.inf).min(axis=1)


def _board(low: Vector, high: Vector) -> Part:
    """Box part between two corners."""
    a, b = np.array(low), np.array(high)
    x, y, z = (a + b) / 2
    i, j, k = (b - a) / 2
    return Part("box", (float(x), float(y), float(z)), size=(float(i), float(j), float(k)))


def _rail(model: ObjectModel, reason: str) -> Presentation:
    """Boards under the lying object, spaced to half its width so that a round one cannot roll.

    Long objects lie on two saddles near their ends; others on boards along their middle.
    """
    a, b, _ = model.extents_m
    flat = next((p for p in model.resting_poses if p.name.startswith("lying")), None)
    rotation = np.eye(3) if flat is None else quat_to_matrix(flat.quat_wxyz)
    rotation = _x_ahead(rotation)
    com = rotation @ model.com
    gap, thick = b / 4, max(0.0015, min(LIP, b / 8))
    if a >= SADDLE_FROM:
        spans = [(com[0] + s * 0.36 * a - 0.006, com[0] + s * 0.36 * a + 0.006) for s in (-1, 1)]
    else:
        spans = [(com[0] - 0.3 * a, com[0] + 0.3 * a)]
    parts, lift = [], RAIL_HEIGHT - _support(model, rotation, spans, com[1], gap, thick).min()
    for low, high in spans:
        top = float(_support(model, rotation, [(low, high)], com[1], gap, thick).min() + lift)
        for side in (-1, 1):
            near, far = sorted((com[1] + side * gap, com[1] + side * (gap + thick)))
            parts.append(_board((low, near, 0.0), (high, far, top)))
    return Presentation(
        "rail", tuple(parts), (0.0, 0.0, float(lift)), matrix_to_quat(rotation), reason
    )


def _support(
    model: ObjectModel,
    rotation: Array,
    spans: list[tuple[float, float]],
    y: float,
    gap: float,
    thick: float,
) -> Array:
    """Lower surface of the object over the boards' tops, (n,) [m]."""
    xs = np.concatenate([np.linspace(low, high, 9) for low, high in spans])
    ys = np.concatenate([y + side * np.linspace(gap, gap + thick, 5) for side in (-1, 1)])
    grid = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    heights = _lower_surface(model, rotation, grid)
    heights = heights[np.isfinite(heights)]
    if len(heights) == 0:
        raise InputError(
            f"a rail cannot carry {model.name!r}: nothing of it is above the boards; "
            "take another presentation"
        )
    return heights


def _x_ahead(rotation: Array) -> Array:
    """The pose turned about the vertical so that the object's x axis has no sideways part."""
    ahead = rotation[:2, 0]
    if np.linalg.norm(ahead) < 1e-6:
        return rotation
    c, s = ahead / np.linalg.norm(ahead)
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ rotation


def _rack(model: ObjectModel, reason: str) -> Presentation:
    """Two walls that keep a flat object on edge and two sills, so that a round one cannot roll."""
    a, b, c = model.extents_m
    rotation = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])  # y up, z sideways
    corners = _corners(model, rotation)
    wall = float(np.clip(0.3 * b, 0.004, 0.03))
    sill, half = min(0.004, wall / 3), 0.02 * np.ceil(a / 0.08)
    at = a / 4
    probe = np.array(
        [
            [s * (at + d), y]
            for s in (-1, 1)
            for d in np.linspace(-0.002, 0.002, 5)
            for y in np.linspace(-c / 2, c / 2, 9)
        ]
    )
    lower = _lower_surface(model, rotation, probe)
    lift = sill - float(lower[np.isfinite(lower)].min())
    lift = max(lift, -float(corners[:, 2].min()) + 0.0005)
    inside = corners[corners[:, 2] + lift < wall + 0.002]
    low, high = float(inside[:, 1].min()) - CLEARANCE, float(inside[:, 1].max()) + CLEARANCE
    half = min(max(half, at + 0.004), a / 2)
    parts = [
        _board((-half, high, 0.0), (half, high + LIP, wall)),
        _board((-half, low - LIP, 0.0), (half, low, wall)),
        *(_board((s * at - 0.002, low, 0.0), (s * at + 0.002, high, sill)) for s in (-1, 1)),
    ]
    return Presentation("rack", tuple(parts), (0.0, 0.0, lift), matrix_to_quat(rotation), reason)


def _holder(model: ObjectModel, reason: str) -> Presentation:
    """A square well that keeps a long object upright, its slimmer end down."""
    a, b, _ = model.extents_m
    if b > 0.05 or a < 1.5 * b:
        raise InputError(
            f"a holder keeps rods upright, and {model.name!r} is {100 * a:.1f} x "
            f"{100 * b:.1f} cm; take table, rail or rack"
        )
    depth = float(np.clip(0.35 * a, 0.012, 0.06))
    options = []
    for sign in (1, -1):
        rotation = np.array([[0, 0, -sign], [0, 1.0, 0], [sign, 0, 0]])
        corners = _dense(model) @ rotation.T
        lift = -float(corners[:, 2].min())
        sunk = corners[corners[:, 2] + lift < depth + 0.001]
        options.append((float(np.ptp(sunk[:, :2], axis=0).sum()), rotation, lift, sunk))
    _, rotation, lift, sunk = min(options, key=lambda o: round(o[0], 4))
    x0, y0 = sunk[:, :2].min(0) - CLEARANCE
    x1, y1 = sunk[:, :2].max(0) + CLEARANCE
    parts = (
        _board((x0 - LIP, y0 - LIP, 0.0), (x0, y1 + LIP, depth)),
        _board((x1, y0 - LIP, 0.0), (x1 + LIP, y1 + LIP, depth)),
        _board((x0, y0 - LIP, 0.0), (x1, y0, depth)),
        _board((x0, y1, 0.0), (x1, y1 + LIP, depth)),
    )
    return Presentation("holder", parts, (0.0, 0.0, lift), matrix_to_quat(rotation), reason)


def _dense(model: ObjectModel) -> Array:
    """(n, 3) [m] corners of the parts and points along their edges, object frame."""
    steps = np.linspace(0, 1, 17)[:, None]
    clouds = []
    for part in model.parts:
        t = part_triangles(part)
        for i, j in ((0, 1), (1, 2), (2, 0)):
            clouds.append((t[:, i, None] * (1 - steps) + t[:, j, None] * steps).reshape(-1, 3))
    return np.concatenate(clouds)
