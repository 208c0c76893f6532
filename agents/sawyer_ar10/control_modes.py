"""Control modes of the Sawyer with an AR10: which controllers drive the arm and the hand."""

from __future__ import annotations

from typing import Any

import numpy as np
from mani_skill.agents.controllers import PDJointPosControllerConfig

from maniskill_taskgrasp.agents.controllers.arm_path import ArmPathControllerConfig
from maniskill_taskgrasp.agents.controllers.coupled_hand import (
    CoupledHandControllerConfig,
    HandDeltaPosControllerConfig,
)
from maniskill_taskgrasp.agents.controllers.joint_synergy import (
    JointSynergyControllerConfig,
    spread_all,
    spread_moving,
    spread_one,
)
from maniskill_taskgrasp.agents.controllers.palm_motion import (
    PalmDeltaPoseControllerConfig,
    PalmResidualControllerConfig,
)
from maniskill_taskgrasp.agents.hand import HandDescription

ARM_JOINTS = tuple(f"right_j{i}" for i in range(7))
ARM_FORCE_LIMITS = (80.0, 80.0, 40.0, 40.0, 9.0, 9.0, 9.0)  # [Nm] manufacturer's URDF, `effort`.
ARM_STIFFNESS = 2000.0  # [Nm/rad] Steady-state error below 1e-4 rad (fact sheet, section 2.3).
ARM_DAMPING = 200.0  # [Nms/rad]
ARM_DELTA = 0.05  # [rad] largest joint step of pd_joint_delta_pos, 1 rad/s at 20 Hz.


def control_modes(hand: HandDescription) -> dict[str, dict[str, Any]]:
    """Control mode -> controllers of arm and hand, made anew at each call.

    The synergy modes let the arm follow the planned path: `pd_synergy` takes one activation an
    actuator, `pd_synergy_<slug>` one for each actuator that the topology moves, `pd_synergy_1d` one
    in all, and `pd_synergy_wrist` ten activations after four numbers that displace the palm.
    """
    num_actuators = len(hand.actuators)
    drive = {"stiffness": ARM_STIFFNESS, "damping": ARM_DAMPING}
    arm: dict[str, Any] = {"joint_names": list(ARM_JOINTS), **drive}
    limited = {**arm, "force_limits": ARM_FORCE_LIMITS}

    def synergy(spread: tuple[tuple[float, ...], ...]) -> dict[str, Any]:
        return {
            "arm": ArmPathControllerConfig(**limited),
            "hand": JointSynergyControllerConfig.of(hand, spread=spread),
        }

    joint_pos = PDJointPosControllerConfig(
        **arm, lower=None, upper=None, force_limit=ARM_FORCE_LIMITS, normalize_action=False
    )
    joint_delta_pos = PDJointPosControllerConfig(
        **arm,
        lower=-ARM_DELTA,
        upper=ARM_DELTA,
        force_limit=ARM_FORCE_LIMITS,
        use_delta=True,
        use_target=True,
    )
    return {
        "pd_joint_delta_pos": {
            "arm": joint_delta_pos,
            "hand": HandDeltaPosControllerConfig.of(hand),
        },
        "pd_joint_pos": {"arm": joint_pos, "hand": CoupledHandControllerConfig.of(hand)},
        "pd_ee_delta_pose": {
            "arm": PalmDeltaPoseControllerConfig(**limited, palm_link=hand.palm_frame),
            "hand": HandDeltaPosControllerConfig.of(hand),
        },
        "pd_synergy": synergy(spread_all(num_actuators)),
        "pd_synergy_1d": synergy(spread_one(num_actuators)),
        "pd_synergy_wrist": {
            "arm": PalmResidualControllerConfig(**limited, palm_link=hand.palm_frame),
            "hand": JointSynergyControllerConfig.of(hand, spread=spread_all(num_actuators)),
        },
        **{
            f"pd_synergy_{slug}": synergy(spread_moving(np.asarray(posture.moving)))
            for slug, posture in hand.postures.items()
        },
    }
