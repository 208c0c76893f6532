"""Closes the hand along a topology's joint synergy: activation 0 is the preshape, 1 is closed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from gymnasium import spaces
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.coupled_hand import (
    CoupledHandController,
    CoupledHandControllerConfig,
)
from maniskill_taskgrasp.agents.hand import Posture

Spread = tuple[tuple[float, ...], ...]


def synergy_to_qpos(activation: Tensor, preshape: Tensor, closing: Tensor) -> Tensor:
    """Posture that an activation asks for; a joint with closing = preshape holds still.

    Args:
        activation: (num_envs, num_actuators), clipped to [0, 1].
        preshape: (num_envs, num_actuators) [rad] posture at activation 0.
        closing: (num_envs, num_actuators) [rad] posture at activation 1.

    Returns:
        (num_envs, num_actuators) [rad]
    """
    return preshape + activation.clamp(0, 1) * (closing - preshape)


class JointSynergyController(CoupledHandController):
    """Activations in [0, 1] of the posture pair that `set_postures` gave each environment.

    An environment that was given none uses the config's posture, and without one it holds still.
    Until the palm has arrived the hand keeps its preshape whatever the action: fingers that close
    on the way push the object over (facts: simulation, section 2).
    """

    config: JointSynergyControllerConfig
    _memory = ("command", "preshape", "closing", "wait")

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self.preshape = self.command.clone()
        self.closing = self.command.clone()
        self.wait = torch.zeros(len(self.command), dtype=torch.long, device=self.device)
        """(num_envs,) control steps for which the hand keeps its preshape."""
        spread = np.asarray(self.config.spread, dtype=np.float32)
        self._spread = torch.from_numpy(spread).to(self.device)

    def _initialize_action_space(self) -> None:
        num_actions = len(self.config.spread)
        self.single_action_space = spaces.Box(0.0, 1.0, (num_actions,), dtype=np.float32)

    def _hold_still(self, envs: Tensor) -> None:
        own, now = self.config.posture, self.command[envs]
        self.preshape[envs] = now if own is None else torch.tensor(own.preshape).to(now)
        self.closing[envs] = now if own is None else torch.tensor(own.closing).to(now)
        self.wait[envs] = 0

    def set_postures(
        self, env_idx: Tensor, preshape: Tensor, closing: Tensor, wait: int = 0
    ) -> None:
        """Give environments the postures of their topology.

        Args:
            env_idx: (n,) environments.
            preshape: (n, num_actuators) [rad].
            closing: (n, num_actuators) [rad].
            wait: control steps before the hand begins to close.
        """
        self.wait[env_idx] = wait
        self.preshape[env_idx] = preshape.to(self.preshape)
        self.closing[env_idx] = closing.to(self.closing)
        self._planned[env_idx] = True

    def activation(self) -> Tensor:
        """(num_envs, num_actuators) activation that the motors are commanded to now; 1 where a
        joint does not move."""
        span = self.closing - self.preshape
        moves = span.abs() > 1e-4
        share = (self.command - self.preshape) / torch.where(moves, span, 1.0)
        return torch.where(moves, share, 1.0)

    def wanted_qpos(self, action: Tensor) -> Tensor:
        activation = (action @ self._spread) * (self.wait == 0)[:, None]
        return synergy_to_qpos(activation, self.preshape, self.closing)

    def set_action(self, action: Tensor) -> None:
        super().set_action(action)
        self.wait = (self.wait - 1).clamp(min=0)


@dataclass(kw_only=True)
class JointSynergyControllerConfig(CoupledHandControllerConfig):
    spread: Spread
    """(num_actions, num_actuators) motors that each action number drives."""
    posture: Posture | None = None
    """What the hand closes along where no task says."""
    controller_cls = JointSynergyController


def spread_all(num_actuators: int) -> Spread:
    """One number a motor."""
    return tuple(map(tuple, np.eye(num_actuators).tolist()))


def spread_moving(moving: np.ndarray) -> Spread:
    """One number for each motor that moves; the others hold their preshape."""
    return tuple(map(tuple, np.eye(len(moving))[moving].tolist()))


def spread_one(num_actuators: int) -> Spread:
    """One number for the whole hand."""
    return ((1.0,) * num_actuators,)
