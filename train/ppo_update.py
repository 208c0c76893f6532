"""How PPO improves the policy: the clipped objective over minibatches of one rollout."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from maniskill_taskgrasp.train.distributed import Processes
from maniskill_taskgrasp.train.ppo_agent import Agent, ObsNormalizer
from maniskill_taskgrasp.train.ppo_config import PPOConfig
from maniskill_taskgrasp.train.rollout import Rollout, compute_advantages

ADVANTAGE_EPS = 1e-8


@dataclass
class Batch:
    """Flattened experience of one rollout; observations are normalised."""

    obs: Tensor  # (samples, obs_dim)
    actions: Tensor  # (samples, action_dim) in the network's range.
    logprobs: Tensor  # (samples,) under the policy that acted.
    advantages: Tensor  # (samples,)
    returns: Tensor  # (samples,)
    values: Tensor  # (samples,)

    def rows(self, index: Tensor) -> Batch:
        """The samples of a minibatch."""
        return Batch(**{name: value[index] for name, value in vars(self).items()})


@torch.no_grad()
def make_batch(
    rollout: Rollout, agent: Agent, normalizer: ObsNormalizer, config: PPOConfig
) -> Batch:
    """What a rollout teaches.

    Values are asked for only now, all at once, and with observation statistics that include this
    rollout; the log-probabilities stay those of the policy that acted.
    """
    obs = normalizer(rollout.obs)
    values = agent.value(obs)
    advantages = compute_advantages(
        rollout.rewards * config.reward_scale,
        values,
        agent.value(normalizer(rollout.next_obs)),
        rollout.dones,
        rollout.terminated,
        gamma=config.gamma,
        gae_lambda=config.gae_lambda,
        bootstrap=config.bootstrap_at_done,
        finite_horizon=config.finite_horizon_gae,
    )
    return Batch(
        obs=obs.flatten(0, 1),
        actions=rollout.actions.flatten(0, 1),
        logprobs=rollout.logprobs.flatten(),
        advantages=advantages.flatten(),
        returns=(advantages + values).flatten(),
        values=values.flatten(),
    )


def policy_loss(ratio: Tensor, advantages: Tensor, clip_coef: float) -> Tensor:
    """PPO's pessimistic surrogate (Schulman 2017, eq. 7), to be minimised."""
    clipped = ratio.clamp(1 - clip_coef, 1 + clip_coef)
    return -torch.min(ratio * advantages, clipped * advantages).mean()


def value_loss(values: Tensor, batch: Batch, clip_coef: float | None) -> Tensor:
    """Half the mean squared error; with clip_coef, the larger of it and the clipped value's."""
    error = (values - batch.returns) ** 2
    if clip_coef is not None:
        clipped = batch.values + (values - batch.values).clamp(-clip_coef, clip_coef)
        error = torch.max(error, (clipped - batch.returns) ** 2)
    return 0.5 * error.mean()


def explained_variance(values: Tensor, returns: Tensor) -> float:
    """1 - Var(returns - values) / Var(returns); nan where the returns do not vary."""
    variance = returns.var(correction=0)
    if variance == 0:
        return float("nan")
    return float(1 - (returns - values).var(correction=0) / variance)


def _minibatch_loss(
    network: nn.Module, batch: Batch, config: PPOConfig
) -> tuple[Tensor, dict[str, Tensor]]:
    logprobs, entropy, values = network(batch.obs, batch.actions)
    log_ratio = logprobs - batch.logprobs
    ratio = log_ratio.exp()
    advantages = batch.advantages
    if config.norm_adv:
        advantages = (advantages - advantages.mean()) / (advantages.std() + ADVANTAGE_EPS)
    policy = policy_loss(ratio, advantages, config.clip_coef)
    value = value_loss(values, batch, config.clip_coef if config.clip_vloss else None)
    loss = policy - config.ent_coef * entropy.mean() + config.vf_coef * value
    with torch.no_grad():
        stats = {
            "value_loss": value,
            "policy_loss": policy,
            "entropy": entropy.mean(),
            # Estimators k1 and k3 of http://joschu.net/blog/kl-approx.html.
            "old_approx_kl": -log_ratio.mean(),
            "approx_kl": (ratio - 1 - log_ratio).mean(),
            "clipfrac": ((ratio - 1).abs() > config.clip_coef).float().mean(),
        }
    return loss, {name: stat.detach() for name, stat in stats.items()}


def update(
    network: nn.Module,
    optimizer: torch.optim.Optimizer,
    batch: Batch,
    config: PPOConfig,
    processes: Processes,
) -> dict[str, float]:
    """Several epochs of minibatch steps; stops once the policy has moved by target_kl.

    Args:
        network: `Agent`, possibly compiled or wrapped by DistributedDataParallel.

    Returns:
        ManiSkill's `losses/` scalars, means over the minibatches.
    """
    history: dict[str, list[float]] = defaultdict(list)
    samples = len(batch.obs)
    for _ in range(config.update_epochs):
        # Stragglers that do not fill a minibatch sit an epoch out: their advantages
        # could not be normalised.
        order = torch.randperm(samples, device=batch.obs.device)
        size = samples // config.num_minibatches
        for index in order[: size * config.num_minibatches].split(size):
            loss, stats = _minibatch_loss(network, batch.rows(index), config)
            means = processes.mean_dict({name: float(stat) for name, stat in stats.items()})
            for name, value in means.items():
                history[name].append(value)
            if config.target_kl is not None and means["approx_kl"] > config.target_kl:
                return _means(history, batch)
            optimizer.zero_grad(set_to_none=True)
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), config.max_grad_norm)
            optimizer.step()
    return _means(history, batch)


def _means(history: dict[str, list[float]], batch: Batch) -> dict[str, float]:
    means = {name: sum(values) / len(values) for name, values in history.items()}
    return means | {"explained_variance": explained_variance(batch.values, batch.returns)}
