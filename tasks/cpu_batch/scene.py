"""Sub-scenes at offsets inside shared CPU systems, and the ManiSkill scene over them."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.utils.structs import Actor, Articulation, ArticulationJoint, Link
from mani_skill.utils.structs.base import BaseStruct
from sapien import physx

from maniskill_taskgrasp.tasks.cpu_batch.system import BatchedCpuSystem

ENVS_PER_SYSTEM = 16  # Fewer pay a fixed cost per step, more outgrow the cache (docs/cpu_batch.md).
_patching = threading.RLock()


class OffsetScene(sapien.Scene):
    """One environment's scene; everything added to it is moved by `offset` [m]."""

    def __init__(self, system: physx.PhysxCpuSystem, offset: Sequence[float]):
        super().__init__([system])
        self.offset = np.array(offset, dtype=np.float32)

    def add_entity(self, entity: sapien.Entity) -> None:
        """Add an entity whose pose is given in the environment's own frame."""
        entity.pose = self.shifted(entity.pose)
        super().add_entity(entity)

    def create_drive(self, body0: Any, pose0: sapien.Pose, body1: Any, pose1: sapien.Pose) -> Any:
        """Drive between two bodies; without `body0`, pose0 is in the environment's frame."""
        pose0 = self.shifted(pose0) if body0 is None else pose0
        return super().create_drive(body0, pose0, body1, pose1)

    def shifted(self, pose: sapien.Pose) -> sapien.Pose:
        """The pose as the shared system sees it."""
        return sapien.Pose(pose.p + self.offset, pose.q)


def build_scenes(
    num_envs: int, spacing: float, envs_per_system: int = ENVS_PER_SYSTEM
) -> tuple[list[physx.PhysxCpuSystem], list[OffsetScene]]:
    """Systems of at most `envs_per_system` scenes, each on its own square grid about the origin.

    Args:
        spacing: [m] between neighbours. Small coordinates keep float32 rounding small, hence one
            grid per system.
    """
    systems: list[physx.PhysxCpuSystem] = []
    scenes = []
    side = int(np.ceil(np.sqrt(min(num_envs, envs_per_system))))
    for env in range(num_envs):
        place = env % envs_per_system
        if place == 0:
            systems.append(physx.PhysxCpuSystem())
        x, y = place % side - side // 2, place // side - side // 2
        scenes.append(OffsetScene(systems[-1], [x * spacing, y * spacing, 0.0]))
    return systems, scenes


class BatchedCpuScene(ManiSkillScene):
    """ManiSkill's scene with the batched CPU system in the place of the GPU's."""

    def __init__(
        self,
        systems: Sequence[physx.PhysxCpuSystem],
        scenes: Sequence[OffsetScene],
        **kwargs: Any,
    ):
        super().__init__(list(scenes), **kwargs)
        self.px = BatchedCpuSystem(systems, scenes)
        self.gpu_sim_enabled = True
        self._waiting: list[BaseStruct] = []  # Structs built before the buffers exist.

    def _setup(self, enable_gpu: bool) -> None:
        self._copy_planes()
        self.px.gpu_init()
        for struct in self._waiting:
            self._number(struct)
        self._waiting.clear()
        super()._setup(enable_gpu)

    def adopt(self, struct: BaseStruct) -> None:
        """Give a struct its rows in the buffers, now or as soon as they are known."""
        if self.px.ready:
            self._number(struct)
        else:
            self._waiting.append(struct)

    def _number(self, struct: BaseStruct) -> None:
        """Do for a struct what `gpu_pose_index` and `gpu_index` do on the GPU."""
        layout = self.px.layout
        if isinstance(struct, Link) or (
            isinstance(struct, Actor) and struct.px_body_type != "static"
        ):
            rows = [layout.row_of[body.entity.global_id] for body in struct._bodies]
            struct._body_data_index_internal = torch.tensor(rows)
            if isinstance(struct, Link) and not all(body.is_root for body in struct._bodies):
                struct._body_data_name = "moving_link_data"
        elif isinstance(struct, Articulation | ArticulationJoint):
            owners = (
                struct._objs if isinstance(struct, Articulation) else struct._physx_articulations
            )
            rows = [layout.articulation_row_of[a.root.entity.global_id] for a in owners]
            struct._data_index = torch.tensor(rows, dtype=torch.int32)

    def _copy_planes(self) -> None:
        """Give every system each plane: ManiSkill builds one for all environments."""
        system_of = {id(scene): id(scene.physx_system) for scene in self.sub_scenes}
        for actor in self.actors.values():
            if actor.px_body_type != "static":
                continue
            owners = [system_of[id(entity.scene)] for entity in actor._objs]
            planes = [
                (owner, shape)
                for owner, body in zip(owners, actor._bodies, strict=True)
                for shape in body.collision_shapes
                if isinstance(shape, physx.PhysxCollisionShapePlane)
            ]
            provided = {owner for owner, _ in planes}
            for owner, body in zip(owners, actor._bodies, strict=True):
                if planes and owner not in provided:
                    provided.add(owner)
                    for _, plane in planes:
                        body.attach(_copy_plane(plane))


def _copy_plane(plane: physx.PhysxCollisionShapePlane) -> physx.PhysxCollisionShapePlane:
    copy = physx.PhysxCollisionShapePlane(material=plane.physical_material)
    copy.local_pose = plane.local_pose
    copy.set_collision_groups(plane.get_collision_groups())
    return copy


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
