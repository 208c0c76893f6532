"""Drives a hand's motors at their real speed and drags the coupled joints along."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.joint_pos import (
    JointPosController,
    JointPosControllerConfig,
)
from maniskill_taskgrasp.agents.hand import HandDescription

LINK_STIFFNESS = 5.0  # A link rod is rigid: its drive is stiffer than the servo's, by this factor.


def coupled_qpos(source_qpos: Tensor, ratio: Tensor, offset: Tensor) -> Tensor:
    """(num_envs, num_couplings) [rad] where the linkage puts the coupled joints."""
    return source_qpos * ratio + offset


def drive_torques(hand: HandDescription) -> dict[str, float]:
    """Joint -> largest torque [Nm] of its drive, so that no motor gives more than it has.

    One servo moves a finger's middle joint and, through a rigid link rod, its last joint; virtual
    work makes the two share its torque: tau_pip + ratio * tau_dip <= torque_limit.
    """
    torques = dict.fromkeys(hand.actuators, hand.torque_limit)
    for coupling in hand.couplings:
        torques[coupling.joint] = hand.coupled_torque_limit
        torques[coupling.source] -= coupling.ratio * hand.coupled_torque_limit
    return torques


class CoupledHandController(JointPosController):
    """Commands are for the motors; a coupled joint goes where its measured source puts it."""

    config: CoupledHandControllerConfig

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        hand = self.config.hand
        source = [hand.actuators.index(coupling.source) for coupling in hand.couplings]
        self._source = self._commanded[source]
        self._ratio = torch.tensor([c.ratio for c in hand.couplings], device=self.device)
        self._offset = torch.tensor([c.offset for c in hand.couplings], device=self.device)

    def set_drive_property(self) -> None:
        super().set_drive_property()
        coupled = {coupling.joint for coupling in self.config.hand.couplings}
        for joint, limit in zip(self.joints, self.config.force_limits, strict=True):
            if joint.name in coupled:
                stiffness = LINK_STIFFNESS * self.config.stiffness
                joint.set_drive_properties(stiffness, self.config.damping, force_limit=limit)

    def _targets(self) -> Tensor:
        # Half a control step ahead, so that the linkage does not lag while the finger moves.
        ahead = self.articulation.get_qvel()[:, self._source] * (0.5 / self._control_freq)
        source_qpos = self.articulation.get_qpos()[:, self._source] + ahead
        coupled = coupled_qpos(source_qpos, self._ratio, self._offset)
        return torch.cat([self.command, coupled], dim=1)


@dataclass(kw_only=True)
class CoupledHandControllerConfig(JointPosControllerConfig):
    hand: HandDescription
    controller_cls = CoupledHandController

    @classmethod
    def of(cls, hand: HandDescription, **kwargs: Any) -> CoupledHandControllerConfig:
        """Config for that hand; its joints are the motors, then the coupled ones."""
        torques = drive_torques(hand)
        return cls(
            joint_names=list(torques),
            stiffness=hand.stiffness,
            damping=hand.damping,
            force_limits=tuple(torques.values()),
            speed_limits=(hand.speed_limit,) * len(hand.actuators),
            hand=hand,
            **kwargs,
        )
