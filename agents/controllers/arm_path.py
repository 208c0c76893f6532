"""Moves the arm along the path that the planner laid down; nobody passes arm actions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from gymnasium import spaces
from mani_skill.agents.controllers.base_controller import BaseController, ControllerConfig
from torch import Tensor


class ArmPathController(BaseController):
    """Follows (num_envs, num_steps, num_joints) waypoints, one a control step, then holds."""

    config: ArmPathControllerConfig
    sets_target_qpos = True
    sets_target_qvel = False

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        num_envs = self.scene.num_envs
        self.path = torch.zeros(num_envs, 1, len(self.joints), device=self.device)
        self.step = torch.zeros(num_envs, dtype=torch.long, device=self.device)
        self._planned = torch.zeros(num_envs, dtype=torch.bool, device=self.device)

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(np.empty(0), np.empty(0), dtype=np.float32)

    def set_drive_property(self) -> None:
        for joint, limit in zip(self.joints, self.config.force_limits, strict=True):
            joint.set_drive_properties(
                self.config.stiffness, self.config.damping, force_limit=limit
            )

    def reset(self) -> None:
        """Environments for which no path was laid down since their last reset hold still."""
        still = self.scene._reset_mask & ~self._planned
        self.path[still] = self.qpos[still][:, None]
        self.step[still] = 0
        self._planned &= ~self.scene._reset_mask

    def set_path(self, env_idx: Tensor, path: Tensor) -> None:
        """Lay down a new path and start at its first waypoint.

        Args:
            env_idx: (n,) environments.
            path: (n, num_steps, num_joints) [rad] waypoints, one a control step.
        """
        if self.path.shape[1] != path.shape[1]:
            self.path = self.path[:, -1:].repeat(1, path.shape[1], 1)
        self.path[env_idx] = path.to(self.path)
        self.step[env_idx] = 0
        self._planned[env_idx] = True

    def waypoint(self) -> Tensor:
        """(num_envs, num_joints) [rad] where the arm should be now."""
        now = self.step.clamp(max=self.path.shape[1] - 1)
        return self.path[torch.arange(len(now), device=self.device), now]

    def set_action(self, action: Tensor) -> None:
        self._drive(self.waypoint())

    def _drive(self, targets: Tensor) -> None:
        self.articulation.set_joint_drive_targets(targets, self.joints, self.active_joint_indices)
        self.step += 1


@dataclass
class ArmPathControllerConfig(ControllerConfig):
    stiffness: float
    damping: float
    force_limits: tuple[float, ...]
    """[Nm] a joint."""
    controller_cls = ArmPathController
