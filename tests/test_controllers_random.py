"""Random steps in every control mode: states stay finite and joints inside their limits."""

import numpy as np
import pytest
import torch
from robot_stage import make, qpos_of

from maniskill_taskgrasp.agents.sawyer_ar10.control_modes import control_modes
from maniskill_taskgrasp.agents.sawyer_ar10.description import SAWYER_AR10
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10

MODES = tuple(control_modes(AR10))
LIMIT_TOLERANCE = 0.02  # [rad]


def lay_random_plan(env, rng):
    """Between `rest` and `neutral`, with random hand postures."""
    keyframes = env.agent.keyframes
    ends = [keyframes[name].qpos[env.agent.arm_indices.numpy()] for name in ("rest", "neutral")]
    share = np.concatenate([np.linspace(0, 1, 60), np.linspace(1, 0, 60)])[None, :, None]
    path = ends[0] + share * (ends[1] - ends[0])
    joints = [SAWYER_AR10.joint(name) for name in AR10.actuators]
    low, high = [j.lower for j in joints], [j.upper for j in joints]
    preshape, closing = (torch.tensor(rng.uniform(low, high))[None].float() for _ in range(2))
    env.agent.set_plan(torch.tensor([0]), torch.tensor(path).float(), preshape, closing, 120)


def random_steps(mode, num_steps, seed=0, solver_iterations=None):
    """Largest overrun of a joint limit [rad] over random steps; every state must be finite.

    Half of the actions lie on the bounds, and each is held for up to 20 steps, so that joints are
    driven to their limits and the arm into the table.
    """
    env = make(mode, table=True)
    if solver_iterations is not None:
        env.agent.robot._objs[0].set_solver_position_iterations(solver_iterations)
    rng = np.random.default_rng(seed)
    space = env.single_action_space
    limits = env.agent.robot.get_qlimits()[0].numpy()
    overrun, action = 0.0, space.low
    for step in range(num_steps):
        if step % 120 == 0 and "synergy" in mode:
            lay_random_plan(env, rng)
        if step % 20 == 0 or rng.uniform() < 0.1:
            action = rng.uniform(space.low, space.high)
            extreme = np.where(rng.uniform(size=action.shape) < 0.5, space.low, space.high)
            action = np.where(rng.uniform() < 0.5, extreme, action).astype(np.float32)
        env.step(action)
        state = env.agent.robot.get_state()
        assert torch.isfinite(state).all(), step
        qpos = qpos_of(env)
        overrun = max(overrun, (limits[:, 0] - qpos).max(), (qpos - limits[:, 1]).max())
    env.close()
    return overrun


@pytest.mark.parametrize("mode", MODES)
def test_random_steps_stay_finite_and_inside_the_limits(mode):
    """Some hundred random steps: no NaN, joint limits respected within 0.02 rad."""
    num_steps = 300 if mode in MODES[:6] else 40
    assert random_steps(mode, num_steps) <= LIMIT_TOLERANCE


@pytest.mark.slow
@pytest.mark.parametrize("mode", MODES)
def test_ten_thousand_random_steps_stay_finite_and_inside_the_limits(mode, record_property):
    """The same over 10,000 steps."""
    overrun = random_steps(mode, 10_000, seed=1)
    record_property("overrun_rad", overrun)
    assert overrun <= LIMIT_TOLERANCE


@pytest.mark.slow
def test_it_takes_the_iterations_of_these_modes():
    """Same actions, the task's 12 solver iterations: pressed into the table, a stop gives way."""
    assert random_steps("pd_joint_pos", 10_000, seed=1, solver_iterations=12) > LIMIT_TOLERANCE
