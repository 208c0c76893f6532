"""How a trained policy is used: a checkpoint becomes a callable from observation to action."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from maniskill_taskgrasp.errors import InputError, echo

if TYPE_CHECKING:
    from torch import Tensor

    from maniskill_taskgrasp.train.ppo_agent import Agent

INTERFACE_FLAGS = ("control_mode", "obs", "distance")  # What a policy's inputs and outputs mean.


def interface_kwargs(checkpoint: dict[str, Any]) -> dict[str, Any]:
    """The task arguments a checkpoint was trained with and cannot do without."""
    given = {name: checkpoint["config"].get(name) for name in INTERFACE_FLAGS}
    return {name: value for name, value in given.items() if value is not None}


def policy_env_kwargs(path: str | Path) -> dict[str, Any]:
    """Arguments of gym.make under which a policy file can act; nothing for bare weights.

    Raises:
        InputError: there is no such policy.
    """
    from maniskill_taskgrasp.train.checkpoint import load_checkpoint

    return interface_kwargs(load_checkpoint(path))


def _sizes(weights: dict[str, Tensor]) -> tuple[int, int]:
    return weights["actor_mean.0.weight"].shape[1], weights["actor_logstd"].shape[1]


def check_shapes(checkpoint: dict[str, Any], path: str | Path, agent: Agent) -> None:
    """Refuse a policy that does not fit an environment.

    Args:
        agent: a network of the environment's sizes.

    Raises:
        InputError: observation, action or layer sizes differ; says what the policy was made for.
    """
    weights, own = checkpoint["agent"], agent.state_dict()
    shapes = {name: tuple(weight.shape) for name, weight in weights.items()}
    if shapes == {name: tuple(weight.shape) for name, weight in own.items()}:
        return
    (obs_dim, action_dim), (env_obs, env_action) = _sizes(weights), _sizes(own)
    if (obs_dim, action_dim) == (env_obs, env_action):
        raise InputError(f"the policy {echo(path)} has other layers than ManiSkill's networks")
    made_for = ", ".join(f"{name}={value}" for name, value in interface_kwargs(checkpoint).items())
    raise InputError(
        f"the policy {echo(path)} maps {obs_dim} observations to {action_dim} actions, but the "
        f"environment has {env_obs} and {env_action}: it was trained with "
        f"{made_for or 'the default arguments of its task'}"
    )


class Policy:
    """A trained policy, acting deterministically."""

    def __init__(self, path: str | Path, env: Any) -> None:
        import math

        import torch

        from maniskill_taskgrasp.train.checkpoint import load_checkpoint
        from maniskill_taskgrasp.train.ppo_agent import ActionScaler, Agent, ObsNormalizer

        base = env.unwrapped
        device = torch.device(base.device)
        checkpoint = load_checkpoint(path)
        obs_shape, action_space = base.single_observation_space.shape, base.single_action_space
        if obs_shape is None or action_space.shape is None:
            raise InputError(f"the policy {echo(path)} needs flat observations and one action box")
        self._scaler = ActionScaler(action_space, device)
        self._agent = Agent(math.prod(obs_shape), math.prod(action_space.shape)).to(device)
        check_shapes(checkpoint, path, self._agent)
        self._agent.load_state_dict(checkpoint["agent"])
        self._normalizer = ObsNormalizer(math.prod(obs_shape), device)
        if "normalizer" in checkpoint:
            self._normalizer.load_state_dict(checkpoint["normalizer"])
        self._no_grad = torch.no_grad

    def __call__(self, obs: Tensor) -> Tensor:
        """(num_envs, obs_dim) raw observations -> (num_envs, action_dim) actions in the box."""
        with self._no_grad():
            return self._scaler(self._agent.actor_mean(self._normalizer(obs)))


def load_policy(path: str | Path, env: Any) -> Policy:
    """The policy of a file, for an environment made with `policy_env_kwargs(path)`.

    Args:
        path: a checkpoint of train/ppo.py, or ManiSkill's bare weights.
        env: gym environment or ManiSkillVectorEnv with flat state observations.

    Raises:
        InputError: the file is no policy, or does not fit the environment.
    """
    return Policy(path, env)
