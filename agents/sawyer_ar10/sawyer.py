"""Numbers of the Sawyer arm: links, masses, inertias, joints, limits and collision primitives.

Source: the manufacturer's description, RethinkRobotics/sawyer_robot. Joints, limits, masses and
inertias are read from it; the primitives were fitted to its meshes (95 % of the surface of l1..l6
sticks out by at most 3.2 mm, single points by up to 18 mm on the rounded cap of l5).
"""

from __future__ import annotations

from math import pi

from maniskill_taskgrasp.agents.robot_model import Box, Cylinder, Inertia, Joint, Link

ALONG_Y = (-pi / 2, 0.0, 0.0)  # Turns a cylinder's own z into the link's y.
BUILT_IN_TWIST = -0.17453  # [rad] j6 is twisted by 10 degrees: the hand's zero is no round number.

ARM_LINKS = (
    Link(name="base"),
    Link(
        name="pedestal",
        inertia=Inertia(
            mass=60.864,
            com=(0.0, 0.0, -0.5),
            xx=5.0636,
            yy=6.0869,
            zz=4.9619,
            xy=0.0010342,
            xz=0.802,
            yz=0.0010531,
        ),
        collisions=(
            Cylinder(name="column", radius=0.112, length=0.61, xyz=(0.0, 0.0, -0.315)),
            Box(name="controller", size=(0.22, 0.4, 0.53), xyz=(-0.325, 0.0, -0.38)),
            Box(name="foot", size=(0.77, 0.7, 0.29), xyz=(-0.1225, 0.0, -0.77)),
        ),
    ),
    Link(
        name="arm_base",
        inertia=Inertia(mass=2.0687, com=(-0.0006, 0.0, 0.0654), xx=0.00676, yy=0.00679, zz=0.0074),
        collisions=(Cylinder(name="collar", radius=0.085, length=0.08, xyz=(0.0, 0.0, 0.04)),),
    ),
    Link(
        name="l0",
        inertia=Inertia(
            mass=5.3213,
            com=(0.0244, 0.011, 0.1436),
            xx=0.0533,
            yy=0.0579,
            zz=0.0237,
            xy=0.0047,
            xz=0.0117,
            yz=0.008,
        ),
        collisions=(
            Cylinder(name="column", radius=0.07, length=0.311, xyz=(0.0, -0.008, 0.1555)),
            Cylinder(
                name="shoulder", radius=0.068, length=0.112, xyz=(0.081, -0.006, 0.237), rpy=ALONG_Y
            ),
        ),
    ),
    Link(
        name="head",
        inertia=Inertia(mass=1.5795, com=(0.0053, 0.0, 0.1021), xx=0.0118, yy=0.0083, zz=0.005),
        collisions=(
            Cylinder(name="post", radius=0.041, length=0.24, xyz=(0.0, 0.0, 0.115)),
            Box(name="screen", size=(0.05, 0.256, 0.17), xyz=(0.005, 0.0, 0.115)),
        ),
    ),
    Link(
        name="l1",
        inertia=Inertia(
            mass=4.505,
            com=(-0.0031, -0.0268, 0.0925),
            xx=0.0224,
            yy=0.0146,
            zz=0.0173,
            xy=-0.0002,
            xz=-0.0003,
            yz=-0.0061,
        ),
        collisions=(
            Cylinder(name="body", radius=0.068, length=0.194, xyz=(0.0, 0.0, 0.098)),
            Cylinder(
                name="elbow", radius=0.054, length=0.13, xyz=(0.0, -0.075, 0.1425), rpy=ALONG_Y
            ),
        ),
    ),
    Link(
        name="l2",
        inertia=Inertia(
            mass=1.745, com=(-0.0002, -0.015, 0.1358), xx=0.0255, yy=0.0253, zz=0.0034, yz=-0.0033
        ),
        collisions=(Cylinder(name="tube", radius=0.052, length=0.315, xyz=(0.0, -0.003, 0.1585)),),
    ),
    Link(
        name="l3",
        inertia=Inertia(
            mass=2.5097,
            com=(-0.0048, -0.0281, -0.0842),
            xx=0.0102,
            yy=0.0066,
            zz=0.0069,
            xz=0.0003,
            yz=0.003,
        ),
        collisions=(
            Cylinder(name="body", radius=0.054, length=0.174, xyz=(0.0, 0.0, -0.087)),
            Cylinder(
                name="elbow", radius=0.045, length=0.1265, xyz=(0.0, -0.06325, -0.1265), rpy=ALONG_Y
            ),
        ),
    ),
    Link(
        name="l4",
        inertia=Inertia(
            mass=1.1136,
            com=(-0.0019, 0.0069, 0.1341),
            xx=0.0136,
            yy=0.0136,
            zz=0.0014,
            xz=0.0001,
            yz=0.0011,
        ),
        collisions=(Cylinder(name="tube", radius=0.048, length=0.315, xyz=(0.0, -0.002, 0.165)),),
    ),
    Link(
        name="l5",
        inertia=Inertia(
            mass=1.5625,
            com=(0.0061, -0.0237, 0.0764),
            xx=0.0047,
            yy=0.003,
            zz=0.0032,
            xy=0.0001,
            yz=-0.0012,
        ),
        collisions=(
            Cylinder(name="body", radius=0.048, length=0.154, xyz=(0.002, 0.002, 0.0755)),
            Cylinder(
                name="elbow", radius=0.045, length=0.078, xyz=(0.0, -0.039, 0.105), rpy=ALONG_Y
            ),
        ),
    ),
    Link(
        name="l6",
        inertia=Inertia(mass=0.3292, com=(0.0, 0.0086, -0.005), xx=0.00031, yy=0.00022, zz=0.00036),
        collisions=(
            Cylinder(name="barrel", radius=0.042, length=0.064, xyz=(0.0, 0.0, -0.0075)),
            Box(name="camera", size=(0.062, 0.04, 0.051), xyz=(0.0, 0.048, -0.0075)),
        ),
    ),
)

ARM_JOINTS = (
    Joint(name="arm_mount", parent="base", child="arm_base"),
    Joint(name="pedestal_fixed", parent="base", child="pedestal"),
    Joint(
        name="right_j0",
        parent="arm_base",
        child="l0",
        xyz=(0.0, 0.0, 0.08),
        type="revolute",
        lower=-3.0503,
        upper=3.0503,
        velocity=1.74,
        effort=80.0,
    ),
    Joint(name="head_pan", parent="l0", child="head", xyz=(0.0, 0.0, 0.2965)),
    Joint(
        name="right_j1",
        parent="l0",
        child="l1",
        xyz=(0.081, 0.05, 0.237),
        rpy=(-pi / 2, pi / 2, 0.0),
        type="revolute",
        lower=-3.8095,
        upper=2.2736,
        velocity=1.328,
        effort=80.0,
    ),
    Joint(
        name="right_j2",
        parent="l1",
        child="l2",
        xyz=(0.0, -0.14, 0.1425),
        rpy=(pi / 2, 0.0, 0.0),
        type="revolute",
        lower=-3.0426,
        upper=3.0426,
        velocity=1.957,
        effort=40.0,
    ),
    Joint(
        name="right_j3",
        parent="l2",
        child="l3",
        xyz=(0.0, -0.042, 0.26),
        rpy=(-pi / 2, 0.0, 0.0),
        type="revolute",
        lower=-3.0439,
        upper=3.0439,
        velocity=1.957,
        effort=40.0,
    ),
    Joint(
        name="right_j4",
        parent="l3",
        child="l4",
        xyz=(0.0, -0.125, -0.1265),
        rpy=(pi / 2, 0.0, 0.0),
        type="revolute",
        lower=-2.9761,
        upper=2.9761,
        velocity=3.485,
        effort=9.0,
    ),
    Joint(
        name="right_j5",
        parent="l4",
        child="l5",
        xyz=(0.0, 0.031, 0.275),
        rpy=(-pi / 2, 0.0, 0.0),
        type="revolute",
        lower=-2.9761,
        upper=2.9761,
        velocity=3.485,
        effort=9.0,
    ),
    Joint(
        name="right_j6",
        parent="l5",
        child="l6",
        xyz=(0.0, -0.11, 0.1053),
        rpy=(-pi / 2, BUILT_IN_TWIST, pi),
        type="revolute",
        lower=-4.7124,
        upper=4.7124,
        velocity=4.545,
        effort=9.0,
    ),
)

FLANGE_LINK = "l6"
FLANGE_XYZ = (0.0, 0.0, 0.0245)  # The manufacturer's `right_hand` frame, where tools are bolted on.
FLANGE_RPY = (0.0, 0.0, pi / 2)
