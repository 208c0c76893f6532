"""Many environments on the CPU in one process: what a task mixes in, and nothing else.

ManiSkill 3.0.1 refuses `num_envs > 1` on a CPU. Here one `PhysxCpuSystem` per environment stands
behind the buffers and calls of `PhysxGpuSystem`, so that ManiSkill's batched structs, partial
resets and contact queries run unchanged. Delete this package and the mixin's name in the task's
bases when ManiSkill learns to do it itself.

    mixin.py     when a task runs batched on the CPU, and how its BaseEnv is led there
    scene.py     the ManiSkill scene over all environments; numbers ManiSkill's structs
    system.py    the stand-in for PhysxGpuSystem: fetch, apply, contact queries
    group.py     the only code that touches SAPIEN objects: environments of one process
    workers.py   a group whose physics runs in a forked process
    arrays.py    the buffers, in memory that forked processes share
    contacts.py  contact impulses from one pass over the contact lists
"""

from maniskill_taskgrasp.tasks.cpu_batch.mixin import CpuBatchMixin

__all__ = ["CpuBatchMixin"]
