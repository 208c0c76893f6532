"""Controllers: their pure functions, their memory, and batches with a topology each."""

import gymnasium as gym
import numpy as np
import pytest
import torch
from robot_stage import make, qpos_of

import maniskill_taskgrasp.tasks  # noqa: F401  (Registers the environment.)
from maniskill_taskgrasp.agents.controllers.arm_path import held
from maniskill_taskgrasp.agents.controllers.coupled_hand import coupled_qpos
from maniskill_taskgrasp.agents.controllers.joint_pos import step_towards
from maniskill_taskgrasp.agents.controllers.joint_synergy import (
    spread_all,
    spread_moving,
    spread_one,
    synergy_to_qpos,
)
from maniskill_taskgrasp.agents.controllers.palm_motion import joint_step, slowed
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.rotations import pose_error
from maniskill_taskgrasp.agents.sawyer_ar10.agent import PRESSING_ITERATIONS, REST_ARM
from maniskill_taskgrasp.agents.sawyer_ar10.control_modes import control_modes
from maniskill_taskgrasp.agents.sawyer_ar10.description import ARM_JOINT_NAMES, SAWYER_AR10
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.episode import CLOSE_START
from maniskill_taskgrasp.topology import TOPOLOGIES

# -- pure functions ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("activation", "expected"),
    [
        ([0.0, 0.0, 0.0], [0.2, 0.4, 1.0]),  # The preshape.
        ([1.0, 1.0, 1.0], [1.2, 0.0, 1.0]),  # Closed; the last joint holds still.
        ([0.5, 0.0, 1.0], [0.7, 0.4, 1.0]),  # One motor moves alone.
        ([2.0, -1.0, 0.0], [1.2, 0.4, 1.0]),  # Clipped to [0, 1].
    ],
)
def test_synergy_to_qpos_known_postures(activation, expected):
    """Linear between preshape and closing, joint by joint."""
    preshape, closing = torch.tensor([[0.2, 0.4, 1.0]]), torch.tensor([[1.2, 0.0, 1.0]])
    found = synergy_to_qpos(torch.tensor([activation]), preshape, closing)
    torch.testing.assert_close(found, torch.tensor([expected]))


@pytest.mark.parametrize(
    ("wanted", "expected"), [(0.03, 0.03), (0.2, 0.05), (-0.2, -0.05), (0.05, 0.05)]
)
def test_step_towards_stops_at_the_wanted_posture_or_the_speed(wanted, expected):
    """Near postures are reached to the last bit, far ones are approached at full speed."""
    found = step_towards(torch.zeros(1, 1), torch.tensor([[wanted]]), torch.tensor([0.05]))
    assert found.item() == torch.tensor(expected).item()


def test_coupled_qpos_is_the_link_rods_line():
    """Ratio and offset joint by joint."""
    found = coupled_qpos(
        torch.tensor([[0.17, 1.57]]), torch.tensor([0.49, 0.49]), torch.tensor(0.16)
    )
    torch.testing.assert_close(found, torch.tensor([[0.2433, 0.9293]]))


def test_held_repeats_the_last_waypoint_only():
    """A longer path ends in copies of its end; a path that is long enough stays as it is."""
    path = torch.arange(6.0).view(1, 3, 2)
    torch.testing.assert_close(held(path, 2), path)
    torch.testing.assert_close(held(path, 5)[:, 3:], path[:, -1:].expand(-1, 2, -1))


def test_spreads_drive_the_motors_they_name():
    """One number a motor, one for each that moves, one for all."""
    moving = np.array([True, False, True])
    ones = np.ones(3)
    np.testing.assert_array_equal(np.array(spread_all(3)), np.eye(3))
    assert np.array(spread_moving(moving)).shape == (2, 3)
    np.testing.assert_array_equal(np.ones(2) @ np.array(spread_moving(moving)), moving)
    np.testing.assert_array_equal(np.array(spread_one(3))[0], ones)


def test_slowed_keeps_the_direction():
    """A step too fast for one joint is shortened as a whole; others pass unchanged."""
    step = torch.tensor([[0.4, -0.1], [0.05, 0.02]])
    found = slowed(step, torch.tensor([0.1, 0.2]))
    torch.testing.assert_close(found, torch.tensor([[0.1, -0.025], [0.05, 0.02]]))


def test_joint_step_moves_the_palm_as_asked():
    """A small twist is carried out to 1 %; near singular postures the step stays bounded."""
    kinematics = ArticulationKinematics.of_description(SAWYER_AR10)
    qpos = torch.zeros(1, kinematics.dof)
    qpos[0, :7] = torch.tensor(REST_ARM)
    pose, jacobian = kinematics.pose_and_jacobian(qpos, "palm_frame")
    twist = torch.tensor([[0.003, -0.002, 0.001, 0.01, 0.0, -0.02]])
    qpos[:, :7] += joint_step(jacobian[:, :, :7], twist)
    after = kinematics.pose_and_jacobian(qpos, "palm_frame")[0]
    moved = pose_error(pose, after[:, :3, 3], after[:, :3, :3])
    assert (moved - twist).abs().max() < 0.01 * twist.abs().max()
    singular = torch.zeros(1, 6, 7)
    singular[0, 0, 0] = 0.02  # As small as the damping: the worst there is.
    assert joint_step(singular, torch.tensor([[1.0, 0, 0, 0, 0, 0]])).abs().max() <= 25.0 + 1e-3


# -- control modes -----------------------------------------------------------------------------


def test_every_mode_of_the_contract_is_there():
    """General modes first (the default of other ManiSkill tasks), then the synergies."""
    modes = list(control_modes(AR10))
    assert modes[0] == "pd_joint_delta_pos"
    general = {"pd_joint_pos", "pd_joint_delta_pos", "pd_ee_delta_pose"}
    synergies = {"pd_synergy", "pd_synergy_1d", "pd_synergy_wrist"}
    assert set(modes) == general | synergies | {f"pd_synergy_{t.slug}" for t in TOPOLOGIES}


@pytest.mark.parametrize("topology", TOPOLOGIES, ids=lambda t: t.slug)
def test_a_topologys_mode_has_one_number_for_each_moving_motor(topology):
    """Motors that hold still get no number, and there is at least one that moves."""
    posture = AR10.postures[topology.slug]
    spread = np.array(control_modes(AR10)[f"pd_synergy_{topology.slug}"]["hand"].spread)
    assert spread.shape == (posture.moving.sum(), len(AR10.actuators))
    np.testing.assert_array_equal(spread.sum(0), posture.moving)
    assert posture.moving.any()


def test_a_topologys_mode_takes_its_posture_without_a_task():
    """In a task that gives no postures, 0 is the named preshape and 1 its closing."""
    slug = "power_pad_abd_2_3"
    posture = AR10.postures[slug]
    env = make(f"pd_synergy_{slug}")
    hand = env.agent.controller.controllers["hand"]
    for activation, expected in ((0.0, posture.preshape), (1.0, posture.closing)):
        for _ in range(40):
            env.step(np.full(env.single_action_space.shape, activation, dtype=np.float32))
        np.testing.assert_allclose(hand.command[0], expected, atol=1e-6)
        np.testing.assert_allclose(qpos_of(env)[env.agent.actuator_indices], expected, atol=0.01)
    env.close()


def test_a_synergy_without_posture_or_path_holds_still():
    """Nothing moves before a task has laid a plan, whatever the action."""
    env = make("pd_synergy_wrist")
    before = qpos_of(env)
    for _ in range(10):
        env.step(env.single_action_space.high)
    np.testing.assert_allclose(qpos_of(env), before, atol=2e-3)
    env.close()


def test_the_palm_residual_is_carried_out_by_the_arm():
    """A corner of the box shifts the palm by 25, 25, 20 mm and 0.3 rad, to 1 mm and 0.01 rad."""
    env = make("pd_synergy_wrist")
    agent = env.agent
    start = agent.tcp_pose.to_transformation_matrix()
    arm = torch.tensor(REST_ARM)
    hand = torch.tensor(AR10.postures["power_palm_abd_2_5"].preshape)[None]
    agent.set_plan(torch.tensor([0]), arm.expand(1, 60, 7), hand, hand, 40)
    action = np.zeros(14, dtype=np.float32)
    action[:4] = 1.0
    for step in range(50):
        env.step(action if step < 40 else -action)  # Frozen after 40 steps.
    after = agent.tcp_pose.to_transformation_matrix()
    error = pose_error(start, after[:, :3, 3], after[:, :3, :3])[0]
    assert error[:3].tolist() == pytest.approx([0.025, 0.025, 0.02], abs=1e-3)
    assert error[3:].tolist() == pytest.approx([0.0, 0.0, 0.3], abs=1e-2)
    env.close()


def test_the_residual_keeps_to_its_rate():
    """6 cm/s and 0.8 rad/s: one step at 20 Hz is 3 mm and 0.04 rad."""
    env = make("pd_synergy_wrist")
    hand = torch.tensor(AR10.postures["power_palm_abd_2_5"].preshape)[None]
    path = torch.tensor(REST_ARM).expand(1, 60, 7)
    env.agent.set_plan(torch.tensor([0]), path, hand, hand, 40)
    env.step(np.array([1, -1, 1, -1, *[0] * 10], dtype=np.float32))
    residual = env.agent.controller.controllers["arm"].residual[0]
    assert residual.tolist() == pytest.approx([0.003, -0.003, 0.003, -0.04], abs=1e-6)
    env.close()


def test_the_hand_keeps_its_preshape_until_it_may_close():
    """Whatever the action; then it closes."""
    env = make("pd_synergy_wrist")
    preshape, closing = (torch.tensor(s)[None] for s in vars_of("power_pad_abd_2"))
    path = torch.tensor(REST_ARM).expand(1, 60, 7)
    env.agent.set_plan(torch.tensor([0]), path, preshape, closing, 40, wait=30)
    hand = env.agent.controller.controllers["hand"]
    for _ in range(30):
        env.step(env.single_action_space.high)
    torch.testing.assert_close(hand.command, preshape.float())
    for _ in range(30):
        env.step(env.single_action_space.high)
    torch.testing.assert_close(hand.command, closing.float())
    env.close()


def test_only_modes_without_a_path_ask_for_more_solver_iterations():
    """And switching back takes them away again."""
    env = make("pd_joint_pos")
    body = env.agent.robot._objs[0]
    pressing = body.get_solver_position_iterations()
    env.agent.set_control_mode("pd_synergy")
    own = body.get_solver_position_iterations()
    env.agent.set_control_mode("pd_joint_pos")
    assert own < PRESSING_ITERATIONS == pressing == body.get_solver_position_iterations()
    env.close()


# -- memory ------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", ["pd_joint_delta_pos", "pd_ee_delta_pose", "pd_synergy_wrist"])
def test_a_restored_robot_repeats_its_motion(mode):
    """Simulation state and controller memory, taken in mid-motion, give the same next steps."""
    env = make(mode)
    rng = np.random.default_rng(0)
    agent, space = env.agent, env.single_action_space
    if mode == "pd_synergy_wrist":
        path = torch.tensor(REST_ARM) + torch.linspace(0, 0.3, 30)[:, None]
        shapes = [torch.tensor(s)[None] for s in vars_of("power_pad_abd_2")]
        agent.set_plan(torch.tensor([0]), path[None], *shapes, 20)
    actions = [rng.uniform(space.low, space.high).astype(np.float32) for _ in range(20)]
    for action in actions[:10]:
        env.step(action)
    physics, memory = agent.robot.get_state().clone(), agent.get_controller_state()
    for action in actions[10:]:
        env.step(action)
    first = qpos_of(env)
    agent.robot.set_state(physics)
    agent.set_controller_state(memory)
    for action in actions[10:]:
        env.step(action)
    np.testing.assert_allclose(qpos_of(env), first, atol=1e-6)
    env.close()


def vars_of(slug):
    """Preshape and closing of a topology."""
    posture = AR10.postures[slug]
    return posture.preshape, posture.closing


def test_memory_is_flat_and_complete():
    """2-D float tensors, one row an environment, as ManiSkill's flat state vectors need."""
    env = make("pd_synergy_wrist")
    memory = env.agent.get_controller_state()
    assert set(memory["arm"]) == {"command", "path", "step", "residual", "open_steps"}
    assert set(memory["hand"]) == {"command", "preshape", "closing", "wait"}
    for fields in memory.values():
        assert all(f.ndim == 2 and f.dtype == torch.float32 for f in fields.values())
    env.close()


# -- batches -----------------------------------------------------------------------------------

FOUR = ["power palm abd 2-5", "precision pad abd 2", "intermediate add 2", "power palm add 3-5"]


@pytest.fixture(scope="module")
def four():
    """Four environments on the CPU, a topology each."""
    env = gym.make(
        "TaskGrasp-v0",
        num_envs=4,
        topology=FOUR,
        objects=["screwdriver"],
        noise="none",
        control_mode="pd_synergy_wrist",
    )
    yield env.unwrapped
    env.close()


def test_each_environment_closes_its_own_topology(four):
    """Same action everywhere, four different postures: activation 1 is each one's closing."""
    four.reset(seed=0)
    hand = four.agent.controller.controllers["hand"]
    assert len({tuple(row.tolist()) for row in hand.closing}) == 4
    action = torch.zeros(4, 14)
    action[:, 4:] = 1.0
    for _ in range(CLOSE_START + 34):  # 1.7 rad at 1.1 rad/s.
        four.step(action)
    assert (hand.command - hand.closing).abs().max() <= 1e-5


def test_a_partial_reset_leaves_running_environments_alone(four):
    """Environment 0 starts anew; the others keep path, step, command and residual."""
    four.reset(seed=0)
    action = torch.zeros(4, 14)
    action[:, 0] = 1.0
    for _ in range(20):
        four.step(action)
    before = four.agent.get_controller_state()
    four.reset(options={"env_idx": torch.tensor([0])})
    after = four.agent.get_controller_state()
    for uid, fields in before.items():
        for name, value in fields.items():
            torch.testing.assert_close(after[uid][name][1:], value[1:], atol=0, rtol=0)
    assert after["arm"]["step"][0].item() == 0
    assert after["arm"]["residual"][0].abs().max() == 0
    torch.testing.assert_close(after["arm"]["command"][0], after["arm"]["path"][0, :7])


def test_some_environments_can_be_restored(four):
    """Memory goes back into the named environments and no other."""
    four.reset(seed=0)
    memory = four.agent.get_controller_state()
    for _ in range(5):
        four.step(torch.zeros(4, 14))
    now = four.agent.get_controller_state()
    chosen = torch.tensor([1, 3])
    part = {uid: {n: v[chosen] for n, v in fields.items()} for uid, fields in memory.items()}
    four.agent.set_controller_state(part, chosen)
    found = four.agent.get_controller_state()
    assert found["arm"]["step"].flatten().tolist() == [5, 0, 5, 0]
    torch.testing.assert_close(found["arm"]["command"][chosen], memory["arm"]["command"][chosen])
    torch.testing.assert_close(found["arm"]["command"][::2], now["arm"]["command"][::2])


def test_arm_names_are_the_descriptions():
    """Controllers and description list the same seven joints."""
    for mode in control_modes(AR10).values():
        assert tuple(mode["arm"].joint_names) == ARM_JOINT_NAMES
