"""The robot that ManiSkill makes of the files: joints, shapes, kinematics, self-collision."""

import itertools
import json

import numpy as np
import pytest

from maniskill_taskgrasp.agents.robot_model import Box, rotation
from maniskill_taskgrasp.agents.sawyer_ar10.build import default_folder
from maniskill_taskgrasp.agents.sawyer_ar10.description import (
    ARM_JOINT_NAMES,
    COUPLED_JOINT_NAMES,
    HAND_JOINT_NAMES,
    SAWYER_AR10,
    SIMULATED,
)
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10

MOVING = (*ARM_JOINT_NAMES, *HAND_JOINT_NAMES, *COUPLED_JOINT_NAMES)
TIPS = tuple(link.name for link in SAWYER_AR10.links if link.name.endswith("_tip"))
FK_TOLERANCE = 5e-4  # [m]


@pytest.fixture(scope="module")
def sheet(shared_dir):
    """The fact sheet of the robot."""
    return json.loads((shared_dir / "facts" / "robot.json").read_text())


@pytest.fixture(scope="module")
def loaded():
    """The visual-less robot, loaded by ManiSkill's own loader with no render device."""
    return load_robot("sawyer_ar10_collision.urdf")


def load_robot(filename):
    """ManiSkill articulation of one of the shipped files, alone in a CPU scene."""
    import sapien
    import torch
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.envs.utils.system.backend import parse_sim_and_render_backend

    sub_scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    backend = parse_sim_and_render_backend("physx_cpu", "none")
    scene = ManiSkillScene([sub_scene], device=torch.device("cpu"), backend=backend)
    loader = scene.create_urdf_loader()
    loader.name = SAWYER_AR10.name
    return loader.load(str(default_folder() / filename))


def place(robot, posture):
    """Put the loaded robot into `posture`, a dict of joint angles [rad]; the rest goes to zero."""
    names = [joint.name for joint in robot.active_joints]
    robot.set_qpos(np.array([[posture.get(name, 0.0) for name in names]], dtype=np.float32))


def pose_of(robot, link):
    """(4, 4) world pose of a described link, which another may carry in the loaded robot."""
    carrier, at = SIMULATED.frames[link]
    return robot.links_map[carrier].pose.to_transformation_matrix()[0].numpy() @ at


def position(robot, link):
    """(3,) [m] world position of a described link's frame."""
    return pose_of(robot, link)[:3, 3]


def chain_positions(joints, posture):
    """(3,) [m] position of every link in the root, by an own product along a table of joints.

    Args:
        joints: dicts with name, parent, child, xyz, rpy, axis, parents before their children.
        posture: joint angles [rad]; a joint that is not named stands at zero.
    """
    from scipy.spatial.transform import Rotation

    poses = {"base": (np.zeros(3), Rotation.identity())}
    for joint in joints:
        origin, turn = poses[joint["parent"]]
        angle = posture.get(joint["name"], 0.0)
        spin = Rotation.from_rotvec(angle * np.array(joint["axis"]))
        local = Rotation.from_euler("xyz", joint["rpy"])
        poses[joint["child"]] = (origin + turn.apply(joint["xyz"]), turn * local * spin)
    return {link: origin for link, (origin, _) in poses.items()}


def coupled(hand_posture):
    """`hand_posture` with the four distal joints where their link rods put them."""
    distal = {
        coupling.joint: coupling.ratio * hand_posture[coupling.source] + coupling.offset
        for coupling in AR10.couplings
    }
    return hand_posture | distal


def test_loads_with_21_moving_joints_their_limits_and_masses(loaded):
    """ManiSkill makes of the file the joints, ranges and masses that the description states."""
    assert sorted(joint.name for joint in loaded.active_joints) == sorted(MOVING)
    limits = loaded.get_qlimits()[0].numpy()
    for joint, found in zip(loaded.active_joints, limits, strict=True):
        stated = SAWYER_AR10.joint(joint.name)
        np.testing.assert_allclose(found, [stated.lower, stated.upper], atol=1e-6)
    assert len(loaded.links) == len(SIMULATED.robot.links)
    for link in SIMULATED.robot.links:
        mass = loaded.links_map[link.name].mass[0].item()
        assert mass == pytest.approx(link.inertia.mass if link.inertia else 1e-5, rel=1e-6)


def test_loaded_collision_shapes_point_the_stated_way(loaded):
    """The loader turns cylinders onto the stated axis and keeps boxes as they are."""
    for link in SIMULATED.robot.links:
        shapes = loaded.links_map[link.name]._objs[0].collision_shapes
        assert len(shapes) == len(link.collisions)
        for shape, primitive in zip(shapes, link.collisions, strict=True):
            matrix = shape.local_pose.to_transformation_matrix()
            np.testing.assert_allclose(matrix[:3, 3], primitive.xyz, atol=1e-6)
            turn = rotation(primitive.rpy)
            if isinstance(primitive, Box):
                np.testing.assert_allclose(shape.half_size, np.array(primitive.size) / 2, atol=1e-7)
                np.testing.assert_allclose(matrix[:3, :3], turn, atol=1e-5)
            else:  # SAPIEN's cylinders run along their own x.
                found = [shape.radius, 2 * shape.half_length]
                np.testing.assert_allclose(found, [primitive.radius, primitive.length], atol=1e-6)
                assert abs(matrix[:3, 0] @ turn[:, 2]) > 1 - 1e-5


HAND_REFERENCES = {
    "open (all joints at lower limit)": {
        name: SAWYER_AR10.joint(name).lower for name in HAND_JOINT_NAMES
    },
    "half (mcp=pip=0.87, thumb_cmc 1.5, thumb_flex 0.92)": {
        name: {"thumb_cmc": 1.5, "thumb_flex": 0.92}.get(name, 0.87) for name in HAND_JOINT_NAMES
    },
    "closed (all at upper limit)": {
        name: SAWYER_AR10.joint(name).upper for name in HAND_JOINT_NAMES
    },
}


@pytest.mark.parametrize("reference", HAND_REFERENCES)
def test_hand_kinematics_match_the_reference(loaded, sheet, reference):
    """Every fingertip of the loaded hand is within 0.5 mm of the reference table, in hand_base."""
    place(loaded, coupled(HAND_REFERENCES[reference]))
    to_hand = np.linalg.inv(pose_of(loaded, "hand_base"))
    table = sheet["fk_reference"]["hand_base frame, coupled DIP"][reference]
    assert set(table) == set(TIPS)
    for tip, expected in table.items():
        found = (to_hand @ pose_of(loaded, tip))[:3, 3]
        assert np.linalg.norm(found - expected) <= FK_TOLERANCE, tip


def test_arm_kinematics_match_the_reference(loaded, sheet):
    """Wrist plate and palm of the loaded arm are within 0.5 mm and 0.001 of the reference table."""
    for name, entry in sheet["fk_reference"]["arm, in base frame"].items():
        place(loaded, dict(zip(ARM_JOINT_NAMES, entry["q"], strict=True)))
        for link in ("hand_base", "palm_frame"):
            distance = np.linalg.norm(position(loaded, link) - entry[f"{link}_xyz"])
            assert distance <= FK_TOLERANCE, (name, link)
        matrix = loaded.links_map["hand_base"].pose.to_transformation_matrix()[0].numpy()
        np.testing.assert_allclose(matrix[:3, :3], entry["hand_base_R_rows"], atol=1e-3)


def test_random_postures_match_an_independent_chain(loaded, sheet):
    """In 100 random postures every fingertip and arm link is where the sheet's joint table says."""
    generator = np.random.default_rng(3)
    for _ in range(100):
        posture = {
            name: generator.uniform(SAWYER_AR10.joint(name).lower, SAWYER_AR10.joint(name).upper)
            for name in MOVING
        }
        place(loaded, posture)
        for link, expected in chain_positions(sheet["joints"], posture).items():
            assert np.linalg.norm(position(loaded, link) - expected) <= FK_TOLERANCE, link


def touching_links(robot, arm):
    """Pairs of links that overlap with the arm at `arm` [rad] and the hand open."""
    hand = HAND_REFERENCES["open (all joints at lower limit)"]
    place(robot, coupled(hand) | dict(zip(ARM_JOINT_NAMES, arm, strict=True)))
    robot.set_qvel(np.zeros((1, len(MOVING)), dtype=np.float32))
    scene = robot.scene.sub_scenes[0]
    scene.physx_system.timestep = 1e-4
    scene.step()
    return {
        tuple(sorted(body.name.split("_", 3)[-1] for body in contact.bodies))
        for contact in scene.get_contacts()
        if any(point.separation < 0 for point in contact.points)
    }


def test_named_arm_postures_touch_nothing(sheet):
    """With self-collision on, no two links touch at zero, neutral or on the arm paths.

    The paper's own initial posture does touch, which shows that the check sees something.
    """
    robot = load_robot("sawyer_ar10_collision.urdf")
    named = sheet["fk_reference"]["arm, in base frame"]
    paths = sheet["arm_paths_in_base_frame_keyed_by_palm_height"].values()
    waypoints = itertools.chain.from_iterable(path.values() for path in paths)
    for arm in ([0.0] * 7, named["manufacturer neutral"]["q"], *waypoints):
        assert not touching_links(robot, arm), arm
    assert touching_links(robot, named["authors armInitial (head_pan removed)"]["q"])
