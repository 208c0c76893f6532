"""Laws of the trainer's arithmetic: advantages, losses, scaling, intervals, settings."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest
import torch
from gymnasium import spaces

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.distributed import Processes
from maniskill_taskgrasp.train.intervals import wilson_interval
from maniskill_taskgrasp.train.ppo_agent import ActionScaler, Agent, ObsNormalizer, sample_moments
from maniskill_taskgrasp.train.ppo_config import PPOConfig, check_config, default_config
from maniskill_taskgrasp.train.ppo_update import (
    Batch,
    explained_variance,
    policy_loss,
    update,
    value_loss,
)
from maniskill_taskgrasp.train.rollout import compute_advantages

GAMMA, LAMBDA = 0.9, 0.8


@pytest.fixture
def experience():
    """12 steps of 3 environments with an episode end of each kind."""
    torch.manual_seed(0)
    rewards, values, next_values = torch.randn(3, 12, 3, dtype=torch.float64)
    dones = torch.zeros(12, 3, dtype=torch.bool)
    terminated = torch.zeros(12, 3, dtype=torch.bool)
    dones[4, 0] = terminated[4, 0] = True  # Environment 0 dies at step 4,
    dones[7, 1] = True  # environment 1 runs out of time at step 7, environment 2 goes on.
    next_values[:-1][~dones[:-1]] = values[1:][~dones[:-1]]
    return rewards, values, next_values, dones, terminated


def returns_by_definition(experience, env, t, bootstrap, finite):
    """Lambda-weighted n-step returns, summed as the papers write them."""
    rewards, _, next_values, dones, terminated = (x[:, env] for x in experience)
    n_step, reward_sum = [], 0.0
    for k in range(t, len(rewards)):
        reward_sum += GAMMA ** (k - t) * rewards[k]
        alive = 0.0 if bootstrap == "truncated" and terminated[k] else 1.0
        n_step.append(reward_sum + GAMMA ** (k - t + 1) * alive * next_values[k])
        if dones[k]:
            break
    weights = [LAMBDA**k for k in range(len(n_step))]
    if not finite:
        weights = [weight * (1 - LAMBDA) for weight in weights]
        weights[-1] = LAMBDA ** (len(n_step) - 1)  # All that is left goes to the longest return.
    return sum(w * r for w, r in zip(weights, n_step, strict=True)) / sum(weights)


@pytest.mark.parametrize("bootstrap", ["always", "truncated"])
@pytest.mark.parametrize("finite", [False, True])
def test_advantages_equal_their_definition(experience, bootstrap, finite):
    """The backward recursions give the lambda-returns of the definition, minus the values."""
    advantages = compute_advantages(
        *experience, gamma=GAMMA, gae_lambda=LAMBDA, bootstrap=bootstrap, finite_horizon=finite
    )
    for env in range(3):
        for t in range(12):
            expected = returns_by_definition(experience, env, t, bootstrap, finite)
            assert float(advantages[t, env] + experience[1][t, env]) == pytest.approx(
                float(expected), abs=1e-9
            )


def test_truncated_episode_has_a_future_and_a_dead_one_has_none(experience):
    """Changing the value after a time limit changes the advantage; after a death it does not."""
    rewards, values, next_values, dones, terminated = experience
    settings = {"gamma": GAMMA, "gae_lambda": LAMBDA, "finite_horizon": False}
    before = compute_advantages(*experience, **settings, bootstrap="truncated")
    changed = next_values.clone()
    changed[4, 0] += 1  # After the death.
    changed[7, 1] += 1  # After the time limit.
    after = compute_advantages(
        rewards, values, changed, dones, terminated, **settings, bootstrap="truncated"
    )
    assert torch.equal(before[:, 0], after[:, 0])
    assert float(after[7, 1] - before[7, 1]) == pytest.approx(GAMMA)
    assert torch.equal(before[8:, 1], after[8:, 1])


@pytest.mark.parametrize(
    ("ratio", "advantage", "expected"),
    [
        (1.0, 2.0, -2.0),  # Where the policy has not moved, the loss is minus the advantage.
        (1.5, 2.0, -2.4),  # A gain counts only up to the clipping range,
        (0.5, 2.0, -1.0),  # a loss counts in full;
        (0.5, -2.0, 1.6),  # and with a bad action it is the other way round.
        (1.5, -2.0, 3.0),
    ],
)
def test_policy_loss_is_pessimistic(ratio, advantage, expected):
    """Known values of the clipped surrogate at a range of 0.2."""
    loss = policy_loss(torch.tensor([ratio]), torch.tensor([advantage]), 0.2)
    assert float(loss) == pytest.approx(expected)


def test_clipped_value_loss_is_never_below_the_plain_one():
    """Clipping can only be pessimistic, and changes nothing within its range."""
    torch.manual_seed(0)
    old, new, returns = torch.randn(3, 500)
    zeros = torch.zeros(500)
    batch = Batch(zeros, zeros, zeros, zeros, returns, old)
    assert value_loss(new, batch, 0.2) >= value_loss(new, batch, None)
    near = old + 0.1
    torch.testing.assert_close(value_loss(near, batch, 0.2), value_loss(near, batch, None))


def test_explained_variance_of_perfect_and_constant_values():
    """1 for perfect values, 0 for a constant."""
    returns = torch.arange(10.0)
    assert explained_variance(returns, returns) == pytest.approx(1.0)
    assert explained_variance(torch.zeros(10), returns) == pytest.approx(0.0)


def test_normalizer_merges_to_the_statistics_of_the_whole():
    """Fed in pieces of any size it equals mean and deviation of everything."""
    torch.manual_seed(0)
    sample = torch.randn(1000, 3) * torch.tensor([0.01, 1.0, 300.0]) + torch.tensor([5.0, 0, -80])
    normalizer = ObsNormalizer(3)
    assert torch.equal(normalizer(sample), sample)  # Identity until fed.
    for piece in sample.split([1, 299, 700]):
        normalizer.merge(*sample_moments(piece))
    expected = (sample - sample.mean(0)) / sample.std(0, correction=0)
    torch.testing.assert_close(normalizer(sample), expected, rtol=1e-3, atol=1e-3)
    twin = ObsNormalizer(3)
    twin.load_state_dict(normalizer.state_dict())
    assert torch.equal(twin(sample), normalizer(sample))


def test_normalizer_bounds_what_it_has_never_seen():
    """An entry that was constant in training cannot blow up later."""
    normalizer = ObsNormalizer(1)
    normalizer.merge(*sample_moments(torch.zeros(50, 1)))
    assert float(normalizer(torch.tensor([[1.0]]))) == 10.0


def test_zero_action_is_mid_box_and_large_ones_stay_inside():
    """The network's [-1, 1] covers a bounded box; unbounded entries pass unchanged."""
    low = np.array([0.0, -2.0, -np.inf], dtype=np.float32)
    high = np.array([1.0, 4.0, np.inf], dtype=np.float32)
    scaler = ActionScaler(spaces.Box(low, high))
    actions = torch.tensor([[0.0, 0.0, 0.0], [1.0, -1.0, 7.0], [9.0, -9.0, -7.0]])
    expected = torch.tensor([[0.5, 1.0, 0.0], [1.0, -2.0, 7.0], [1.0, -2.0, -7.0]])
    torch.testing.assert_close(scaler(actions), expected)


def test_agent_has_the_parameters_of_maniskills_baseline():
    """Names and shapes, so that weight files go both ways."""
    shapes = {name: tuple(value.shape) for name, value in Agent(42, 8).state_dict().items()}
    expected = {"actor_logstd": (1, 8)}
    for net, outputs in (("critic", 1), ("actor_mean", 8)):
        sizes = [(256, 42), (256, 256), (256, 256), (outputs, 256)]
        for layer, size in zip((0, 2, 4, 6), sizes, strict=True):
            expected |= {f"{net}.{layer}.weight": size, f"{net}.{layer}.bias": size[:1]}
    assert shapes == expected


def test_agent_logprob_is_the_normal_density():
    """forward() gives the density of what act() drew."""
    torch.manual_seed(0)
    agent = Agent(5, 2)
    obs = torch.randn(7, 5)
    action, logprob = agent.act(obs)
    again, entropy, value = agent(obs, action)
    torch.testing.assert_close(again, logprob)
    std = math.exp(-0.5)
    density = -0.5 * ((action - agent.actor_mean(obs)) / std) ** 2 - math.log(std) - 0.9189385
    torch.testing.assert_close(logprob, density.sum(-1))
    assert value.shape == entropy.shape == (7,)


def test_wilson_interval_reproduces_the_papers():
    """2312 of 2700 is 84.3-86.9 %; the bounds contain the rate, also at 0 and 100 %."""
    low, high = wilson_interval(2312, 2700)
    assert (round(100 * low, 1), round(100 * high, 1)) == (84.3, 86.9)
    assert wilson_interval(0, 10)[0] == 0.0
    assert wilson_interval(10, 10)[1] == 1.0
    assert all(
        wilson_interval(k, n)[0] <= k / n <= wilson_interval(k, n)[1]
        for n in range(1, 30)
        for k in range(n + 1)
    )
    with pytest.raises(ValueError, match="successes"):
        wilson_interval(3, 2)


def test_defaults_follow_task_machine_and_preset():
    """Upstream's numbers on CUDA, one environment on a CPU, the paper's by preset."""
    assert default_config("PickCube-v1", None, True).num_envs == 512
    assert default_config("PickCube-v1", None, False).num_envs == 1
    assert default_config("TaskGrasp-v0", None, False).num_envs > 1
    paper = default_config("maniskill_taskgrasp:TaskGrasp-v0", "paper", False)
    assert (paper.learning_rate, paper.gamma, paper.clip_coef) == (2.5e-4, 0.9, 0.2)
    assert (paper.obs, paper.control_mode, paper.reward_mode) == ("paper", "pd_synergy", "paper")
    assert paper.num_iterations * paper.batch_size == 50_000
    with pytest.raises(InputError, match="TaskGrasp-v0"):
        default_config("PickCube-v1", "paper", False)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"num_envs": 0}, "--num-envs"),
        ({"learning_rate": float("nan")}, "--learning-rate"),
        ({"gamma": 1.5}, "--gamma"),
        ({"num_envs": 1, "num_steps": 50}, "--num-minibatches"),
        ({"total_timesteps": 10}, "--total-timesteps"),
        ({"evaluate": True}, "--checkpoint"),
        ({"cudagraphs": True}, "--compile"),
    ],
)
def test_impossible_settings_are_refused_by_name(changes, message):
    """Each refusal is one line that names the flag."""
    with pytest.raises(InputError, match=message) as caught:
        check_config(PPOConfig(**changes), world_size=1)
    assert "\n" not in str(caught.value)


def test_environments_must_divide_among_processes():
    """Uneven shares would weigh gradients wrongly."""
    with pytest.raises(InputError, match="multiple of 3"):
        check_config(PPOConfig(num_envs=64), world_size=3)


@pytest.mark.slow
def test_updates_of_50k_samples_take_under_20_cpu_seconds():
    """Learning costs little beside the simulation: TaskGrasp's settings on noise, one thread."""
    config = replace(default_config("TaskGrasp-v0", None, False), target_kl=None)
    torch.manual_seed(0)
    torch.set_num_threads(1)
    agent = Agent(60, 10)
    optimizer = torch.optim.Adam(agent.parameters(), lr=config.learning_rate, fused=True)
    samples = config.batch_size
    obs, actions = torch.randn(samples, 60), torch.randn(samples, 10)
    noise = torch.randn(3, samples)
    with torch.no_grad():
        logprobs, _, _ = agent(obs, actions)
    batch = Batch(obs, actions, logprobs, *noise)
    started = time.process_time()
    for _ in range(math.ceil(50_000 / samples)):
        update(agent, optimizer, batch, config, Processes())
    seconds = time.process_time() - started
    print(f"{seconds:.1f} CPU seconds")  # noqa: T201
    assert seconds < 20
