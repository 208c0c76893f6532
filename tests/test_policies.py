"""Laws of policies by name: what is shipped fits the task, and unknown ones are refused."""

import gymnasium as gym
import pytest
import torch

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.pipeline import policy_maker
from maniskill_taskgrasp.tasks.closing import HoverRule


@pytest.mark.parametrize("distance", ["exact", "noisy", "none"])
def test_the_shipped_policy_of_each_track_acts_in_the_box(distance):
    make_policy, kwargs = policy_maker("learned", distance)
    assert kwargs["distance"] == distance
    env = gym.make(
        "TaskGrasp-v0", num_envs=2, objects=["screwdriver"], sim_backend="physx_cpu", **kwargs
    )
    obs, _ = env.reset(seed=0)
    action = make_policy(env)(obs)
    env.close()
    box = env.unwrapped.single_action_space
    assert action.shape == (2, *box.shape)
    assert torch.isfinite(action).all()
    assert (action >= torch.tensor(box.low)).all() and (action <= torch.tensor(box.high)).all()


def test_rules_bring_the_control_mode_that_they_need():
    make_policy, kwargs = policy_maker("hover-rule", "noisy")
    assert make_policy is HoverRule
    assert kwargs == {"control_mode": "pd_synergy_wrist", "distance": "noisy"}


def test_an_unknown_policy_is_refused_in_one_line():
    with pytest.raises(InputError, match="no policy file 'nosuch'"):
        policy_maker("nosuch")
