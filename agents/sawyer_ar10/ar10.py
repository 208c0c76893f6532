"""Bodies of the AR10 hand: links, masses, joints, limits and collision primitives.

Sources: Active8Robots/AR10 (joint offsets, limits, coupling, part sizes), with each finger's two
parallel plate chains merged into one; the merged chain puts every fingertip within 0.16 mm of the
original's. Masses are estimates: the makers state none, and their files carry placeholders.
All frames are parallel to the wrist plate's at joint angle zero: +z along the straight fingers,
+y out of the palm, -x towards the thumb. Zero means a straight finger and lies outside the limits.
"""

from __future__ import annotations

from maniskill_taskgrasp.agents.robot_model import (
    Box,
    Cylinder,
    Joint,
    Link,
    Primitive,
    Vec3,
    inertia_of_primitives,
)
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10, FINGERS

HAND_ROOT = "hand_base"  # Wrist plate, bolted to the arm's flange.

FINGER_LIMITS = (0.17, 1.57)  # [rad] mcp and pip
DISTAL_LIMITS = (0.17, 0.95)  # [rad] dip; the coupling stays within 0.243..0.929.
THUMB_CMC_LIMITS = (0.85, 2.15)  # [rad] The paper's authors stop at 1.57.
THUMB_FLEX_LIMITS = (0.34, 1.50)  # [rad]

FLEX_AXIS: Vec3 = (-1.0, 0.0, 0.0)  # Positive angles bend the fingers from +z towards +y.
CMC_AXIS: Vec3 = (-0.27712, 0.0, -0.96084)  # Swings the thumb from beside the palm to before it.
THUMB_FLEX_AXIS: Vec3 = (0.0, 1.0, 0.0)  # Lifts its end to the fingers, then over the palm.

PROXIMAL_LENGTH, MIDDLE_LENGTH, TIP_OFFSET = 0.045, 0.030, 0.020  # [m] mcp-pip, pip-dip, dip-tip
KNUCKLES: dict[str, Vec3] = {  # [m] mcp axis in hand_base
    "index": (-0.0470, 0.0035, 0.14315),
    "middle": (-0.0260, 0.0035, 0.14815),
    "ring": (-0.0043, 0.0035, 0.13815),
    "pinky": (0.0165, 0.0035, 0.12815),
}
THUMB_PAD_PITCH = -0.7015  # [rad] Turns the pad's long axis to (-0.645, 0, 0.764).


def _link(name: str, mass: float, com: Vec3, *collisions: Primitive) -> Link:
    """Link whose inertia follows from its primitives."""
    inertia = inertia_of_primitives(mass, com, collisions)
    return Link(name=name, inertia=inertia, collisions=collisions)


def _hinge(
    name: str, parent: str, child: str, xyz: Vec3, axis: Vec3, limits: tuple[float, float]
) -> Joint:
    """Revolute joint with the torque and speed of the hand's servos."""
    return Joint(
        name=name,
        parent=parent,
        child=child,
        xyz=xyz,
        type="revolute",
        axis=axis,
        lower=limits[0],
        upper=limits[1],
        velocity=AR10.speed_limit,
        effort=AR10.torque_limit,
    )


PALM_LINKS = (
    _link(
        HAND_ROOT,
        0.42,
        (-0.005, 0.008, 0.06),
        Cylinder(name="wrist_plate", radius=0.037, length=0.004, xyz=(0.0, -0.001, 0.0)),
        Box(name="electronics", size=(0.05, 0.05, 0.05), xyz=(0.0, 0.0, 0.025)),
        Box(name="lower_palm", size=(0.056, 0.022, 0.048), xyz=(0.0, 0.011, 0.074)),
        Box(name="upper_palm", size=(0.084, 0.020, 0.036), xyz=(-0.0147, 0.0105, 0.115)),
    ),
    Link(name="palm_frame"),
)
PALM_JOINTS = (
    Joint(name="palm_fixed", parent=HAND_ROOT, child="palm_frame", xyz=(-0.0148, 0.0205, 0.095)),
)

THUMB_LINKS = (
    _link(
        "thumb_metacarpal",
        0.020,
        (-0.018, 0.0, 0.004),
        Box(name="bracket", size=(0.036, 0.017, 0.011), xyz=(-0.018, 0.0, 0.004)),
    ),
    _link(
        "thumb_distal",
        0.016,
        (-0.025, 0.0, 0.010),
        Box(
            name="plates",
            size=(0.036, 0.0105, 0.010),
            xyz=(-0.0175, 0.0, 0.007),
            rpy=(0.0, 0.42, 0.0),
        ),
        Box(
            name="pad",
            size=(0.015, 0.019, 0.025),
            xyz=(-0.0393, 0.0001, 0.0192),
            rpy=(0.0, THUMB_PAD_PITCH, 0.0),
        ),
    ),
    Link(name="thumb_tip"),
)
THUMB_JOINTS = (
    _hinge(
        "thumb_cmc",
        HAND_ROOT,
        "thumb_metacarpal",
        (-0.0405, 0.0035, 0.0719),
        CMC_AXIS,
        THUMB_CMC_LIMITS,
    ),
    _hinge(
        "thumb_flex",
        "thumb_metacarpal",
        "thumb_distal",
        (-0.0366, 0.00003, 0.00481),
        THUMB_FLEX_AXIS,
        THUMB_FLEX_LIMITS,
    ),
    Joint(
        name="thumb_tip_fixed",
        parent="thumb_distal",
        child="thumb_tip",
        xyz=(-0.03932, 0.00013, 0.01923),
    ),
)


def finger_links(finger: str) -> tuple[Link, ...]:
    """Three segments and the tip frame; the same parts on all four fingers."""
    return (
        _link(
            f"{finger}_proximal",
            0.012,
            (0.0, 0.0, 0.0225),
            Box(name="plates", size=(0.0105, 0.010, 0.040), xyz=(0.0, -0.001, 0.024)),
        ),
        _link(
            f"{finger}_middle",
            0.008,
            (0.0, 0.0, 0.015),
            Box(name="plates", size=(0.0125, 0.009, 0.028), xyz=(0.0, -0.001, 0.015)),
        ),
        _link(
            f"{finger}_distal",
            0.008,
            (0.0, 0.0, 0.022),
            Box(name="neck", size=(0.011, 0.008, 0.013), xyz=(0.0, -0.0005, 0.006)),
            # The real thimble is 19.4 mm wide; 17.5 leaves 3 mm between neighbouring fingers.
            Box(name="pad", size=(0.0175, 0.0135, 0.0235), xyz=(0.0, 0.0006, 0.0225)),
        ),
        Link(name=f"{finger}_tip"),
    )


def finger_joints(finger: str) -> tuple[Joint, ...]:
    """mcp and pip have a servo each; a link rod makes dip follow pip."""
    proximal, middle, distal = (f"{finger}_{part}" for part in ("proximal", "middle", "distal"))
    to_pip, to_dip = (0.0, 0.0, PROXIMAL_LENGTH), (0.0, 0.0, MIDDLE_LENGTH)
    return (
        _hinge(f"{finger}_mcp", HAND_ROOT, proximal, KNUCKLES[finger], FLEX_AXIS, FINGER_LIMITS),
        _hinge(f"{finger}_pip", proximal, middle, to_pip, FLEX_AXIS, FINGER_LIMITS),
        _hinge(f"{finger}_dip", middle, distal, to_dip, FLEX_AXIS, DISTAL_LIMITS),
        Joint(
            name=f"{finger}_tip_fixed",
            parent=distal,
            child=f"{finger}_tip",
            xyz=(0.0, 0.0, TIP_OFFSET),
        ),
    )


HAND_LINKS = (
    *PALM_LINKS,
    *(link for finger in FINGERS for link in finger_links(finger)),
    *THUMB_LINKS,
)
HAND_JOINTS = (
    *PALM_JOINTS,
    *(joint for finger in FINGERS for joint in finger_joints(finger)),
    *THUMB_JOINTS,
)
