"""The policy that needs no learning: wait for the palm to arrive, then close all the way."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.palm_motion import PalmResidualController
from maniskill_taskgrasp.episode import CLOSE_START


class ConstantClosing:
    """Activation 0 until the closing phase, then `activation`; the palm stays on its path."""

    def __init__(self, env: Any, activation: float = 1.0) -> None:
        self._env = env.unwrapped
        self._activation = activation
        arm = self._env.agent.controller.controllers["arm"]
        self._num_palm = 4 if isinstance(arm, PalmResidualController) else 0

    def __call__(self, obs: Tensor) -> Tensor:
        """(num_envs, obs_dim) -> (num_envs, num_actions); only the clock is looked at."""
        env = self._env
        closing = env.elapsed_steps >= CLOSE_START
        action = torch.zeros(env.num_envs, env.single_action_space.shape[0], device=env.device)
        action[:, self._num_palm :] = self._activation * closing[:, None]
        return action


class FollowRule(ConstantClosing):
    """Constant closing, while the palm follows the object as far as sensing tells where it is.

    It needs `pd_synergy_wrist`.
    """

    def __call__(self, obs: Tensor) -> Tensor:
        action, shift = super().__call__(obs), self._shift()
        x, y, yaw = shift.unbind(1)
        wanted = torch.stack([x, y, torch.zeros_like(x), yaw], 1)
        arm = self._env.agent.controller.controllers["arm"]
        action[:, : self._num_palm] = arm.action_for(wanted)
        return action

    def _shift(self) -> Tensor:
        """(num_envs, 3) [m, m, rad] where the palm shall go, x, y and yaw off its path."""
        shift: Tensor = self._env.shift
        return shift


class HoverRule(FollowRule):
    """Knows what distances at hover tell, once and linearly (facts: grasping, section 7).

    The rule that a learned policy must be compared with; blind where there are no distances.
    """

    def _shift(self) -> Tensor:
        shift: Tensor = self._env.hover_shift
        return shift


class Oracle(FollowRule):
    """A teacher that knows where the object is; no policy to be compared with."""

    def _shift(self) -> Tensor:
        shift: Tensor = self._env.needed_shift()
        return shift
