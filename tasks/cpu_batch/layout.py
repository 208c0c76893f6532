"""Where each body and articulation of the shared systems sits in the batched buffers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from sapien import physx

if TYPE_CHECKING:
    from maniskill_taskgrasp.tasks.cpu_batch.scene import OffsetScene

POSE_VELOCITY = 13  # position 3, quaternion wxyz 4, linear velocity 3, angular velocity 3.
# SAPIEN packs a body as quaternion, position, velocities; the GPU buffers put position first.
PACKED_TO_BUFFER = np.array([4, 5, 6, 0, 1, 2, 3, 7, 8, 9, 10, 11, 12])


class Layout:
    """Row numbers of the buffers and the places in SAPIEN's packed state that feed them.

    Rows of the body buffer: all rigid dynamic bodies, then all links, in the order in which the
    systems list them. Rows of the joint buffers: articulations in the order of their root links.

    Attributes:
        bodies: `num_dynamic` rigid dynamic components followed by the links.
        articulations: one per root link.
        body_env, articulation_env: (bodies,), (articulations,) environment each belongs to.
        offset: (bodies, 3) [m] where the environment of each body lies in its system.
        root_row: (articulations,) body row of each root link.
        dynamic_source: (num_dynamic, 13) index into the packed state, in buffer order.
        root_source: (articulations, 13) the same for root links.
        qpos_source, qvel_source, target_source, target_velocity_source: (articulations, max_dof)
            index into the packed state; `packed_size` (a slot kept at 0) pads shorter ones.
        packed_size: number of floats in the packed states of all systems.
    """

    def __init__(self, systems: Sequence[physx.PhysxCpuSystem], scenes: Sequence[OffsetScene]):
        dynamic: list[Any] = []
        links: list[Any] = []
        self.articulations: list[physx.PhysxArticulation] = []
        dynamic_starts: list[int] = []
        root_starts: list[int] = []
        start = 0
        for system in systems:
            for body in system.rigid_dynamic_components:
                dynamic.append(body)
                dynamic_starts.append(start)
                start += POSE_VELOCITY
            for link in system.articulation_link_components:
                links.append(link)
                if link.is_root:
                    self.articulations.append(link.articulation)
                    root_starts.append(start)
                    # Root state, qpos, qvel, then target and target velocity joint by joint.
                    start += POSE_VELOCITY + 4 * link.articulation.dof
        self.packed_size = start
        self.num_dynamic = len(dynamic)
        self.bodies = dynamic + links
        self.row_of = {body.entity.global_id: row for row, body in enumerate(self.bodies)}
        self.articulation_row_of = {
            articulation.root.entity.global_id: row
            for row, articulation in enumerate(self.articulations)
        }
        env_of_scene = {scene.id: env for env, scene in enumerate(scenes)}
        self.body_env = np.array([env_of_scene[b.entity.scene.id] for b in self.bodies], dtype=int)
        self.offset = np.array([scene.offset for scene in scenes], dtype=np.float32)[self.body_env]
        self.root_row = np.array(
            [self.row_of[a.root.entity.global_id] for a in self.articulations], dtype=int
        )
        self.articulation_env = self.body_env[self.root_row]
        self.dynamic_source = _starts(dynamic_starts) + PACKED_TO_BUFFER
        self.root_source = _starts(root_starts) + PACKED_TO_BUFFER
        self._place_joints(_starts(root_starts) + POSE_VELOCITY)

    def _place_joints(self, starts: np.ndarray) -> None:
        dofs = np.array([a.dof for a in self.articulations], dtype=int)[:, None]
        self.dof = dofs[:, 0]
        self.max_dof = int(dofs.max(initial=0))
        joint = np.arange(self.max_dof)

        def padded(source: np.ndarray) -> np.ndarray:
            return np.where(joint < dofs, source, self.packed_size)

        self.qpos_source = padded(starts + joint)
        self.qvel_source = padded(starts + dofs + joint)
        self.target_source = padded(starts + 2 * dofs + 2 * joint)
        self.target_velocity_source = padded(starts + 2 * dofs + 2 * joint + 1)


def entity_rows(layout: Layout, scenes: Sequence[OffsetScene]) -> np.ndarray:
    """(links,) place of each link's entity in the concatenated `pack_poses` of the scenes."""
    place: dict[int, int] = {}
    for scene in scenes:
        for entity in scene.entities:
            place[entity.global_id] = len(place)
    links = layout.bodies[layout.num_dynamic :]
    return np.array([place[link.entity.global_id] for link in links], dtype=int)


def _starts(starts: list[int]) -> np.ndarray:
    return np.array(starts, dtype=int).reshape(-1, 1)
