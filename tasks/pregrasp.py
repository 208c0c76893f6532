"""Where the palm goes for a grasp: six numbers, and the palm poses and approach that they mean."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.rotations import axis_angle_matrix

PREGRASP_FIELDS = ("x", "y", "z", "tilt", "roll", "yaw")
"""x, y, z [m]: the object's centre in the palm frame once the palm is in place; tilt, roll, yaw
[rad]: turns of the palm from palm-down, fingers away from the robot (agents/hand.py, Posture)."""
HOVER_DISTANCE = 0.12  # [m] how far the palm backs off before it descends.
LIFT_DISTANCE = 0.26  # [m] how far the arm raises the palm; success asks for 0.20 of the object.
SIDEWAYS_ROLL = math.pi / 4  # [rad] beyond it the palm faces the object from the side.

# Columns: where the hand's x (little finger), y (palm normal) and z (fingers) point in the world.
PALM_DOWN = torch.tensor([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True)
class PalmPath:
    """Palm key poses of a grasp; positions (n, 3) [m] in the world, rotation (n, 3, 3)."""

    hover: Tensor
    grasp: Tensor
    lift: Tensor
    rotation: Tensor


def palm_rotation(tilt: Tensor, roll: Tensor, yaw: Tensor) -> Tensor:
    """(n, 3, 3) palm frame to world for angles (n,) [rad]; all zero is palm-down."""
    turn = axis_angle_matrix(2, yaw) @ axis_angle_matrix(1, tilt) @ axis_angle_matrix(0, roll)
    return turn @ PALM_DOWN.to(turn)


def palm_path(pregrasp: Tensor, obj_centre: Tensor) -> PalmPath:
    """Palm key poses for a pregrasp on an object.

    A palm that faces down comes down vertically; one that faces sideways comes along its normal.

    Args:
        pregrasp: (n, 6) `PREGRASP_FIELDS`.
        obj_centre: (n, 3) [m] the object's `Placement.centre`, world.
    """
    rotation = palm_rotation(*pregrasp[:, 3:].unbind(1))
    grasp = obj_centre - (rotation @ pregrasp[:, :3, None])[..., 0]
    up = torch.zeros_like(grasp)
    up[:, 2] = 1.0
    normal = rotation[:, :, 1]
    sideways = pregrasp[:, 4].abs() > SIDEWAYS_ROLL
    back = torch.where(sideways[:, None], -normal, up)
    return PalmPath(
        hover=grasp + HOVER_DISTANCE * back,
        grasp=grasp,
        lift=grasp + LIFT_DISTANCE * up,
        rotation=rotation,
    )
