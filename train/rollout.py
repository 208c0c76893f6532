"""What PPO learns from: rollouts of a vector environment, and the advantages they imply."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import Any, Protocol

import torch
from gymnasium import spaces
from torch import Tensor

from maniskill_taskgrasp.train.ppo_agent import ActionScaler, ObsNormalizer


class VectorEnv(Protocol):
    """The part of ManiSkillVectorEnv that training uses; arrays are tensors on `device`."""

    num_envs: int
    single_observation_space: spaces.Space
    single_action_space: spaces.Space

    @property
    def device(self) -> torch.device:
        """Where observations live."""

    def reset(
        self, *, seed: list[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Tensor, dict[str, Any]]:
        """Start new episodes everywhere; the option `reconfigure` also rebuilds the scene."""

    def step(self, actions: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, dict[str, Any]]:
        """One step; ended episodes restart, their ends are in info `final_*`."""

    def close(self) -> None:
        """Free the simulation."""


class Actor(Protocol):
    """Who decides: `Agent`, or a teacher that stands in for it."""

    def act(self, obs: Tensor) -> tuple[Tensor, Tensor]:
        """Actions and their log-probabilities for normalised observations."""


@dataclass
class Rollout:
    """Experience of num_envs environments; tensors begin with (num_steps, num_envs)."""

    obs: Tensor
    next_obs: Tensor  # What really followed: the last observation of an episode, not the reset's.
    actions: Tensor  # In the network's range.
    logprobs: Tensor
    rewards: Tensor
    dones: Tensor
    terminated: Tensor
    last_obs: Tensor  # (num_envs, obs_dim) Where the next rollout starts.
    episodes: dict[str, list[float]]  # ManiSkill's metrics of the episodes that ended.


def episode_metrics(info: dict[str, Any], ended: Tensor) -> dict[str, list[float]]:
    """ManiSkill's metrics of the ended episodes.

    Args:
        info: of a step (or its `final_info`) with an `episode` dictionary of (num_envs,) tensors.
        ended: (num_envs,) bool.
    """
    metrics = {name: value[ended].tolist() for name, value in info["episode"].items()}
    for name in ("success", "fail"):
        if name in info:
            metrics[f"{name}_at_end"] = info[name][ended].tolist()
    return {name: [float(value) for value in values] for name, values in metrics.items()}


@torch.no_grad()
def collect(
    envs: VectorEnv,
    agent: Actor,
    normalizer: ObsNormalizer,
    scaler: ActionScaler,
    obs: Tensor,
    num_steps: int,
) -> Rollout:
    """Act for num_steps from the observations `obs` (num_envs, obs_dim)."""
    columns: dict[str, list[Tensor]] = defaultdict(list)
    episodes: dict[str, list[float]] = defaultdict(list)
    for _ in range(num_steps):
        action, logprob = agent.act(normalizer(obs))
        following, reward, terminated, truncated, info = envs.step(scaler(action))
        done = terminated | truncated
        ended_obs = info.get("final_observation", following)
        step = {
            "obs": obs,
            "next_obs": ended_obs,
            "actions": action,
            "logprobs": logprob,
            "rewards": reward,
            "dones": done,
            "terminated": terminated,
        }
        for name, value in step.items():
            columns[name].append(value.clone())  # An environment may reuse its buffers.
        if "final_info" in info:
            for name, values in episode_metrics(info["final_info"], done).items():
                episodes[name] += values
        obs = following.clone()
    stacked = {name: torch.stack(values) for name, values in columns.items()}
    return Rollout(**stacked, last_obs=obs, episodes=dict(episodes))


def generalized_advantages(
    deltas: Tensor, dones: Tensor, gamma: float, gae_lambda: float
) -> Tensor:
    """Exponentially weighted sums of temporal differences within each episode (Schulman 2016).

    Args:
        deltas: (num_steps, num_envs) temporal differences r + gamma V' - V.
        dones: (num_steps, num_envs) bool, the episode ended with this step.

    Returns:
        (num_steps, num_envs) advantages.
    """
    advantages = torch.zeros_like(deltas)
    following = torch.zeros_like(deltas[0])
    for t in reversed(range(len(deltas))):
        following = deltas[t] + gamma * gae_lambda * following * ~dones[t]
        advantages[t] = following
    return advantages


def finite_horizon_advantages(
    rewards: Tensor,
    values: Tensor,
    future: Tensor,
    dones: Tensor,
    gamma: float,
    gae_lambda: float,
) -> Tensor:
    """Lambda-weighted mean of n-step returns up to the rollout's or episode's end, minus values.

    Unlike the usual estimate, which gives all the weight left over to the longest return, the
    weights 1, lambda, lambda^2 … are divided by their own sum (ManiSkill's finite_horizon_gae).

    Args:
        rewards: (num_steps, num_envs).
        values: (num_steps, num_envs) V of each observation.
        future: (num_steps, num_envs) V of what followed, 0 where nothing follows.
        dones: (num_steps, num_envs) bool, the episode ended with this step.
    """
    advantages = torch.zeros_like(rewards)
    weight, reward_sum, value_sum = (torch.zeros_like(rewards[0]) for _ in range(3))
    for t in reversed(range(len(rewards))):
        inside = ~dones[t]
        weight = 1 + gae_lambda * weight * inside
        decay = gamma * gae_lambda
        reward_sum = decay * reward_sum * inside + weight * rewards[t]
        value_sum = decay * value_sum * inside + gamma * future[t]
        advantages[t] = (reward_sum + value_sum) / weight - values[t]
    return advantages


def compute_advantages(
    rewards: Tensor,
    values: Tensor,
    next_values: Tensor,
    dones: Tensor,
    terminated: Tensor,
    *,
    gamma: float,
    gae_lambda: float,
    bootstrap: str,
    finite_horizon: bool,
) -> Tensor:
    """Advantages (num_steps, num_envs); a time limit never cuts the value of what comes after it.

    Args:
        next_values: V of what really followed each step, also where the episode ended.
        terminated: (num_steps, num_envs) bool, ended by success or failure.
        bootstrap: "always" gives terminated episodes a future too, "truncated" does not.
    """
    alive = torch.ones_like(dones) if bootstrap == "always" else ~terminated
    future = next_values * alive
    if finite_horizon:
        return finite_horizon_advantages(rewards, values, future, dones, gamma, gae_lambda)
    return generalized_advantages(rewards + gamma * future - values, dones, gamma, gae_lambda)
