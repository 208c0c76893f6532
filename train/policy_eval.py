"""How good a policy is: deterministic episodes with fixed seeds, and what they add up to."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from maniskill_taskgrasp.train.intervals import wilson_interval
from maniskill_taskgrasp.train.rollout import VectorEnv, episode_metrics

STEP_LIMIT = 1000  # Ends the episodes of a task that has no time limit of its own.


@dataclass(frozen=True)
class Evaluation:
    """ManiSkill's metrics of every episode, in the order of their seeds."""

    episodes: dict[str, list[float]]

    @property
    def count(self) -> int:
        """Number of episodes."""
        return len(self.episodes["return"])

    def means(self) -> dict[str, float]:
        """Mean of each metric."""
        return {name: sum(values) / len(values) for name, values in self.episodes.items()}

    def interval(self, name: str) -> tuple[float, float]:
        """Wilson 95 % interval of a metric that is 0 or 1 per episode."""
        return wilson_interval(int(sum(self.episodes[name])), self.count)

    def summary(self) -> dict[str, Any]:
        """Counts, means and intervals, fit for JSON."""
        rates = [name for name in ("success_once", "success_at_end") if name in self.episodes]
        intervals = {f"{name}_ci95": list(self.interval(name)) for name in rates}
        return {"episodes": self.count} | self.means() | intervals

    def headline(self) -> str:
        """One line for a person."""
        line = f"return {self.means()['return']:.3g}"
        if "success_once" in self.episodes:
            low, high = self.interval("success_once")
            successes = int(sum(self.episodes["success_once"]))
            rate = f"{100 * successes / self.count:.1f} % [{100 * low:.1f}-{100 * high:.1f}]"
            line = f"success {successes}/{self.count} = {rate}, {line}"
        return line


@torch.no_grad()
def run_episodes(
    envs: VectorEnv,
    policy: Callable[[Tensor], Tensor],
    seeds: list[int],
    *,
    reconfigure: bool,
    step_limit: int | None,
) -> dict[str, list[float]]:
    """One episode per environment, each counted once, at its own end.

    Args:
        envs: environments that do not restart by themselves.
        policy: (num_envs, obs_dim) raw observations -> (num_envs, action_dim) task actions.
        seeds: one per environment.
        step_limit: cut episodes here.

    Returns:
        ManiSkill's metrics, in the order of the environments.
    """
    options = {"reconfigure": True} if reconfigure else {}
    obs, _ = envs.reset(seed=seeds, options=options)
    waiting = torch.ones(envs.num_envs, dtype=torch.bool, device=envs.device)
    rows: dict[int, dict[str, float]] = {}
    limit = step_limit or STEP_LIMIT
    for step in range(1, limit + 1):
        obs, _, terminated, truncated, info = envs.step(policy(obs))
        ended = waiting & (terminated | truncated | (step == limit))
        metrics = episode_metrics(info, ended)
        for row, env_idx in enumerate(ended.nonzero().flatten().tolist()):
            rows[env_idx] = {name: values[row] for name, values in metrics.items()}
        waiting &= ~ended
        if not waiting.any():
            break
    episodes: dict[str, list[float]] = defaultdict(list)
    for env_idx in sorted(rows):
        for name, value in rows[env_idx].items():
            episodes[name].append(value)
    return dict(episodes)


def merge(parts: list[dict[str, list[float]]]) -> Evaluation:
    """Evaluation of several batches of episodes, in their order."""
    episodes: dict[str, list[float]] = defaultdict(list)
    for part in parts:
        for name, values in part.items():
            episodes[name] += values
    return Evaluation(dict(episodes))
