"""Laws of the imitation that PPO may start from, on a toy task."""

import importlib.util
from pathlib import Path

import pytest
import torch

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.ppo import parse_config
from maniskill_taskgrasp.train.ppo_agent import ActionScaler, Agent, ObsNormalizer
from maniskill_taskgrasp.train.ppo_config import check_config
from maniskill_taskgrasp.train.teaching import Teacher, teach

TOY = Path(__file__).with_name("toy_reach.py")
FLAGS = "--env-id Toy-v0 --num-envs 32 --num-steps 20 --num-minibatches 2 --total-timesteps 640"


@pytest.fixture
def pupil():
    spec = importlib.util.spec_from_file_location("toy_reach", TOY)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    torch.manual_seed(0)
    envs = module.ToyReach(32)
    obs, _ = envs.reset(seed=list(range(32)))
    return envs, Agent(3, 2), ObsNormalizer(3), ActionScaler(envs.single_action_space), obs


def test_teach_makes_the_network_act_as_the_rule_does(pupil):
    """The rule knows the target; imitation from observations comes close to it."""
    envs, agent, normalizer, scaler, obs = pupil
    config = parse_config(f"{FLAGS} --teacher-lessons 12".split())
    difference = teach(envs, agent, normalizer, scaler, lambda _: envs.target.clone(), obs, config)
    assert difference < 0.02
    fresh, _ = envs.reset(seed=list(range(100, 132)))
    action = scaler(agent.actor_mean(normalizer(fresh)))
    assert (action - envs.target).abs().mean() < 0.1
    assert torch.allclose(agent.actor_logstd, torch.tensor(config.teacher_logstd))


def test_inverse_undoes_the_scaling(pupil):
    scaler = pupil[3]
    action = torch.rand(5, 2, generator=torch.Generator().manual_seed(0))
    torch.testing.assert_close(scaler(scaler.inverse(action)), action)


def test_teacher_acts_near_its_advice_and_the_pupil_by_itself(pupil):
    _, agent, _, scaler, _ = pupil
    with torch.no_grad():
        agent.actor_logstd.fill_(-9.0)
        agent.actor_mean[-1].bias.fill_(0.5)
    teacher = Teacher(lambda _: torch.full((4, 2), 0.2), scaler, agent)
    obs = torch.zeros(4, 3)
    torch.testing.assert_close(teacher.act(obs)[0], torch.full((4, 2), -0.6), atol=1e-2, rtol=0)
    teacher.acts = False
    own = agent.actor_mean(obs)
    torch.testing.assert_close(teacher.act(obs)[0], own, atol=1e-2, rtol=0)
    assert len(teacher.advice) == 2


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ("--env-id PickCube-v1 --teacher constant", "--teacher constant is for TaskGrasp-v0"),
        ("--env-id TaskGrasp-v0 --teacher oracle", "add --control-mode pd_synergy_wrist"),
    ],
)
def test_teachers_that_cannot_teach_are_refused(flags, message):
    with pytest.raises(InputError, match=message):
        check_config(parse_config(flags.split()), 1)
