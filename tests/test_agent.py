"""The robot as a ManiSkill agent: keyframes, registration, and a task we did not write."""

import gymnasium as gym
import numpy as np
import pytest
import torch
from mani_skill.agents.registration import REGISTERED_AGENTS
from robot_stage import make, qpos_of

from maniskill_taskgrasp.agents import SawyerAR10
from maniskill_taskgrasp.agents.sawyer_ar10.agent import NEUTRAL_ARM, REST_ARM
from maniskill_taskgrasp.agents.sawyer_ar10.description import ARM_JOINT_NAMES
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.tasks.rendering import rendering_available
from maniskill_taskgrasp.topology import TOPOLOGIES

PINCH = AR10.postures["power_pad_abd_2_3"]
HOVER = 0.10  # [m] above the cube


@pytest.fixture(scope="module")
def alone():
    """The robot on an empty stage."""
    env = make("pd_joint_pos")
    yield env
    env.close()


def test_importing_the_package_registers_the_robot():
    """`robot_uids="sawyer_ar10"` works in any ManiSkill task from then on."""
    assert REGISTERED_AGENTS["sawyer_ar10"].agent_cls is SawyerAR10


def test_keyframes_are_named_and_inside_all_limits(alone):
    """`rest`, `neutral`, one pregrasp a topology; coupled joints where their link rods put them."""
    keyframes = alone.agent.keyframes
    assert set(keyframes) == {"rest", "neutral", *(f"pregrasp_{t.slug}" for t in TOPOLOGIES)}
    limits = alone.agent.robot.get_qlimits()[0].numpy()
    names = [j.name for j in alone.agent.robot.active_joints]
    for name, keyframe in keyframes.items():
        assert (keyframe.qpos >= limits[:, 0]).all(), name
        assert (keyframe.qpos <= limits[:, 1]).all(), name
        for c in AR10.couplings:
            expected = c.ratio * keyframe.qpos[names.index(c.source)] + c.offset
            assert keyframe.qpos[names.index(c.joint)] == pytest.approx(expected, abs=1e-6)


def test_pregrasp_keyframes_hold_the_preshape(alone):
    """The hand's motors stand at the topology's preshape."""
    columns = alone.agent.actuator_indices.numpy()
    for slug, posture in AR10.postures.items():
        hand = alone.agent.keyframes[f"pregrasp_{slug}"].qpos[columns]
        np.testing.assert_allclose(hand, posture.preshape, atol=1e-6)


def test_full_qpos_keeps_the_batch_and_the_joint_order(alone):
    """Arm and hand go to their own columns, whatever the batch shape."""
    agent = alone.agent
    arm, hand = np.tile([REST_ARM, NEUTRAL_ARM], (3, 1, 1)), np.ones((3, 2, 10))
    qpos = agent.full_qpos(arm, hand)
    assert qpos.shape == (3, 2, 21)
    np.testing.assert_allclose(qpos[..., agent.arm_indices.numpy()], arm, rtol=1e-6)
    np.testing.assert_allclose(qpos[..., agent.actuator_indices.numpy()], hand)


def test_a_new_robot_stands_in_rest(alone):
    """ManiSkill would start at all zeros, which lies outside the hand's limits."""
    alone.reset(seed=0)
    np.testing.assert_allclose(qpos_of(alone), alone.agent.keyframes["rest"].qpos, atol=1e-6)


def test_tcp_is_the_palm_facing_down_in_rest(alone):
    """+y of the palm frame points down and +z, along the fingers, ahead: 0.75 m out, 0.25 m up."""
    alone.reset(seed=0)
    frame = alone.agent.tcp_pose.to_transformation_matrix()[0].numpy()
    assert frame[2, 1] < -0.95
    assert frame[0, 2] > 0.95
    np.testing.assert_allclose(frame[:3, 3], [0.75, 0.0, 0.25], atol=0.06)
    np.testing.assert_allclose(alone.agent.tcp_pos[0], frame[:3, 3], atol=1e-6)


def test_static_means_the_arm_not_the_fingers(alone):
    """A moving arm joint is seen, moving fingers are not."""
    alone.reset(seed=0)
    robot, agent = alone.agent.robot, alone.agent
    qvel = torch.zeros(1, 21)
    qvel[:, agent.actuator_indices] = 1.0
    robot.set_qvel(qvel)
    assert bool(agent.is_static()[0])
    qvel[:, agent.arm_indices[3]] = 0.3
    robot.set_qvel(qvel)
    assert not bool(agent.is_static()[0])


def test_grasping_nothing_in_particular_is_refused(alone):
    """The question needs an object."""
    with pytest.raises(ValueError, match="needs the object"):
        alone.agent.is_grasping()


# -- PickCube-v1 -------------------------------------------------------------------------------


class Script:
    """Grasps the cube with `pd_ee_delta_pose`, knowing where it is."""

    def __init__(self, env):
        self.env, self.agent = env, env.agent
        self.cube = env.cube.pose.p[0].numpy().copy()

    def miss(self, height):
        """(3,) [m] from the grasp centre to a point above where the cube was."""
        frame = self.agent.tcp_pose.to_transformation_matrix()[0].numpy()
        centre = frame[:3, 3] + frame[:3, :3] @ PINCH.grasp_centre
        return self.cube + np.array([0.0, 0.0, height]) - centre

    def move(self, displacement, hand):
        """One step: palm by up to 2 cm, motors towards a posture at up to full speed."""
        command = self.agent.controller.controllers["hand"].command[0].numpy()
        close = (np.asarray(hand) - command) / (AR10.speed_limit / 20)
        action = np.concatenate([np.asarray(displacement) / 0.02, np.zeros(3), close])
        return self.env.step(action.clip(-1, 1).astype(np.float32))[-1]


@pytest.fixture(scope="module")
def episode():
    """What happened, step by step, when the script picked PickCube's cube."""
    if not rendering_available():
        pytest.skip("ManiSkill's table has no collision-only version: a Vulkan device is needed")
    env = gym.make(
        "PickCube-v1",
        robot_uids="sawyer_ar10",
        control_mode="pd_ee_delta_pose",
        obs_mode="state",
        max_episode_steps=1000,
    ).unwrapped
    env.reset(seed=0)
    script, seen = Script(env), {"qpos": qpos_of(env)}
    seen["limits"] = env.agent.robot.get_qlimits()[0].numpy()
    for _ in range(40):
        script.move(script.miss(HOVER), PINCH.preshape)
    seen["above"] = script.miss(HOVER)
    seen["camera"] = env.get_sensor_images()["hand_camera"]["rgb"][0].numpy()
    seen["touched_early"] = bool(env.agent.is_grasping(env.cube)[0])
    for _ in range(20):
        script.move(script.miss(0.0), PINCH.preshape)
    for _ in range(30):
        info = script.move(np.zeros(3), PINCH.closing)
    seen["grasped"] = bool(info["is_grasped"][0])
    links = [link for links in env.agent.part_links.values() for link in links]
    forces = [env.scene.get_pairwise_contact_forces(link, env.cube)[0] for link in links]
    seen["force"] = max(float(force.norm()) for force in forces)
    for _ in range(30):
        script.move([0.0, 0.0, 0.01], PINCH.closing)
    seen["rise"] = float(env.cube.pose.p[0, 2]) - script.cube[2]
    yield seen
    env.close()


def test_pick_cube_starts_in_rest_inside_all_limits(episode):
    """A task that does not know the robot still gets it in a possible posture."""
    assert (episode["qpos"] >= episode["limits"][:, 0]).all()
    assert (episode["qpos"] <= episode["limits"][:, 1]).all()


def test_pick_cube_arm_reaches_the_cube(episode):
    """`pd_ee_delta_pose` brings the grasp centre to the wanted point within 2 mm."""
    assert np.abs(episode["above"]).max() < 2e-3


def test_pick_cube_contact_is_reported(episode):
    """Nothing is grasped from 10 cm above; closed, the hand presses and says so."""
    assert not episode["touched_early"]
    assert episode["grasped"]
    assert episode["force"] > 0.5


def test_pick_cube_is_lifted(episode):
    """The hand carries the cube up, 20 cm and more."""
    assert episode["rise"] > 0.2


def test_wrist_camera_sees_the_cube_and_the_hand(episode):
    """From 10 cm above: some red cube in the picture, some dark hand, and not only these."""
    picture = episode["camera"][..., :3].astype(int)
    red = (picture[..., 0] > 120) & (picture[..., 1:].max(-1) < 60)
    dark = picture.max(-1) < 60
    assert 0.005 < red.mean() < 0.5
    assert 0.02 < dark.mean() < 0.7
    assert picture.reshape(-1, 3).std(0).min() > 5


def test_arm_columns_are_the_arms(alone):
    """Indices are found by name: SAPIEN's joint order is breadth-first."""
    names = [j.name for j in alone.agent.robot.active_joints]
    assert [names[i] for i in alone.agent.arm_indices] == list(ARM_JOINT_NAMES)
    assert [names[i] for i in alone.agent.actuator_indices] == list(AR10.actuators)
