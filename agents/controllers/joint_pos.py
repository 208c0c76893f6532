"""Position drives that follow a command, which moves no faster than the joints can."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import torch
from gymnasium import spaces
from mani_skill.agents.controllers.base_controller import BaseController, ControllerConfig
from torch import Tensor


def step_towards(command: Tensor, wanted: Tensor, max_step: Tensor) -> Tensor:
    """Command moved towards the wanted posture; exactly the wanted one where that is near enough.

    Args:
        command: (num_envs, num_joints) [rad] last commanded posture.
        wanted: (num_envs, num_joints) [rad] posture asked for.
        max_step: (num_joints,) [rad] speed limit times control time.
    """
    return torch.minimum(torch.maximum(wanted, command - max_step), command + max_step)


class JointPosController(BaseController):
    """Base of all our controllers: subclasses say which posture an action wants.

    Used by itself, an action is the posture [rad], or its change where the config has a
    `delta_speed`. Every tensor that later steps depend on is named in `_memory`.
    """

    config: JointPosControllerConfig
    sets_target_qpos = True
    sets_target_qvel = False
    _memory: ClassVar[tuple[str, ...]] = ("command",)
    _observed: ClassVar[tuple[str, ...]] = ("command",)

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        num_joints = len(self.config.speed_limits)  # The hand also has joints without a motor.
        self._commanded = self.active_joint_indices[:num_joints]
        self.qlimits = self.articulation.get_qlimits()[0, self._commanded]
        speed_limits = torch.tensor(self.config.speed_limits, device=self.device)
        self._max_step = speed_limits / self._control_freq
        self.command = torch.zeros(self.scene.num_envs, num_joints, device=self.device)
        self._planned = torch.zeros(self.scene.num_envs, dtype=torch.bool, device=self.device)
        self._due: Tensor | None = None
        self._set_target = [joint._objs[0].set_drive_target for joint in self.joints]

    def _initialize_action_space(self) -> None:
        low, high = self.qlimits.cpu().numpy().T
        if self.config.delta_speed is not None:
            low, high = -np.ones_like(low), np.ones_like(high)
        self.single_action_space = spaces.Box(low, high, dtype=np.float32)

    def set_drive_property(self) -> None:
        for joint, limit in zip(self.joints, self.config.force_limits, strict=True):
            joint.set_drive_properties(
                self.config.stiffness, self.config.damping, force_limit=limit
            )

    def expect_reset(self) -> None:
        """Note which environments reset; ManiSkill has forgotten it when it calls `reset`."""
        self._due = self.scene._reset_mask.clone()

    def reset(self) -> None:
        """Commands start where the joints are; environments without a plan hold still."""
        due = self.scene._reset_mask if self._due is None else self._due
        self.command[due] = self.articulation.get_qpos()[due][:, self._commanded]
        self._hold_still(due & ~self._planned)
        self._planned[due] = False
        self._due = None

    def _hold_still(self, envs: Tensor) -> None:
        """Give environments, (num_envs,) bool, a plan to stay where they are."""

    def wanted_qpos(self, action: Tensor) -> Tensor:
        """(num_envs, num_joints) [rad] posture that the action asks for."""
        if self.config.delta_speed is None:
            return action
        return self.command + action.clamp(-1, 1) * (self.config.delta_speed / self._control_freq)

    def set_action(self, action: Tensor) -> None:
        wanted = self.wanted_qpos(self._preprocess_action(action))
        wanted = wanted.clamp(self.qlimits[:, 0], self.qlimits[:, 1])
        self.command = step_towards(self.command, wanted, self._max_step)
        self._drive(self._targets())

    @cached_property
    def _target_places(self) -> tuple[Tensor, Tensor]:
        """Rows and columns of the joints in the simulation's targets."""
        rows, columns = self.articulation.get_joint_target_indices(self.joints)
        return rows.long(), columns.long()

    def _drive(self, targets: Tensor) -> None:
        """Tell the drives of all joints their targets, (num_envs, len(joints)) [rad]."""
        if self.scene.gpu_sim_enabled:
            # ManiSkill's own setter masks environments for resets, which costs more than the rest.
            self.scene.px.cuda_articulation_target_qpos.torch()[self._target_places] = targets
            return
        # ManiSkill takes ten times as long to tell SAPIEN's joints one by one.
        for set_target, target in zip(self._set_target, targets[0].tolist(), strict=True):
            set_target(target)

    def _targets(self) -> Tensor:
        """(num_envs, len(joints)) [rad] what the drives are told."""
        return self.command

    def get_state(self) -> dict[str, Tensor]:
        """What an observation may know; `memory` has everything."""
        return {name: getattr(self, name).clone() for name in self._observed}

    def memory(self) -> dict[str, Tensor]:
        """Everything that later steps depend on, as (num_envs, ...) 2-D float tensors."""
        fields = {name: getattr(self, name).float().clone() for name in self._memory}
        return {name: field.reshape(len(field), -1) for name, field in fields.items()}

    def set_state(self, state: dict[str, Tensor] | None, env_idx: Tensor | None = None) -> None:
        """Take back what `get_state` or `memory` gave, for some environments or all."""
        envs = torch.arange(self.scene.num_envs, device=self.device) if env_idx is None else env_idx
        for name, value in (state or {}).items():
            field = getattr(self, name)
            field[envs] = value.reshape(-1, *field.shape[1:]).to(field)
        if self._due is not None:  # Restored in the middle of a reset: that counts as reset.
            self._due[envs] = False


@dataclass(kw_only=True)
class JointPosControllerConfig(ControllerConfig):
    """`joint_names` may end with joints that have no motor and follow others."""

    stiffness: float
    """[Nm/rad]"""
    damping: float
    """[Nms/rad]"""
    force_limits: tuple[float, ...]
    """[Nm] a joint."""
    speed_limits: tuple[float, ...]
    """[rad/s] a motor."""
    delta_speed: float | None = None
    """[rad/s] that an action of 1 stands for; None: actions are postures."""
    controller_cls = JointPosController
