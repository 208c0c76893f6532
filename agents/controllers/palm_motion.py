"""Moves the palm in Cartesian space through differential inverse kinematics, batched in torch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from gymnasium import spaces
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.arm_path import (
    ArmPathController,
    ArmPathControllerConfig,
)
from maniskill_taskgrasp.agents.controllers.joint_pos import (
    JointPosController,
    JointPosControllerConfig,
)
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.rotations import axis_angle_matrix, pose_error

DAMPING = 0.02  # [m, rad] of the damped least squares; bounds joint steps near singular postures.
RESIDUAL_ITERATIONS = 2  # The second takes out what the first, linear one leaves.
YAW_AXIS = 2


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
    gram = gram + damping**2 * torch.eye(6, dtype=gram.dtype, device=gram.device)
    return (jacobian.transpose(1, 2) @ torch.linalg.solve(gram, twist[..., None]))[..., 0]


def slowed(step: Tensor, max_step: Tensor) -> Tensor:
    """A joint step shortened as a whole, so that its direction stays, to what the joints can do.

    Args:
        step: (num_envs, num_joints) [rad].
        max_step: (num_joints,) [rad] speed limit times control time.
    """
    excess = (step.abs() / max_step).amax(1, keepdim=True)
    return step / excess.clamp(min=1.0)


class _PalmKinematics:
    """Pose and Jacobian of the palm for postures of the controlled joints alone."""

    def __init__(self, controller: JointPosController, palm_link: str) -> None:
        self._kinematics = ArticulationKinematics.of(controller.articulation)
        self._columns = controller.active_joint_indices
        self._link = palm_link

    def __call__(self, qpos: Tensor) -> tuple[Tensor, Tensor]:
        """(n, num_joints) [rad] -> pose (n, 4, 4) and Jacobian (n, 6, num_joints), base frame."""
        full = qpos.new_zeros(len(qpos), self._kinematics.dof)
        full[:, self._columns] = qpos
        pose, jacobian = self._kinematics.pose_and_jacobian(full, self._link)
        return pose, jacobian[:, :, self._columns]


class PalmResidualController(ArmPathController):
    """Arm path plus a bounded, rate-limited palm displacement (x, y, z, yaw), base frame.

    Actions in [-1, 1] name the displacement inside the box; it may change while `open_steps` says
    so (from hover through closing) and is frozen during the lift.
    """

    config: PalmResidualControllerConfig
    _memory = (*ArmPathController._memory, "residual", "open_steps")
    _observed = ("residual",)

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self.residual = torch.zeros(self.scene.num_envs, 4, device=self.device)
        self.open_steps = torch.zeros_like(self.step)
        self._palm = _PalmKinematics(self, self.config.palm_link)
        self._lower = torch.tensor(self.config.lower, device=self.device)
        self._upper = torch.tensor(self.config.upper, device=self.device)
        rates = torch.tensor(self.config.rates, device=self.device)
        self._max_residual_step = rates / self._control_freq

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(-1.0, 1.0, (4,), dtype=np.float32)

    def _hold_still(self, envs: Tensor) -> None:
        super()._hold_still(envs)
        self.residual[envs] = 0.0
        self.open_steps[envs] = 0

    def set_path(self, env_idx: Tensor, path: Tensor) -> None:
        super().set_path(env_idx, path)
        self.residual[env_idx] = 0.0

    def wanted_qpos(self, action: Tensor) -> Tensor:
        action = action.clamp(-1, 1)
        # Zero must mean "stay on the path", so each side of the box is scaled on its own.
        wanted = torch.where(action < 0, -action * self._lower, action * self._upper)
        step = (wanted - self.residual).clamp(-self._max_residual_step, self._max_residual_step)
        self.residual += torch.where((self.step < self.open_steps)[:, None], step, 0.0)
        return self._displaced(self.waypoint())

    def action_for(self, displacement: Tensor) -> Tensor:
        """(num_envs, 4) action that names a displacement (num_envs, 4) [m, m, m, rad]."""
        side = torch.where(displacement < 0, -self._lower, self._upper)
        return (displacement / side).clamp(-1, 1)

    def _displaced(self, qpos: Tensor) -> Tensor:
        """Arm posture (num_envs, num_joints) [rad] whose palm is off that of `qpos`."""
        pose, jacobian = self._palm(qpos)
        position = pose[:, :3, 3] + self.residual[:, :3]
        rotation = axis_angle_matrix(YAW_AXIS, self.residual[:, 3]) @ pose[:, :3, :3]
        for i in range(RESIDUAL_ITERATIONS):
            if i:
                pose, jacobian = self._palm(qpos)
            qpos = qpos + joint_step(jacobian, pose_error(pose, position, rotation))
        return qpos


@dataclass(kw_only=True)
class PalmResidualControllerConfig(ArmPathControllerConfig):
    palm_link: str
    lower: tuple[float, ...] = (-0.025, -0.025, -0.01, -0.3)
    """[m, m, m, rad] (facts: grasping, section 7)."""
    upper: tuple[float, ...] = (0.025, 0.025, 0.02, 0.3)
    """[m, m, m, rad]"""
    rates: tuple[float, ...] = (0.06, 0.06, 0.06, 0.8)
    """[m/s, m/s, m/s, rad/s]"""
    controller_cls = PalmResidualController


class PalmDeltaPoseController(JointPosController):
    """Palm displacement a step: three translations and three rotations in the base frame.

    Actions in [-1, 1] are scaled to the step limits. Displacements add up on the commanded posture,
    so that the arm does not sag away from it under load.
    """

    config: PalmDeltaPoseControllerConfig

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self._palm = _PalmKinematics(self, self.config.palm_link)
        limits = [self.config.max_translation] * 3 + [self.config.max_rotation] * 3
        self._scale = torch.tensor(limits, device=self.device)

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(-1.0, 1.0, (6,), dtype=np.float32)

    def wanted_qpos(self, action: Tensor) -> Tensor:
        _, jacobian = self._palm(self.command)
        step = joint_step(jacobian, action.clamp(-1, 1) * self._scale)
        return self.command + slowed(step, self._max_step)


@dataclass(kw_only=True)
class PalmDeltaPoseControllerConfig(JointPosControllerConfig):
    palm_link: str
    max_translation: float = 0.02
    """[m] a control step."""
    max_rotation: float = 0.1
    """[rad] a control step."""
    controller_cls = PalmDeltaPoseController
