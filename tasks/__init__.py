"""Tasks: importing this package registers TaskGrasp-v0 with ManiSkill."""

from maniskill_taskgrasp.tasks.task_grasp import TaskGraspEnv

__all__ = ["TaskGraspEnv"]
