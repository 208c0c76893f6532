"""What the policy is: ManiSkill's actor and critic, observation scaling, and action rescaling."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch
from gymnasium import spaces
from torch import Tensor, nn

from maniskill_taskgrasp.errors import InputError

HIDDEN = 256
INITIAL_LOGSTD = -0.5  # ManiSkill's; a deviation of 0.6 where the action range is [-1, 1].
OBS_CLIP = 10.0  # Largest normalised observation, in standard deviations.
MIN_VARIANCE = 1e-8  # Floor for observation entries that never change.


def _linear(inputs: int, outputs: int, gain: float = math.sqrt(2)) -> nn.Linear:
    layer = nn.Linear(inputs, outputs)
    nn.init.orthogonal_(layer.weight, gain)
    nn.init.zeros_(layer.bias)
    return layer


def _mlp(inputs: int, outputs: int, gain: float) -> nn.Sequential:
    return nn.Sequential(
        _linear(inputs, HIDDEN),
        nn.Tanh(),
        _linear(HIDDEN, HIDDEN),
        nn.Tanh(),
        _linear(HIDDEN, HIDDEN),
        nn.Tanh(),
        _linear(HIDDEN, outputs, gain),
    )


class Agent(nn.Module):
    """Gaussian policy and value function; parameter names are those of ManiSkill's baseline."""

    def __init__(self, obs_dim: int, action_dim: int) -> None:
        super().__init__()
        self.critic = _mlp(obs_dim, 1, gain=math.sqrt(2))
        self.actor_mean = _mlp(obs_dim, action_dim, gain=0.01 * math.sqrt(2))
        self.actor_logstd = nn.Parameter(torch.full((1, action_dim), INITIAL_LOGSTD))

    def value(self, obs: Tensor) -> Tensor:
        """(batch, obs_dim) normalised -> (batch,) expected return."""
        return self.critic(obs).squeeze(-1)

    def distribution(self, obs: Tensor) -> torch.distributions.Normal:
        """(batch, obs_dim) normalised -> independent normals over (batch, action_dim)."""
        mean = self.actor_mean(obs)
        std = self.actor_logstd.exp().expand_as(mean)
        return torch.distributions.Normal(mean, std, validate_args=False)

    def act(self, obs: Tensor) -> tuple[Tensor, Tensor]:
        """Draw actions (batch, action_dim) and their log-probabilities (batch,)."""
        distribution = self.distribution(obs)
        action = distribution.sample()
        return action, distribution.log_prob(action).sum(-1)

    def forward(self, obs: Tensor, action: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Log-probability, entropy and value, each (batch,), of actions taken at observations."""
        distribution = self.distribution(obs)
        logprob = distribution.log_prob(action).sum(-1)
        return logprob, distribution.entropy().sum(-1), self.value(obs)


class ObsNormalizer:
    """Running mean and deviation per observation entry, in float64; identity until first fed."""

    def __init__(self, obs_dim: int, device: torch.device | str = "cpu") -> None:
        self.count = 0.0
        self.mean = torch.zeros(obs_dim, dtype=torch.float64, device=device)
        self.sum_squares = torch.zeros(obs_dim, dtype=torch.float64, device=device)
        self._refresh()

    def _refresh(self) -> None:
        variance = self.sum_squares / max(self.count, 1.0)
        scale = torch.ones_like(variance) if self.count == 0 else variance.clamp_min(MIN_VARIANCE)
        self._shift = self.mean.float()
        self._factor = scale.rsqrt().float()

    def merge(self, count: float, mean: Tensor, sum_squares: Tensor) -> None:
        """Take in another sample's count, mean and sum of squared deviations (Chan et al. 1979)."""
        total = self.count + count
        delta = mean - self.mean
        self.mean = self.mean + delta * (count / total)
        self.sum_squares = self.sum_squares + sum_squares + delta**2 * (self.count * count / total)
        self.count = total
        self._refresh()

    def __call__(self, obs: Tensor) -> Tensor:
        """(..., obs_dim) raw -> normalised, within +-OBS_CLIP deviations once it has been fed."""
        scaled = (obs - self._shift) * self._factor
        return scaled if self.count == 0 else scaled.clamp(-OBS_CLIP, OBS_CLIP)

    def state_dict(self) -> dict[str, Any]:
        """What a checkpoint keeps."""
        return {"count": self.count, "mean": self.mean, "sum_squares": self.sum_squares}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Take over another normaliser's sums."""
        self.count = float(state["count"])
        self.mean = state["mean"].to(self.mean)
        self.sum_squares = state["sum_squares"].to(self.mean)
        self._refresh()


def sample_moments(obs: Tensor) -> tuple[float, Tensor, Tensor]:
    """Count, mean and sum of squared deviations, float64, of (samples, obs_dim) observations."""
    sample = obs.double()
    mean = sample.mean(0)
    return float(len(sample)), mean, ((sample - mean) ** 2).sum(0)


class ActionScaler:
    """Maps the network's [-1, 1] to the task's box, so that a zero-mean start is mid-box."""

    def __init__(self, space: spaces.Space, device: torch.device | str = "cpu") -> None:
        if not isinstance(space, spaces.Box):
            raise InputError(f"only tasks with a Box of actions can be learned, got {space}")
        bounded = np.isfinite(space.low) & np.isfinite(space.high)
        low = torch.as_tensor(np.where(bounded, space.low, -1.0), dtype=torch.float32)
        high = torch.as_tensor(np.where(bounded, space.high, 1.0), dtype=torch.float32)
        self._middle = ((low + high) / 2).to(device)
        self._half_range = ((high - low) / 2).to(device)
        limit = torch.where(torch.as_tensor(bounded), 1.0, torch.inf)
        self._limit = limit.to(device)

    def __call__(self, action: Tensor) -> Tensor:
        """(batch, action_dim) network action -> task action, clamped to the box."""
        return self._middle + self._half_range * action.clamp(-self._limit, self._limit)

    def inverse(self, action: Tensor) -> Tensor:
        """(batch, action_dim) task action -> network action that means it."""
        return (action - self._middle) / self._half_range
