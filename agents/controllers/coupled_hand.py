"""Drives a hand's actuators at their real speed and drags the coupled joints along."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import torch
from gymnasium import spaces
from mani_skill.agents.controllers.base_controller import BaseController, ControllerConfig
from torch import Tensor

from maniskill_taskgrasp.agents.hand import HandDescription


def step_towards(command: Tensor, wanted: Tensor, max_step: float) -> Tensor:
    """Command moved towards the wanted posture by at most `max_step` a joint.

    Args:
        command: (num_envs, num_joints) [rad] last commanded posture.
        wanted: (num_envs, num_joints) [rad] posture asked for.
        max_step: [rad] speed limit times control time.
    """
    return command + (wanted - command).clamp(-max_step, max_step)


def coupled_qpos(source_qpos: Tensor, ratio: Tensor, offset: Tensor) -> Tensor:
    """(num_envs, num_couplings) [rad] where the linkage puts the coupled joints."""
    return source_qpos * ratio + offset


class CoupledHandController(BaseController):
    """Base of all hand controllers: subclasses say which posture is wanted.

    One servo moves a finger's middle joint and, through a rigid link rod, its last joint. The
    middle joint's measured position therefore decides the last joint's target, and the two share
    the actuator's torque: tau_pip + ratio * tau_dip <= torque_limit.
    """

    config: CoupledHandControllerConfig
    sets_target_qpos = True
    sets_target_qvel = False

    def _initialize_joints(self) -> None:
        super()._initialize_joints()  # Joints and indices of actuators, then of coupled joints.
        hand = self.config.hand
        self._num_actuators = len(hand.actuators)
        source = [hand.actuators.index(c.source) for c in hand.couplings]
        self._source = torch.tensor(source, device=self.device)
        self._ratio = torch.tensor([c.ratio for c in hand.couplings], device=self.device)
        self._offset = torch.tensor([c.offset for c in hand.couplings], device=self.device)
        self.qlimits = self.articulation.get_qlimits()[0, self.active_joint_indices]
        self._command: Tensor | None = None

    def _initialize_action_space(self) -> None:
        qlimits = self.qlimits[: self._num_actuators].cpu().numpy()
        self.single_action_space = spaces.Box(qlimits[:, 0], qlimits[:, 1], dtype=np.float32)

    def set_drive_property(self) -> None:
        hand = self.config.hand
        sources = {c.source: c.ratio for c in hand.couplings}
        for joint in self.joints:
            if joint.name not in hand.actuators:
                limit = hand.coupled_torque_limit
                # The link rod is rigid: its drive is stiffer than the servo's.
                stiffness, damping = 5 * hand.stiffness, hand.damping
            else:
                limit = hand.torque_limit
                limit -= sources.get(joint.name, 0.0) * hand.coupled_torque_limit
                stiffness, damping = hand.stiffness, hand.damping
            joint.set_drive_properties(stiffness, damping, force_limit=limit)

    def reset(self) -> None:
        qpos = self.qpos[:, : self._num_actuators].clone()
        if self._command is None:
            self._command = qpos
        else:
            mask = self.scene._reset_mask
            self._command[mask] = qpos[mask]

    def wanted_qpos(self, action: Tensor) -> Tensor:
        """(num_envs, num_actuators) [rad] posture that the action asks for."""
        return action

    def set_action(self, action: Tensor) -> None:
        wanted = self.wanted_qpos(self._preprocess_action(action))
        assert self._command is not None  # Reset comes before the first action.
        limits = self.qlimits[: self._num_actuators]
        self._command = step_towards(
            self._command,
            wanted.clamp(limits[:, 0], limits[:, 1]),
            self.config.hand.speed_limit / self._control_freq,
        )
        self.articulation.set_joint_drive_targets(
            torch.cat([self._command, self._coupled_targets()], dim=1),
            self.joints,
            self.active_joint_indices,
        )

    def _coupled_targets(self) -> Tensor:
        # Half a control step ahead, so that the linkage does not lag while the finger moves.
        source = self.active_joint_indices[self._source]
        ahead = self.articulation.get_qvel()[:, source] * (0.5 / self._control_freq)
        return coupled_qpos(
            self.articulation.get_qpos()[:, source] + ahead, self._ratio, self._offset
        )

    def get_state(self) -> dict[str, Tensor]:
        return {} if self._command is None else {"command": self._command.clone()}

    def set_state(self, state: dict[str, Tensor]) -> None:
        self._command = state["command"].clone()


@dataclass
class CoupledHandControllerConfig(ControllerConfig):
    """Absolute posture of the ten actuators [rad]."""

    hand: HandDescription = field(kw_only=True)
    controller_cls = CoupledHandController

    @classmethod
    def of(cls, hand: HandDescription, **kwargs: object) -> CoupledHandControllerConfig:
        """Config for that hand; its joints are the actuators, then the coupled ones."""
        joint_names: Sequence[str] = [*hand.actuators, *(c.joint for c in hand.couplings)]
        return cls(joint_names=list(joint_names), hand=hand, **kwargs)  # type: ignore[arg-type]


class HandDeltaPosController(CoupledHandController):
    """Change of the ten actuators' commanded posture; [-1, 1] is one step at full speed."""

    def _initialize_action_space(self) -> None:
        ones = np.ones(self._num_actuators, dtype=np.float32)
        self.single_action_space = spaces.Box(-ones, ones, dtype=np.float32)

    def wanted_qpos(self, action: Tensor) -> Tensor:
        assert self._command is not None
        max_step = self.config.hand.speed_limit / self._control_freq
        return self._command + action.clamp(-1, 1) * max_step


@dataclass
class HandDeltaPosControllerConfig(CoupledHandControllerConfig):
    controller_cls = HandDeltaPosController
