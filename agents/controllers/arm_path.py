"""Moves the arm along the path that the planner laid down; nobody passes arm actions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import torch
from gymnasium import spaces
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.joint_pos import (
    JointPosController,
    JointPosControllerConfig,
)


def held(path: Tensor, num_steps: int) -> Tensor:
    """(n, num_steps, num_joints): a path (n, m, num_joints) that stays at its last waypoint."""
    rest = path[:, -1:].expand(-1, max(num_steps - path.shape[1], 0), -1)
    return torch.cat([path, rest], 1)


class ArmPathController(JointPosController):
    """Follows (num_envs, num_steps, num_joints) waypoints, one a control step, then holds."""

    _memory: ClassVar[tuple[str, ...]] = ("command", "path", "step")
    _observed: ClassVar[tuple[str, ...]] = ()

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self.path = self.command[:, None].clone()
        self.step = torch.zeros(self.scene.num_envs, dtype=torch.long, device=self.device)

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(*np.empty((2, 0), np.float32), dtype=np.float32)

    def _hold_still(self, envs: Tensor) -> None:
        self.path[envs] = self.command[envs][:, None]
        self.step[envs] = 0

    def set_path(self, env_idx: Tensor, path: Tensor) -> None:
        """Lay down a new path and start at its first waypoint.

        Args:
            env_idx: (n,) environments.
            path: (n, num_steps, num_joints) [rad] waypoints, one a control step.
        """
        num_steps = max(self.path.shape[1], path.shape[1])
        self.path = held(self.path, num_steps)
        self.path[env_idx] = held(path.to(self.path), num_steps)
        self.step[env_idx] = 0
        self._planned[env_idx] = True

    def waypoint(self) -> Tensor:
        """(num_envs, num_joints) [rad] where the arm should be now."""
        now = self.step.clamp(max=self.path.shape[1] - 1)
        return self.path[torch.arange(len(now), device=self.device), now]

    def wanted_qpos(self, action: Tensor) -> Tensor:
        return self.waypoint()

    def set_action(self, action: Tensor) -> None:
        super().set_action(action)
        self.step += 1

    def set_state(self, state: dict[str, Tensor] | None, env_idx: Tensor | None = None) -> None:
        if state and "path" in state:
            num_joints = self.path.shape[2]
            path = state["path"].reshape(len(state["path"]), -1, num_joints)
            num_steps = max(self.path.shape[1], path.shape[1])
            self.path = held(self.path, num_steps)
            state = {**state, "path": held(path, num_steps)}
        super().set_state(state, env_idx)


@dataclass(kw_only=True)
class ArmPathControllerConfig(JointPosControllerConfig):
    controller_cls = ArmPathController
