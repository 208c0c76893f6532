"""The robot alone on a stage: what the physics tests of controllers share."""

import numpy as np
import sapien
import torch
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.utils.structs.types import SceneConfig, SimConfig

import maniskill_taskgrasp.agents  # noqa: F401  (Registers the robot.)
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.sawyer_ar10.description import ARM_JOINT_NAMES

CLOSED = (1.33, 1.2, *(1.57, 1.57) * 4)  # [rad] thumb over the palm, fingers to their stops.
CONTROL_TIME = 0.05  # [s]


class Stage(BaseEnv):
    """The robot alone, at the task's physics settings; with a table or a fixed cylinder.

    The cylinder is 4 cm thick and lies across the palm.
    """

    SUPPORTED_ROBOTS = ("sawyer_ar10",)

    def __init__(self, *args, table=False, cylinder=None, **kwargs):
        self._table, self._cylinder = table, cylinder
        super().__init__(*args, robot_uids="sawyer_ar10", **kwargs)

    @property
    def _default_sim_config(self):
        scene = SceneConfig(
            contact_offset=0.005, solver_position_iterations=12, enable_enhanced_determinism=True
        )
        return SimConfig(sim_freq=100, control_freq=20, scene_config=scene)

    def _load_agent(self, options):
        super()._load_agent(options, sapien.Pose())

    def _load_scene(self, options):
        builder = self.scene.create_actor_builder()
        material = sapien.physx.PhysxMaterial(0.9, 0.9, 0.0)
        builder.initial_pose = sapien.Pose()
        if self._table:
            pose = sapien.Pose([0.95, 0.0, -0.202])
            builder.add_box_collision(pose, [0.35, 0.7, 0.05], material)
        elif self._cylinder is not None:
            kinematics = ArticulationKinematics.of(self.agent.robot)
            rest = torch.tensor(self.agent.keyframes["rest"].qpos)[None]
            palm = kinematics.link_matrices(rest)[0, kinematics.link_index("palm_frame")]
            pose = sapien.Pose(palm.numpy()) * sapien.Pose(self._cylinder)
            builder.add_cylinder_collision(pose, 0.02, 0.045, material)
        else:
            return
        builder.build_static("obstacle")

    def _load_lighting(self, options):
        """Nothing is drawn."""

    def _initialize_episode(self, env_idx, options):
        """The robot starts in `rest`, which its own reset sees to."""

    def evaluate(self):
        return {}


def make(mode, **kwargs):
    """A stage in that control mode, reset."""
    env = Stage(
        obs_mode="none",
        reward_mode="none",
        control_mode=mode,
        sim_backend="cpu",
        render_backend="none",
        **kwargs,
    )
    env.reset(seed=0)
    return env


def qpos_of(env):
    """(dof,) [rad]"""
    return env.agent.robot.get_qpos()[0].numpy()


def joint(env, name):
    """Place of a joint in the robot's posture."""
    return [j.name for j in env.agent.robot.active_joints].index(name)


def rest_action(env, hand):
    """Absolute posture: the arm stays in `rest`, the hand goes to `hand` [rad]."""
    rest = env.agent.keyframes["rest"].qpos
    arm = [rest[joint(env, name)] for name in ARM_JOINT_NAMES]
    return np.array([*arm, *hand], dtype=np.float32)
