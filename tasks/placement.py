"""Where an object stands before it is grasped, turned so that the hand can span it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.geometry import (
    matrix_to_quat,
    part_corners,
    quat_to_matrix,
)
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.assets.objects.presentation import Presentation, present
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.topology import Topology

Array = NDArray[np.float64]

PAD_ROOM = 0.03  # [m] lower objects are raised: pads meet below the middle (facts: grasping, 3).
PALM_ROOM = 0.05  # [m] lower objects are raised: the fingers' ends pass below the object.


@dataclass(frozen=True)
class Placement:
    """An object's nominal pose in the task's world; the planner and the observation know it."""

    model: ObjectModel
    presentation: Presentation
    turn: float
    """[rad] yaw of the presentation: the longer horizontal side lies along the world's y, so that
    thumb and fingers, which oppose along x, close across the shorter one."""
    position: Array
    """(3,) [m] object origin."""
    quat_wxyz: Array
    """(4,)"""
    centre: Array
    """(3,) [m] on the vertical through the centre of mass, halfway up the object."""
    extents: Array
    """(3,) [m] size of the world-aligned box around the object along x, y and z."""
    fixture_pose: Array
    """(7,) [m, wxyz] of the presentation's frame."""


def suited(model: ObjectModel, topology: Topology, rest: int = 0) -> Presentation:
    """The object as this topology can take it; the rule for presentation "auto".

    Fingers that close below an object need room there, and a palm that shall touch it even more;
    side types pinch what stands: flat things on edge, rods upright. Where a stand cannot hold the
    object, or the table will do, the object's own rule decides (`presentation.choose`).
    """
    if topology.opposition == "Side":
        wanted = "holder" if "middle" in topology.parts and "thumb" in topology.parts else "rack"
    else:
        wanted = "stand"
        shown = present(model, "auto", rest)
        low = PALM_ROOM if topology.opposition == "Palm" else PAD_ROOM
        if shown.kind != "table" or _height(model, shown) >= low:
            return shown
    try:
        return present(model, wanted, rest)
    except InputError:
        return present(model, "auto", rest)


def _height(model: ObjectModel, shown: Presentation) -> float:
    """[m] vertical extent of the object as it is shown."""
    up = quat_to_matrix(shown.quat_wxyz)[2]
    return float(np.ptp(np.concatenate([part_corners(part) for part in model.parts]) @ up))


def place(
    model: ObjectModel,
    presentation: str = "auto",
    rest: int = 0,
    topology: Topology | None = None,
) -> Placement:
    """Put an object in front of the robot.

    Args:
        presentation: see `assets.objects.presentation.present`; "auto" asks `suited` where a
            topology is given.
        rest: which of the object's resting poses.
        topology: how it will be grasped, if that is known.

    Raises:
        InputError: unknown presentation, or one that cannot hold the object.
    """
    if presentation == "auto" and topology is not None:
        shown = suited(model, topology, rest)
    else:
        shown = present(model, presentation, rest)
    rotation = quat_to_matrix(shown.quat_wxyz)
    corners = np.concatenate([part_corners(part) for part in model.parts])
    width = np.ptp(corners @ rotation.T, axis=0)
    turn = np.pi / 2 if width[0] > width[1] else 0.0
    cos, sin = np.cos(turn), np.sin(turn)
    yaw = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    rotation = yaw @ rotation
    position = yaw @ np.asarray(shown.position)
    world = corners @ rotation.T + position
    low, high = world.min(0), world.max(0)
    com = rotation @ model.com + position
    # A grasp near the centre of mass holds best, so that is what stands at the world's origin.
    shift = np.array([-com[0], -com[1], 0.0])
    return Placement(
        model=model,
        presentation=shown,
        turn=float(turn),
        position=position + shift,
        quat_wxyz=np.asarray(matrix_to_quat(rotation)),
        centre=np.array([0.0, 0.0, (low[2] + high[2]) / 2]),
        extents=high - low,
        fixture_pose=np.concatenate([shift, matrix_to_quat(yaw)]),
    )
