"""What our code must know of a hand: joints, coupling, parts and its posture for each topology.

Another hand is added by writing one `HandDescription`; no other code names a joint.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

PARTS = ("palm", "index", "middle", "ring", "little", "thumb")
"""Order of parts in every observation (paper, section III)."""


@dataclass(frozen=True, kw_only=True)
class Coupling:
    """A joint that a linkage drags along: q = ratio * q_source + offset."""

    joint: str
    source: str
    ratio: float
    offset: float
    """[rad]"""


@dataclass(frozen=True, kw_only=True)
class Posture:
    """How one hand takes and closes one topology; joints in the order of the hand's actuators."""

    preshape: tuple[float, ...]
    """[rad] open posture, activation 0."""
    closing: tuple[float, ...]
    """[rad] closed posture, activation 1; equal to the preshape where the joint holds still."""
    grasp_centre: tuple[float, float, float]
    """[m] where the object's centre belongs, in the palm frame."""
    tilt: float = 0.0
    """[rad] fingers down (+) or up (-) about the knuckle axis, from palm-down."""
    roll: float = 0.0
    """[rad] about the fingers, from palm-down; pi/2 turns the palm sideways, thumb up."""
    yaw: float = 0.0
    """[rad] about the vertical, from fingers pointing away from the robot."""
    feasible: bool = True
    reason: str = ""
    """Why the hand can, or cannot, form the topology."""

    @property
    def moving(self) -> np.ndarray:
        """(num_actuators,) bool: joints that the closing moves."""
        return np.asarray(self.preshape) != np.asarray(self.closing)


@dataclass(frozen=True, kw_only=True)
class HandDescription:
    """One hand, in the terms that controllers, sensing and planning use."""

    actuators: tuple[str, ...]
    """Actuated joints; every (num_actuators,) array follows this order."""
    actuator_parts: tuple[str, ...]
    """Part (`PARTS`) that each actuator moves."""
    couplings: tuple[Coupling, ...]
    palm_frame: str
    """Link whose +y is the palm normal and +z the direction of straight fingers."""
    part_links: dict[str, tuple[str, ...]]
    """Part (`PARTS`) -> links that belong to it."""
    palm_shapes: tuple[str, ...]
    """Collision primitives that make up the palm's grasping face; distances are taken to these."""
    tip_links: dict[str, str]
    """Finger or thumb part -> its last link, the one that carries the pad."""
    thumb_rotation: str
    """Actuator that turns the thumb against the fingers."""
    thumb_pad_arc: tuple[tuple[float, float, float], tuple[float, float, float]]
    """Outward normals of the thumb's pad and end, in its last link's frame."""
    finger_pad_arc: tuple[tuple[float, float, float], tuple[float, float, float]]
    """Outward normals of a finger's pad and end, in its last link's frame."""
    torque_limit: float
    """[Nm] per actuator."""
    coupled_torque_limit: float
    """[Nm] share of the actuator's torque that a coupled joint may carry."""
    speed_limit: float
    """[rad/s] per actuator."""
    stiffness: float
    """[Nm/rad] position drive."""
    damping: float
    """[Nms/rad] position drive."""
    armature: float
    """[kg m^2] reflected inertia of an actuator."""
    thumb_abducted: float
    """[rad] commanded thumb rotation from which the thumb stands against the fingers."""
    straight_pip: float
    """[rad] most bend of a middle joint that counts as straight."""
    finger_range: tuple[float, float]
    """[rad] what fingers may be commanded to."""
    posture_lower: tuple[float, ...]
    """(8,) [rad] box in which postures are searched: thumb rotation open and closed, thumb flexion
    open and closed, mean knuckle and middle joint of the fingers, open, then closed."""
    posture_upper: tuple[float, ...]
    pinch_thumb_flex: float
    """[rad] thumb flexion beyond which pinch types would trap objects on the thumb's back."""
    postures: dict[str, Posture] = field(default_factory=dict)
    """Topology slug -> posture."""

    def joint_angles(self, actuators: Any) -> dict[str, Any]:
        """Angle (...) [rad] of every joint, the coupled ones in place, by name.

        Args:
            actuators: (..., num_actuators) [rad], an array or a tensor.
        """
        angles = {name: actuators[..., i] for i, name in enumerate(self.actuators)}
        for coupling in self.couplings:
            angles[coupling.joint] = coupling.ratio * angles[coupling.source] + coupling.offset
        return angles
