"""The AR10 hand as a `HandDescription`: the one place for its numbers beside the URDF's.

Sources: fact sheet "robot", sections 2.2 (joints), 2.3 (torque and speed) and 2.4 (parts).
"""

from __future__ import annotations

from maniskill_taskgrasp.agents.hand import Coupling, HandDescription
from maniskill_taskgrasp.agents.sawyer_ar10.postures import POSTURES

FINGERS = ("index", "middle", "ring", "pinky")


def _finger_links(finger: str) -> tuple[str, ...]:
    return (f"{finger}_proximal", f"{finger}_middle", f"{finger}_distal")


AR10 = HandDescription(
    actuators=(
        "thumb_cmc",
        "thumb_flex",
        *(f"{finger}_{joint}" for finger in FINGERS for joint in ("mcp", "pip")),
    ),
    actuator_parts=tuple(
        part for part in ("thumb", "index", "middle", "ring", "little") for _ in range(2)
    ),
    couplings=tuple(
        Coupling(joint=f"{finger}_dip", source=f"{finger}_pip", ratio=0.49, offset=0.16)
        for finger in FINGERS
    ),
    palm_frame="palm_frame",
    part_links={
        "palm": ("hand_base",),
        "index": _finger_links("index"),
        "middle": _finger_links("middle"),
        "ring": _finger_links("ring"),
        "little": _finger_links("pinky"),
        "thumb": ("thumb_metacarpal", "thumb_distal"),
    },
    palm_shapes=("lower_palm", "upper_palm"),
    tip_links={
        "index": "index_distal",
        "middle": "middle_distal",
        "ring": "ring_distal",
        "little": "pinky_distal",
        "thumb": "thumb_distal",
    },
    thumb_rotation="thumb_cmc",
    thumb_pad_arc=((0.764, 0.0, 0.645), (-0.645, 0.0, 0.764)),
    finger_pad_arc=((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    torque_limit=0.6,
    coupled_torque_limit=0.3,
    speed_limit=1.1,
    stiffness=8.0,
    damping=0.4,
    armature=5e-4,
    thumb_abducted=1.10,  # Facts: grasping, section 6.
    straight_pip=0.5,
    finger_range=(0.17, 1.57),
    posture_lower=(0.85, 0.85, 0.34, 0.34, 0.17, 0.17, 0.50, 0.17),
    posture_upper=(1.90, 1.90, 0.70, 1.50, 1.10, 1.40, 1.57, 1.57),
    pinch_thumb_flex=0.95,  # Facts: grasping, section 1.
    postures=POSTURES,
)
