"""The Sawyer arm with the AR10 hand as a ManiSkill robot, usable in any ManiSkill task."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.agents.base_agent import BaseAgent, Keyframe
from mani_skill.agents.registration import REGISTERED_AGENTS, register_agent
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils import sapien_utils
from mani_skill.utils.structs import Actor
from mani_skill.utils.structs.pose import Pose
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.arm_path import ArmPathController
from maniskill_taskgrasp.agents.controllers.joint_synergy import JointSynergyController
from maniskill_taskgrasp.agents.controllers.palm_motion import PalmResidualController
from maniskill_taskgrasp.agents.hand import HandDescription
from maniskill_taskgrasp.agents.sawyer_ar10.build import default_folder
from maniskill_taskgrasp.agents.sawyer_ar10.control_modes import control_modes
from maniskill_taskgrasp.agents.sawyer_ar10.description import (
    ARM_JOINT_NAMES,
    PART_PRIMITIVES,
    SENSED_PRIMITIVES,
)
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.topology import TOPOLOGIES

REST_ARM = (-0.202, -0.78, -0.113, 1.75, -0.34, -1.0, 0.52)
"""[rad] palm down 0.75 m in front of the base and 0.25 m above it (fact sheet, section 1.5)."""
NEUTRAL_ARM = (0.0, -1.18, 0.0, 2.18, 0.0, 0.57, 3.3161)
"""[rad] the manufacturer's neutral posture."""
CAMERA_EYE = (0.0, 0.09, 0.015)  # [m] under the wrist, in hand_base
CAMERA_TARGET = (-0.03, 0.11, 0.13)  # [m] in front of the fingers, to see what comes
CAMERA_UP = (0.0, -1.0, 0.0)  # Out of the back of the hand: up in the picture, palm down.
GRASP_FORCE = 0.5  # [N] least force of the thumb and of a finger that counts as grasping.
PRESSING_ITERATIONS = 32
"""Least solver position iterations of the modes in which the arm may press the hand into a table:
with 12 a knuckle goes 0.052 rad past its stop under 250 N, with 32 0.007 (docs/robot.md)."""

if "sawyer_ar10" in REGISTERED_AGENTS:
    raise RuntimeError(
        "a robot named 'sawyer_ar10' is registered already; ours must be the only one"
    )


def _robot_file(name: str) -> str:
    return str(default_folder() / name)


@register_agent()
class SawyerAR10(BaseAgent):
    """Rethink Sawyer (7 joints) with an Active8 AR10 hand (10 actuators, 4 coupled joints)."""

    uid = "sawyer_ar10"
    hand: HandDescription = AR10
    part_primitives = PART_PRIMITIVES
    sensed_primitives = SENSED_PRIMITIVES
    urdf_path = _robot_file("sawyer_ar10.urdf")
    # Rubber against a hard object; the solver averages the two sides' coefficients.
    urdf_config = {  # noqa: RUF012  (ManiSkill reads a class attribute.)
        "_materials": {
            "rubber": {"static_friction": 0.9, "dynamic_friction": 0.9, "restitution": 0.0}
        },
        "link": {
            link: {"material": "rubber"} for links in AR10.part_links.values() for link in links
        },
    }
    # Self-collision costs three times the physics and changed no result (facts, simulation 1).
    disable_self_collisions = True

    def __init__(self, scene: Any, *args: Any, **kwargs: Any) -> None:
        if not scene.can_render():
            # Without a Vulkan device SAPIEN raises on the first visual shape.
            self.urdf_path = _robot_file("sawyer_ar10_collision.urdf")
        super().__init__(scene, *args, **kwargs)

    @cached_property
    def keyframes(self) -> dict[str, Keyframe]:  # type: ignore[override]
        """`rest`, `neutral`, and `pregrasp_<slug>` for every topology."""
        names = {"rest": (REST_ARM, self._open_hand()), "neutral": (NEUTRAL_ARM, self._open_hand())}
        for slug, posture in self.hand.postures.items():
            names[f"pregrasp_{slug}"] = (REST_ARM, np.asarray(posture.preshape))
        return {
            name: Keyframe(pose=sapien.Pose(), qpos=self.full_qpos(np.asarray(arm), hand))
            for name, (arm, hand) in names.items()
        }

    def _open_hand(self) -> np.ndarray:
        return np.array([self.robot.joints_map[n].limits[0, 0] for n in self.hand.actuators])

    def full_qpos(self, arm: np.ndarray, hand: np.ndarray) -> np.ndarray:
        """Whole-robot posture with coupled joints in place.

        Args:
            arm: (..., 7) [rad].
            hand: (..., num_actuators) [rad].

        Returns:
            (..., dof) [rad] in the articulation's joint order.
        """
        index = {joint.name: i for i, joint in enumerate(self.robot.active_joints)}
        qpos = np.zeros((*np.shape(arm)[:-1], len(index)), dtype=np.float32)
        qpos[..., [index[name] for name in ARM_JOINT_NAMES]] = arm
        for name, angle in self.hand.joint_angles(hand).items():
            qpos[..., index[name]] = angle
        return qpos

    @property
    def _controller_configs(self) -> dict[str, Any]:
        return control_modes(self.hand)

    @property
    def _sensor_configs(self) -> list[CameraConfig]:
        view = sapien_utils.look_at(CAMERA_EYE, CAMERA_TARGET, up=CAMERA_UP)
        wrist = self.robot.links_map["hand_base"]
        return [CameraConfig("hand_camera", view, 128, 128, np.pi / 2, 0.01, 10.0, mount=wrist)]

    def _after_loading_articulation(self) -> None:
        """Reflected inertia of the hand's motors.

        Speeds are limited by the commands: PhysX's own limit of a joint's velocity also eats the
        forces that the joint passes on (a pinch of 10 N fell to 0.5 N).
        """
        armature = np.array([self.hand.armature], dtype=np.float32)
        for name in (*self.hand.actuators, *(c.joint for c in self.hand.couplings)):
            for joint in self.robot.active_joints_map[name]._objs:
                joint.set_armature(armature)

    def set_control_mode(self, control_mode: str | None = None) -> None:
        """As ManiSkill's; modes without a planned path make the solver keep the joints' stops."""
        super().set_control_mode(control_mode)  # type: ignore[arg-type]
        planned = "synergy" in self.control_mode
        iterations = self._own_iterations
        for body in self.robot._objs:
            body.set_solver_position_iterations(
                iterations if planned else max(iterations, PRESSING_ITERATIONS)
            )

    @cached_property
    def _own_iterations(self) -> int:
        """Solver iterations that the task gave the robot."""
        return int(self.robot._objs[0].get_solver_position_iterations())

    def _after_init(self) -> None:
        self.tcp = self.robot.links_map[self.hand.palm_frame]
        self.part_links = {
            part: [self.robot.links_map[name] for name in names]
            for part, names in self.hand.part_links.items()
        }
        self.actuator_indices = self._indices(self.hand.actuators)
        self.arm_indices = self._indices(ARM_JOINT_NAMES)
        self.thumb_rotation = self.hand.actuators.index(self.hand.thumb_rotation)
        self.finger_pip = [self.hand.actuators.index(c.source) for c in self.hand.couplings]

    def _indices(self, names: tuple[str, ...]) -> Tensor:
        order = {joint.name: i for i, joint in enumerate(self.robot.active_joints)}
        return torch.tensor([order[name] for name in names], device=self.device)

    def reset(self, init_qpos: Tensor | np.ndarray | None = None) -> None:
        """Reset to `init_qpos`, else to `rest`: all-zero lies outside the hand's joint limits."""
        super().reset(self.keyframes["rest"].qpos if init_qpos is None else init_qpos)
        for controller in self.controller.controllers.values():
            controller.expect_reset()

    def get_controller_state(self) -> dict[str, dict[str, Tensor]]:
        """Everything that the controllers remember; observations show less."""
        return {uid: c.memory() for uid, c in self.controller.controllers.items()}

    def set_controller_state(
        self, state: dict[str, dict[str, Tensor]], env_idx: Tensor | None = None
    ) -> None:
        """Take back what `get_controller_state` gave, for some environments or all."""
        for uid, controller in self.controller.controllers.items():
            controller.set_state(state.get(uid), env_idx)

    def set_plan(
        self,
        env_idx: Tensor,
        path: Tensor,
        preshape: Tensor,
        closing: Tensor,
        open_steps: int,
        wait: int = 0,
    ) -> None:
        """Give environments their arm path and postures, during or after their reset.

        Only the control mode in use takes them, and only modes that close along synergies do;
        without a plan these hold the arm still.

        Args:
            env_idx: (n,) environments.
            path: (n, num_steps, 7) [rad] arm waypoints, one a control step.
            preshape: (n, num_actuators) [rad] hand posture at activation 0.
            closing: (n, num_actuators) [rad] hand posture at activation 1.
            open_steps: control steps during which a palm residual may change.
            wait: control steps for which the hand keeps its preshape.
        """
        arm, hand = (self.controller.controllers[uid] for uid in ("arm", "hand"))
        if isinstance(arm, ArmPathController):
            arm.set_path(env_idx, path)
        if isinstance(arm, PalmResidualController):
            arm.open_steps[env_idx] = open_steps
        if isinstance(hand, JointSynergyController):
            hand.set_postures(env_idx, preshape, closing, wait)

    @property
    def tcp_pos(self) -> Tensor:
        """(num_envs, 3) [m] palm frame, world."""
        return self.tcp.pose.p

    @property
    def tcp_pose(self) -> Pose:
        """Palm frame in the world: +y is the palm normal, +z along straight fingers."""
        return self.tcp.pose

    def is_grasping(self, object: Actor | None = None) -> Tensor:  # noqa: A002
        """(num_envs,) bool: thumb or palm and at least one finger press the object."""
        if object is None:
            raise ValueError("is_grasping needs the object to look at, got None")
        force = {part: self._part_force(part, object) for part in self.part_links}
        against = torch.maximum(force["thumb"], force["palm"])
        fingers = torch.stack([force[p] for p in ("index", "middle", "ring", "little")]).amax(0)
        return (against >= GRASP_FORCE) & (fingers >= GRASP_FORCE)

    def _part_force(self, part: str, obj: Actor) -> Tensor:
        forces = [
            self.scene.get_pairwise_contact_forces(link, obj) for link in self.part_links[part]
        ]
        return torch.linalg.norm(torch.stack(forces).sum(0), dim=1)

    def is_static(self, threshold: float = 0.2) -> Tensor:
        """(num_envs,) bool: no arm joint moves faster than the threshold [rad/s]."""
        return self.robot.get_qvel()[:, self.arm_indices].abs().amax(1) <= threshold


assert set(AR10.postures) == {topology.slug for topology in TOPOLOGIES}
