"""How an object is offered to the hand: on the table, or out of a rail, rack or holder, and why.

Measured (docs/objects.md): this hand takes nothing thinner than 1.5 cm from a bare table and spans
nothing wider than 8.5 cm. People take such things from a stand too, so there are three.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.fixtures import (
    FLAT,
    RAIL_HEIGHT,
    holder,
    outline,
    rack,
    rail,
)
from maniskill_taskgrasp.assets.objects.geometry import matrix_to_quat, quat_to_matrix
from maniskill_taskgrasp.assets.objects.model import ObjectModel, Part, RestingPose
from maniskill_taskgrasp.errors import InputError, unknown_name

Array = NDArray[np.float64]

STANDS = {"rail": rail, "rack": rack, "holder": holder}
KINDS = ("table", *STANDS)
FIXTURE_FRICTION = 0.6  # Planed wood.
MIN_HEIGHT = 0.015  # [m] lower than this, fingertips meet the table before the object.
MAX_SPAN = 0.085  # [m] wider than this, thumb and fingers do not oppose.


@dataclass(frozen=True)
class Presentation:
    """A fixture and where the object starts in it; frame: table point below the object, z up."""

    kind: str
    """One of `KINDS`."""
    parts: tuple[Part, ...]
    position: tuple[float, float, float]
    """[m] object origin."""
    quat_wxyz: tuple[float, float, float, float]
    reason: str


def present(model: ObjectModel, presentation: str = "auto", rest: int = 0) -> Presentation:
    """The object as offered to the hand.

    Args:
        presentation: "auto" (the rule of `choose`), "stand" (rack or rail, never the bare table
            unless neither carries it), or one of `KINDS`.
        rest: index into `model.resting_poses`, the pose in which the object lies on the table.

    Raises:
        InputError: unknown presentation, or an object that the fixture asked for cannot hold.
    """
    if presentation in STANDS:
        return _on_stand(model, presentation, f"{presentation} was asked for")
    if presentation == "table":
        return _on_table(model.resting_poses[rest], "table was asked for")
    if presentation not in ("auto", "stand"):
        known = ("auto", "stand", *KINDS)
        raise unknown_name("presentation", presentation, known)
    kind, reason = choose(model, rest)
    if presentation == "stand" and kind == "table":
        kind, reason = _stand_kind(model), "a stand was asked for"
    if kind != "table":
        try:
            return _on_stand(model, kind, reason)
        except InputError:
            reason = f"{reason}; but no {kind} carries it, so it stays on the table"
    pose = model.resting_poses[rest]
    if presentation == "auto" and not _within_reach(model, pose):
        for other in model.resting_poses:
            if _within_reach(model, other):
                return _on_table(other, f"{reason}; turned to a pose within reach ({other.name})")
    return _on_table(pose, reason)


def choose(model: ObjectModel, rest: int = 0) -> tuple[str, str]:
    """Kind of presentation for an object in one of its resting poses, and the reason.

    What counts is the portion that people grasp. Table, if its top is at least `MIN_HEIGHT` above
    the table and it is narrower than `MAX_SPAN`. Otherwise the rack, if it is flat and either wider
    than the span or grasped by people across its thinnest extent; else the rail, if it is too low.
    What no stand would help stays on the table.
    """
    height, width = _reach(model, model.resting_poses[rest])
    thin = min(model.grasped_extents_m)
    if height >= MIN_HEIGHT and width <= MAX_SPAN:
        return "table", f"{100 * height:.1f} cm high and {100 * width:.1f} cm wide: within reach"
    what = (
        f"{100 * height:.1f} cm high, below {100 * MIN_HEIGHT:.1f} cm"
        if height < MIN_HEIGHT
        else f"{100 * width:.1f} cm wide, above {100 * MAX_SPAN:.1f} cm"
    )
    if _stand_kind(model) == "rack":
        return "rack", f"{what}: stood on edge, to be taken across its {100 * thin:.1f} cm"
    if height < MIN_HEIGHT:
        return "rail", f"{what}: raised {100 * RAIL_HEIGHT:.0f} cm, so that fingers reach below it"
    return "table", f"{what}, and not flat: no stand helps"


def _stand_kind(model: ObjectModel) -> str:
    thin, middle, _ = sorted(model.grasped_extents_m)
    across_thin = model.affordance.grasped_dimension == "c" or middle > MAX_SPAN
    flat = model.extents_m[2] <= FLAT * model.extents_m[1] and thin <= FLAT * middle
    return "rack" if across_thin and flat else "rail"


def _within_reach(model: ObjectModel, pose: RestingPose) -> bool:
    height, width = _reach(model, pose)
    return height >= MIN_HEIGHT and width <= MAX_SPAN


def _reach(model: ObjectModel, pose: RestingPose) -> tuple[float, float]:
    """Top above the table and narrowest width over all yaws [m] of what people grasp."""
    points = outline(model, np.eye(3))
    half = np.array(model.grasped_extents_m) / 2 + 0.001
    grasped = points[(np.abs(points - model.grasped_center) <= half).all(axis=1)]
    grasped = grasped @ quat_to_matrix(pose.quat_wxyz).T
    yaw = np.radians(np.arange(0, 180, 5))
    across = grasped[:, :2] @ np.stack([np.cos(yaw), np.sin(yaw)])
    return float(grasped[:, 2].max() + pose.height), float(np.ptp(across, axis=0).min())


def _on_table(pose: RestingPose, reason: str) -> Presentation:
    return Presentation("table", (), (0.0, 0.0, pose.height), pose.quat_wxyz, reason)


def _on_stand(model: ObjectModel, kind: str, reason: str) -> Presentation:
    if kind not in model.stands:
        others = ", ".join(("table", *model.stands))
        raise InputError(f"a {kind} does not hold {model.name!r} still; these do: {others}")
    return place(model, kind, reason)


def place(model: ObjectModel, kind: str, reason: str = "") -> Presentation:
    """The object in a fixture by geometry alone, whether or not physics keeps it there.

    Raises:
        InputError: the fixture cannot be made for the object.
    """
    stand = STANDS[kind](model)
    quat = matrix_to_quat(stand.rotation)
    return Presentation(kind, stand.parts, (0.0, 0.0, stand.height), quat, reason)
