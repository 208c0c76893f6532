"""The robot as data: Sawyer arm with the AR10 hand bolted to its flange, and what sensing reads."""

from __future__ import annotations

from maniskill_taskgrasp.agents.robot_model import Joint, Primitive, Robot
from maniskill_taskgrasp.agents.sawyer_ar10.ar10 import HAND_JOINTS, HAND_LINKS, HAND_ROOT
from maniskill_taskgrasp.agents.sawyer_ar10.fuse import fuse
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.agents.sawyer_ar10.sawyer import (
    ARM_JOINTS,
    ARM_LINKS,
    FLANGE_LINK,
    FLANGE_RPY,
    FLANGE_XYZ,
)

SAWYER_AR10 = Robot(
    name="sawyer_ar10",
    root="base",  # Top face of the pedestal: +x forward, +y left, +z up.
    links=(*ARM_LINKS, *HAND_LINKS),
    joints=(
        *ARM_JOINTS,
        Joint(
            name="hand_mount",
            parent=FLANGE_LINK,
            child=HAND_ROOT,
            xyz=FLANGE_XYZ,
            rpy=FLANGE_RPY,
        ),
        *HAND_JOINTS,
    ),
)

SIMULATED = fuse(SAWYER_AR10, keep=(HAND_ROOT, AR10.palm_frame))
"""What is loaded: links that cannot move by themselves took a sixth of the robot's time in PhysX.

The hand's root carries the arm's last link, so what touches that counts as touching the palm's
link. The palm frame stays a link, for 2 %, because ManiSkill's tasks ask a robot for its `tcp`.
"""

ARM_JOINT_NAMES = tuple(joint.name for joint in ARM_JOINTS if joint.type == "revolute")
"""The seven arm joints, base to wrist."""
HAND_JOINT_NAMES = AR10.actuators
"""The ten motors of the hand: thumb, then mcp and pip of index, middle, ring, little."""
COUPLED_JOINT_NAMES = tuple(coupling.joint for coupling in AR10.couplings)
"""The four distal joints that follow their pip."""

PART_PRIMITIVES: dict[str, tuple[tuple[str, Primitive], ...]] = {
    part: tuple(
        (link, primitive) for link in links for primitive in SAWYER_AR10.link(link).collisions
    )
    for part, links in AR10.part_links.items()
}
"""Sensed part, in observation order -> (link, collision primitive in that link's frame)."""

SENSED_PRIMITIVES: dict[str, tuple[tuple[str, Primitive], ...]] = {
    part: tuple(
        (link, primitive)
        for link, primitive in primitives
        if part != "palm" or primitive.name in AR10.palm_shapes
    )
    for part, primitives in PART_PRIMITIVES.items()
}
"""The same without the wrist plate and the electronics, which are no palm to grasp with."""
