"""Moves the palm in Cartesian space through differential inverse kinematics, batched in torch."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import torch
from gymnasium import spaces
from mani_skill.agents.controllers.base_controller import BaseController, ControllerConfig
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.arm_path import (
    ArmPathController,
    ArmPathControllerConfig,
)
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics

DAMPING = 0.02  # [m, rad] of the damped least squares; bounds joint steps near singular postures.


def joint_step(jacobian: Tensor, twist: Tensor, damping: float = DAMPING) -> Tensor:
    """Joint displacement that moves a link by a small twist (damped least squares).

    Args:
        jacobian: (num_envs, 6, num_joints) linear rows, then angular ones, base frame.
        twist: (num_envs, 6) [m, rad] displacement, base frame.
        damping: regularisation lambda in J^T (J J^T + lambda^2 I)^-1.

    Returns:
        (num_envs, num_joints) [rad]
    """
    gram = jacobian @ jacobian.transpose(1, 2)
    gram = gram + damping**2 * torch.eye(6, device=gram.device)
    return (jacobian.transpose(1, 2) @ torch.linalg.solve(gram, twist[..., None]))[..., 0]


class PalmResidualController(ArmPathController):
    """Arm path plus a bounded, rate-limited palm displacement (x, y, z, yaw) in the world.

    Actions in [-1, 1] name the displacement inside the box; it may change while `open_steps` says
    so (from hover through closing) and is frozen during the lift.
    """

    config: PalmResidualControllerConfig

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self.residual = torch.zeros(self.scene.num_envs, 4, device=self.device)
        self.open_steps = torch.zeros(self.scene.num_envs, dtype=torch.long, device=self.device)
        self._kinematics = ArticulationKinematics.of(self.articulation)
        self._lower = torch.tensor(self.config.lower, device=self.device)
        self._upper = torch.tensor(self.config.upper, device=self.device)
        rates = torch.tensor(self.config.rates, device=self.device)
        self._max_step = rates / self._control_freq

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(-1.0, 1.0, (4,), dtype=np.float32)

    def set_path(self, env_idx: Tensor, path: Tensor) -> None:
        super().set_path(env_idx, path)
        self.residual[env_idx] = 0.0

    def set_action(self, action: Tensor) -> None:
        action = self._preprocess_action(action).clamp(-1, 1)
        # Zero must mean "stay on the path", so each side of the box is scaled on its own.
        wanted = torch.where(action < 0, -action * self._lower, action * self._upper)
        step = (wanted - self.residual).clamp(-self._max_step, self._max_step)
        self.residual += torch.where((self.step < self.open_steps)[:, None], step, 0.0)
        nominal = self.waypoint()
        self._drive(nominal + self._displacement(nominal))

    def _displacement(self, nominal: Tensor) -> Tensor:
        qpos = torch.zeros(len(nominal), self.articulation.max_dof, device=self.device)
        qpos[:, self.active_joint_indices] = nominal
        jacobian = self._kinematics.jacobian(qpos, self.config.palm_link)
        twist = torch.zeros(len(nominal), 6, device=self.device)
        twist[:, :3] = self.residual[:, :3]
        twist[:, 5] = self.residual[:, 3]
        return joint_step(jacobian[:, :, self.active_joint_indices], twist)

    def get_state(self) -> dict[str, Tensor]:
        return {"residual": self.residual.clone()}

    def set_state(self, state: dict[str, Tensor]) -> None:
        self.residual = state["residual"].clone()


@dataclass
class PalmResidualControllerConfig(ArmPathControllerConfig):
    palm_link: str = field(kw_only=True)
    lower: tuple[float, ...] = (-0.025, -0.025, -0.01, -0.3)
    """[m, m, m, rad] (facts: grasping, section 7)."""
    upper: tuple[float, ...] = (0.025, 0.025, 0.02, 0.3)
    """[m, m, m, rad]"""
    rates: tuple[float, ...] = (0.06, 0.06, 0.06, 0.8)
    """[m/s, m/s, m/s, rad/s]"""
    controller_cls = PalmResidualController


class PalmDeltaPoseController(BaseController):
    """Palm displacement a step: three translations and three rotations in the base frame.

    Actions in [-1, 1] are scaled to the step limits. Displacements add up on the commanded posture,
    so that the arm does not sag away from it under load.
    """

    config: PalmDeltaPoseControllerConfig
    sets_target_qpos = True
    sets_target_qvel = False

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self._kinematics = ArticulationKinematics.of(self.articulation)
        self._qlimits = self.articulation.get_qlimits()[0, self.active_joint_indices]
        self._command: Tensor | None = None
        limits = [self.config.max_translation] * 3 + [self.config.max_rotation] * 3
        self._scale = torch.tensor(limits, device=self.device)

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(-1.0, 1.0, (6,), dtype=np.float32)

    def set_drive_property(self) -> None:
        for joint, limit in zip(self.joints, self.config.force_limits, strict=True):
            joint.set_drive_properties(
                self.config.stiffness, self.config.damping, force_limit=limit
            )

    def reset(self) -> None:
        qpos = self.qpos.clone()
        if self._command is None:
            self._command = qpos
        else:
            mask = self.scene._reset_mask
            self._command[mask] = qpos[mask]

    def set_action(self, action: Tensor) -> None:
        twist = self._preprocess_action(action).clamp(-1, 1) * self._scale
        assert self._command is not None  # Reset comes before the first action.
        qpos = self.articulation.get_qpos().clone()
        qpos[:, self.active_joint_indices] = self._command
        jacobian = self._kinematics.jacobian(qpos, self.config.palm_link)
        step = joint_step(jacobian[:, :, self.active_joint_indices], twist)
        self._command = (self._command + step).clamp(self._qlimits[:, 0], self._qlimits[:, 1])
        self.articulation.set_joint_drive_targets(
            self._command, self.joints, self.active_joint_indices
        )

    def get_state(self) -> dict[str, Tensor]:
        return {} if self._command is None else {"command": self._command.clone()}

    def set_state(self, state: dict[str, Tensor]) -> None:
        self._command = state["command"].clone()


@dataclass
class PalmDeltaPoseControllerConfig(ControllerConfig):
    palm_link: str
    stiffness: float
    damping: float
    force_limits: tuple[float, ...]
    """[Nm] a joint."""
    max_translation: float = 0.02
    """[m] a control step."""
    max_rotation: float = 0.1
    """[rad] a control step."""
    controller_cls = PalmDeltaPoseController
