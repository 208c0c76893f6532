"""Fusing links that cannot move against each other: same places, same masses, same motion."""

from xml.etree import ElementTree as ET

import numpy as np
import pytest
import sapien
import torch

from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.robot_model import (
    Box,
    Inertia,
    Joint,
    Link,
    Robot,
    rotation,
    rpy_of,
)
from maniskill_taskgrasp.agents.sawyer_ar10.build import default_folder, urdf
from maniskill_taskgrasp.agents.sawyer_ar10.description import SAWYER_AR10, SIMULATED
from maniskill_taskgrasp.agents.sawyer_ar10.fuse import Fusion, fuse

AS_DESCRIBED = Fusion(
    SAWYER_AR10, {link.name: (link.name, np.eye(4)) for link in SAWYER_AR10.links}
)
"""The robot with nothing fused."""


def random_posture(seed=0):
    """Joint -> [rad], anywhere within half a turn."""
    moving = [joint.name for joint in SAWYER_AR10.joints if joint.type == "revolute"]
    return dict(
        zip(moving, np.random.default_rng(seed).uniform(-1.5, 1.5, len(moving)), strict=True)
    )


def link_poses(robot, posture):
    """Link -> (4, 4) pose in the root."""
    kinematics = ArticulationKinematics.of_description(robot)
    qpos = torch.tensor([[posture[name] for name in kinematics.joint_names]]).double()
    matrices = kinematics.link_matrices(qpos)[0].numpy()
    return {link: matrices[kinematics.link_index(link)] for link in kinematics.link_names}


def arm(joint_xyz=(0.0, 0.0, 0.5), mount_xyz=(0.0, 0.0, 0.1)):
    """Base, an upper arm on a hinge about z, and a tool that is bolted to it askew."""
    box = Box(name="box", size=(0.1, 0.2, 0.3))
    inertia = Inertia(mass=2.0, com=(0.0, 0.1, 0.0), xx=0.1, yy=0.2, zz=0.3, xy=0.01)
    return Robot(
        name="arm",
        root="base",
        links=(
            Link(name="base"),
            Link(name="upper", inertia=inertia, collisions=(box,)),
            Link(name="tool", inertia=inertia, collisions=(box,)),
        ),
        joints=(
            Joint(name="turn", parent="base", child="upper", xyz=joint_xyz, type="revolute"),
            Joint(name="mount", parent="upper", child="tool", xyz=mount_xyz, rpy=(0.3, 0.0, 1.0)),
        ),
    )


@pytest.mark.parametrize("keep", [(), ("tool",)])
def test_either_of_two_links_takes_the_other_in(keep):
    """One body of both masses is left, named and placed as was asked, with the shapes of both."""
    fusion = fuse(arm(), keep)
    (base, body), (joint,) = fusion.robot.links, fusion.robot.joints
    assert (base.name, body.name) == ("base", "tool" if keep else "upper")
    assert (joint.name, joint.child) == ("turn", body.name)
    assert body.inertia.mass == 4.0
    assert len(body.collisions) == 2
    assert body.collisions[0] == arm().link(body.name).collisions[0]


def test_a_kept_link_off_the_axis_is_refused():
    """Its frame would swing about the joint instead of turning with it."""
    with pytest.raises(ValueError, match="'tool' stands off the axis of joint 'turn'"):
        fuse(arm(mount_xyz=(0.1, 0.0, 0.0)), ("tool",))


def test_links_that_are_both_kept_stay_apart():
    """Nothing is left to fuse."""
    robot = arm()
    assert fuse(robot, ("upper", "tool")).robot == robot


@pytest.mark.parametrize(
    "angles", [(0.3, -0.7, 2.0), (0.4, np.pi / 2, 0.0), (1.0, -np.pi / 2, 0.2)]
)
def test_angles_of_a_rotation_give_it_back(angles):
    """Also where pitch is upright and roll and yaw turn about the same axis."""
    turn = rotation(angles)
    np.testing.assert_allclose(rotation(rpy_of(turn)), turn, atol=1e-9)


def test_only_joints_that_move_are_left_and_the_palm_frame():
    """21 hinges, and one fixed joint for ManiSkill's sake."""
    fixed = [joint.child for joint in SIMULATED.robot.joints if joint.type == "fixed"]
    assert fixed == ["palm_frame"]
    assert len(SIMULATED.robot.links) == 21 + 2


@pytest.mark.parametrize("robot", [SAWYER_AR10, arm()], ids=["sawyer_ar10", "arm"])
def test_every_link_is_where_it_was(robot):
    """In any posture, all frames of the original robot are found on the links that carry them."""
    fusion = SIMULATED if robot is SAWYER_AR10 else fuse(robot, ("tool",))
    for seed in range(3):
        posture = random_posture(seed) | {"turn": 0.7}
        before, after = link_poses(robot, posture), link_poses(fusion.robot, posture)
        for link, (carrier, at) in fusion.frames.items():
            np.testing.assert_allclose(after[carrier] @ at, before[link], atol=2e-6, err_msg=link)


def moments(robot, posture):
    """(4, 4) second moments of all mass, homogeneous: its amount, its centre and its inertia."""
    poses, total = link_poses(robot, posture), np.zeros((4, 4))
    for link in robot.links:
        if link.inertia is not None:
            tensor, com = link.inertia.matrix(), np.array(link.inertia.com)
            own = np.zeros((4, 4))
            own[:3, :3] = np.trace(tensor) / 2 * np.eye(3) - tensor
            own += link.inertia.mass * np.outer([*com, 1], [*com, 1])
            total += poses[link.name] @ own @ poses[link.name].T
    return total


@pytest.mark.parametrize("robot", [SAWYER_AR10, arm()], ids=["sawyer_ar10", "arm"])
def test_mass_is_where_it_was(robot):
    """In any posture, mass, centre of mass and inertia of the whole robot are the same."""
    fusion = SIMULATED if robot is SAWYER_AR10 else fuse(robot, ("tool",))
    for seed in range(3):
        posture = random_posture(seed) | {"turn": 0.7}
        found, expected = moments(fusion.robot, posture), moments(robot, posture)
        np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_shapes_and_pictures_are_where_they_were():
    """Every collision shape and every mesh of the shipped file, in some posture, in the root."""
    posture = random_posture()
    before, after = link_poses(SAWYER_AR10, posture), link_poses(SIMULATED.robot, posture)

    def shapes(robot, poses):
        placed = {}
        for link in robot.links:
            for shape in link.collisions:
                at = np.eye(4)
                at[:3, :3], at[:3, 3] = rotation(shape.rpy), shape.xyz
                placed.setdefault(shape.name, []).append(poses[link.name] @ at)
        return {name: np.array(sorted(p.tolist() for p in own)) for name, own in placed.items()}

    expected = shapes(SAWYER_AR10, before)
    for name, found in shapes(SIMULATED.robot, after).items():
        np.testing.assert_allclose(found, expected[name], atol=2e-6, err_msg=name)
    drawn = 0
    for link in ET.parse(default_folder() / "sawyer_ar10.urdf").getroot().iter("link"):
        for visual in link.iter("visual"):
            mesh, origin = visual.find("geometry/mesh"), visual.find("origin")
            at = np.eye(4)
            at[:3, 3] = [float(x) for x in origin.get("xyz").split()]
            at[:3, :3] = rotation([float(x) for x in origin.get("rpy").split()])
            part = mesh.get("filename").removeprefix("meshes/").removesuffix(".glb")
            if part in before:  # The four fingers share theirs, in their own links' frames.
                found = after[link.get("name")] @ at
                np.testing.assert_allclose(found, before[part], atol=2e-6, err_msg=part)
                drawn += 1
    assert drawn == 13


@pytest.fixture
def own_physics():
    """SAPIEN's settings are global, and other tests leave theirs."""
    physx = sapien.physx
    before = physx.get_scene_config(), physx.get_body_config(), physx.get_shape_config()
    physx.set_scene_config(physx.PhysxSceneConfig())
    physx.set_body_config(physx.PhysxBodyConfig())
    physx.set_shape_config(physx.PhysxShapeConfig())
    yield
    physx.set_scene_config(before[0])
    physx.set_body_config(before[1])
    physx.set_shape_config(before[2])


def thrown_about(fusion, path, palm_mass=None):
    """(200, 21) [rad] joints of the robot that SAPIEN loads, driven from one posture to another."""
    path.write_text(urdf(fusion, {}))
    stage = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    loader = stage.create_urdf_loader()
    loader.fix_root_link = True
    robot = loader.load(str(path))
    for link in robot.links:
        if link.name == "hand_base" and palm_mass:
            link.mass = palm_mass
        for shape in link.collision_shapes:
            shape.set_collision_groups([0, 0, 0, 0])
    rng, seen = np.random.default_rng(0), []
    for _ in range(4):
        for joint in robot.active_joints:
            strong = joint.name.startswith("right")
            joint.set_drive_properties(*((2000, 200) if strong else (8, 0.4)))
            (lower, upper), share = joint.limits[0], rng.uniform(0.2, 0.8)
            joint.set_drive_target(share - 0.5 if strong else lower + share * (upper - lower))
        for _ in range(50):
            stage.step()
            seen.append(robot.qpos)
    return np.array(seen)


@pytest.mark.usefixtures("own_physics")
def test_sapien_moves_it_as_before(tmp_path):
    """Driven about, the robot stays within 0.5 mrad of the one with all its links.

    What is left are the weights that SAPIEN's mere frames must have. For comparison, 2 % more mass
    of the palm alone moves some joint by more than that.
    """
    path = tmp_path / "robot.urdf"
    expected = thrown_about(AS_DESCRIBED, path)
    assert np.ptp(expected, axis=0).min() > 0.1
    np.testing.assert_allclose(thrown_about(SIMULATED, path), expected, atol=5e-4)
    heavier = thrown_about(AS_DESCRIBED, path, 1.02 * SAWYER_AR10.link("hand_base").inertia.mass)
    assert np.abs(heavier - expected).max() > 5e-4
