"""The ManiSkill scene over all environments, and the buffer rows of ManiSkill's structs."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import sapien
import torch
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.utils.building.actor_builder import ActorBuilder
from mani_skill.utils.structs import Actor, Articulation, ArticulationJoint, Link
from mani_skill.utils.structs.base import BaseStruct
from sapien import physx

from maniskill_taskgrasp.tasks.cpu_batch.system import BatchedCpuSystem

_patching = threading.RLock()


class BatchedCpuScene(ManiSkillScene):
    """ManiSkill's scene with the batched CPU system in the place of the GPU's."""

    def __init__(self, num_envs: int, processes: int, **kwargs: Any):
        scenes = [sapien.Scene([physx.PhysxCpuSystem()]) for _ in range(num_envs)]
        super().__init__(scenes, **kwargs)
        self.px = BatchedCpuSystem(self.sub_scenes, processes)
        self.gpu_sim_enabled = True
        self._waiting: list[BaseStruct] = []  # Structs built before the buffers exist.

    def create_actor_builder(self) -> ActorBuilder:
        """A builder that gives every environment its planes: on a GPU all would share one."""
        return super().create_actor_builder().set_allow_overlapping_plane_collisions(True)

    def _setup(self, enable_gpu: bool) -> None:
        self.px.gpu_init()
        for struct in self._waiting:
            self._number(struct)
        self._waiting.clear()
        # The first episode starts from a fresh system like all others; the reset that is under way
        # ends the rewriting.
        self.px.begin_rewrite(slice(None))
        super()._setup(enable_gpu)

    def adopt(self, struct: BaseStruct) -> None:
        """Give a struct its rows in the buffers, now or as soon as they are known."""
        if self.px.ready:
            self._number(struct)
        else:
            self._waiting.append(struct)

    def _number(self, struct: BaseStruct) -> None:
        """Do for a struct what `gpu_pose_index` and `gpu_index` do on the GPU."""
        if isinstance(struct, Link) or (
            isinstance(struct, Actor) and struct.px_body_type != "static"
        ):
            rows = [self.px.row_of[body.entity.global_id] for body in struct._bodies]
            struct._body_data_index_internal = torch.tensor(rows)
            if isinstance(struct, Link) and not all(body.is_root for body in struct._bodies):
                struct._body_data_name = "moving_link_data"
        elif isinstance(struct, Articulation | ArticulationJoint):
            is_whole = isinstance(struct, Articulation)
            owners = struct._objs if is_whole else struct._physx_articulations
            rows = [self.px.articulation_row_of[a.root.entity.global_id] for a in owners]
            struct._data_index = torch.tensor(rows, dtype=torch.int32)


@contextmanager
def adopting_structs() -> Iterator[None]:
    """While open, every ManiSkill struct built for a batched CPU scene is given its buffer rows.

    Merged actors and links are made anywhere in a task's code and are known to nobody, so the one
    place that sees them all is the struct's constructor; it is put back at the end.
    """
    with _patching:
        original = BaseStruct.__post_init__

        def post_init(struct: BaseStruct) -> None:
            original(struct)
            if isinstance(struct.scene, BatchedCpuScene):
                struct.scene.adopt(struct)

        BaseStruct.__post_init__ = post_init  # type: ignore[method-assign]
        try:
            yield
        finally:
            BaseStruct.__post_init__ = original  # type: ignore[method-assign]
