"""The policy that needs no learning: wait for the palm to arrive, then close all the way."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.palm_motion import PalmResidualController
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.episode import CLOSE_START, LIFT_START

GUARD_FORCE = 0.15  # [N] contact at which a part waits for those on the other side.
GUARD_CREEP = 0.02  # Activation that a waiting part adds each step, lest contact be lost.


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


class GuardedRule(FollowRule):
    """Follows, and waits where it touches: a part that feels the object alone presses no further
    until thumb or palm and a finger feel it together. So an object that is not where it should be
    is not pushed off what it stands on.
    """

    def __init__(self, env: Any, activation: float = 1.0) -> None:
        super().__init__(env, activation)
        hand, device = self._env.agent.hand, self._env.device
        self._part_of_motor = torch.tensor(
            [PARTS.index(part) for part in hand.actuator_parts], device=device
        )
        against = [part in ("palm", "thumb") for part in PARTS]
        self._against = torch.tensor(against, device=device)

    def __call__(self, obs: Tensor) -> Tensor:
        action, env = super().__call__(obs), self._env
        touching = env.reading.forces >= GUARD_FORCE
        held = (touching & self._against).any(1) & (touching & ~self._against).any(1)
        waiting = touching[:, self._part_of_motor] & ~held[:, None]
        hand = env.agent.controller.controllers["hand"]
        resting = (hand.activation() + GUARD_CREEP).clamp(max=self._activation)
        waiting &= (env.elapsed_steps < LIFT_START)[:, None]
        closing = action[:, self._num_palm :]
        action[:, self._num_palm :] = torch.where(waiting, torch.minimum(closing, resting), closing)
        return action


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
