"""Many environments on the CPU in one process: what a task mixes in, and nothing else.

ManiSkill 3.0.1 refuses `num_envs > 1` on a CPU. Here a few `PhysxCpuSystem`s, each holding several
copies of the scene at offsets, stand behind the buffers and calls of `PhysxGpuSystem`, so that
ManiSkill's batched structs, partial resets and contact queries run unchanged. Delete this package
and the mixin's name in the task's bases when ManiSkill learns to do it itself.
"""

from maniskill_taskgrasp.tasks.cpu_batch.mixin import CpuBatchMixin

__all__ = ["CpuBatchMixin"]
