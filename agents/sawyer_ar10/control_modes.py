"""Control modes of the Sawyer with an AR10: which controllers drive the arm and the hand."""

from __future__ import annotations

from typing import Any

from maniskill_taskgrasp.agents.controllers.arm_path import ArmPathControllerConfig
from maniskill_taskgrasp.agents.controllers.coupled_hand import CoupledHandControllerConfig
from maniskill_taskgrasp.agents.controllers.joint_pos import JointPosControllerConfig
from maniskill_taskgrasp.agents.controllers.joint_synergy import (
    JointSynergyControllerConfig,
    Spread,
    spread_all,
    spread_moving,
    spread_one,
)
from maniskill_taskgrasp.agents.controllers.palm_motion import (
    PalmDeltaPoseControllerConfig,
    PalmResidualControllerConfig,
)
from maniskill_taskgrasp.agents.hand import HandDescription, Posture
from maniskill_taskgrasp.agents.sawyer_ar10.description import ARM_JOINT_NAMES, SAWYER_AR10

ARM_STIFFNESS = 2000.0  # [Nm/rad] Steady-state error below 1e-4 rad (fact sheet, section 2.3).
ARM_DAMPING = 200.0  # [Nms/rad]
ARM_DELTA_SPEED = 1.0  # [rad/s] of pd_joint_delta_pos; every arm joint can do it.


def control_modes(hand: HandDescription) -> dict[str, dict[str, Any]]:
    """Control mode -> controllers of arm and hand, made anew at each call.

    The synergy modes let the arm follow the planned path: `pd_synergy` takes one activation a
    motor, `pd_synergy_<slug>` one for each motor that the topology moves, `pd_synergy_1d` one
    in all, and `pd_synergy_wrist` ten activations after four numbers that displace the palm.
    """
    num_actuators = len(hand.actuators)
    joints = [SAWYER_AR10.joint(name) for name in ARM_JOINT_NAMES]
    arm: dict[str, Any] = {
        "joint_names": list(ARM_JOINT_NAMES),
        "stiffness": ARM_STIFFNESS,
        "damping": ARM_DAMPING,
        "force_limits": tuple(joint.effort for joint in joints),
        "speed_limits": tuple(joint.velocity for joint in joints),
    }

    def synergy(spread: Spread, posture: Posture | None = None) -> dict[str, Any]:
        return {
            "arm": ArmPathControllerConfig(**arm),
            "hand": JointSynergyControllerConfig.of(hand, spread=spread, posture=posture),
        }

    hand_delta = {"delta_speed": hand.speed_limit}
    return {
        "pd_joint_delta_pos": {
            "arm": JointPosControllerConfig(**arm, delta_speed=ARM_DELTA_SPEED),
            "hand": CoupledHandControllerConfig.of(hand, **hand_delta),
        },
        "pd_joint_pos": {
            "arm": JointPosControllerConfig(**arm),
            "hand": CoupledHandControllerConfig.of(hand),
        },
        "pd_ee_delta_pose": {
            "arm": PalmDeltaPoseControllerConfig(**arm, palm_link=hand.palm_frame),
            "hand": CoupledHandControllerConfig.of(hand, **hand_delta),
        },
        "pd_synergy": synergy(spread_all(num_actuators)),
        "pd_synergy_1d": synergy(spread_one(num_actuators)),
        "pd_synergy_wrist": {
            "arm": PalmResidualControllerConfig(**arm, palm_link=hand.palm_frame),
            "hand": JointSynergyControllerConfig.of(hand, spread=spread_all(num_actuators)),
        },
        **{
            f"pd_synergy_{slug}": synergy(spread_moving(posture.moving), posture)
            for slug, posture in hand.postures.items()
        },
    }
