"""How a task that cannot be batched on a CPU still runs many environments: a process for each."""

from __future__ import annotations

import random
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.vector import AsyncVectorEnv, AutoresetMode
from torch import Tensor

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.ppo_config import PPOConfig


class SeededGenerators(gym.Wrapper):
    """A seeded reset also seeds the process's global generators.

    Many tasks draw unseeded resets from torch's global generator, which the workers would
    otherwise start in the same state.
    """

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        if seed is not None:
            torch.manual_seed(seed)
            np.random.seed(seed)  # noqa: NPY002
            random.seed(seed)
        return super().reset(seed=seed, options=options)


def make_worker_env(
    config: PPOConfig, kwargs: dict[str, Any], ignore_terminations: bool
) -> gym.Env:
    """One environment with plain numpy in and out, made in its own process."""
    from mani_skill.utils.wrappers.gymnasium import CPUGymWrapper

    from maniskill_taskgrasp.train.environments import make_env

    torch.set_num_threads(1)
    env = make_env(config, 1, "cpu", **kwargs)
    wrapped = CPUGymWrapper(env, ignore_terminations=ignore_terminations, record_metrics=True)
    return SeededGenerators(wrapped)


class ProcessEnvs:
    """gymnasium's AsyncVectorEnv with the tensors and infos of ManiSkillVectorEnv."""

    device = torch.device("cpu")

    def __init__(
        self,
        config: PPOConfig,
        num_envs: int,
        kwargs: dict[str, Any],
        *,
        ignore_terminations: bool,
        auto_reset: bool,
    ) -> None:
        if config.cuda and torch.cuda.is_available():
            raise InputError("--env-vectorization cpu goes with --no-cuda; use gpu on this machine")
        make = partial(make_worker_env, config, kwargs, ignore_terminations)
        # SAPIEN does not survive a fork, and gymnasium makes one environment in this process.
        self._envs = AsyncVectorEnv(
            [make] * num_envs,
            context="forkserver",
            autoreset_mode=AutoresetMode.SAME_STEP if auto_reset else AutoresetMode.DISABLED,
        )
        self.num_envs = num_envs
        self.single_observation_space = self._envs.single_observation_space
        self.single_action_space = self._envs.single_action_space

    def reset(
        self, *, seed: list[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Tensor, dict[str, Any]]:
        """Start new episodes in every process."""
        seeds: list[int | None] | None = None if seed is None else list(seed)
        obs, info = self._envs.reset(seed=seeds, options=options)
        return torch.as_tensor(obs, dtype=torch.float32), info

    def step(self, actions: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, dict[str, Any]]:
        """One step in every process, all at once."""
        obs, reward, terminated, truncated, info = self._envs.step(actions.numpy())
        converted = _tensors(info)
        if "final_obs" in info:
            ended = info["_final_obs"]
            final_obs = np.array(obs)
            final_obs[ended] = np.stack(info["final_obs"][ended])
            converted["final_observation"] = torch.as_tensor(final_obs, dtype=torch.float32)
        return (
            torch.as_tensor(obs, dtype=torch.float32),
            torch.as_tensor(reward, dtype=torch.float32),
            torch.as_tensor(terminated),
            torch.as_tensor(truncated),
            converted,
        )

    def close(self) -> None:
        """End the processes."""
        self._envs.close()


def _tensors(info: dict[str, Any]) -> dict[str, Any]:
    """The numbers among gymnasium's batched infos, as tensors, without its validity masks."""
    converted: dict[str, Any] = {}
    for name, value in info.items():
        if isinstance(value, dict):
            converted[name] = _tensors(value)
        elif not name.startswith("_") and value.dtype != object:
            converted[name] = torch.as_tensor(value)
    return converted
