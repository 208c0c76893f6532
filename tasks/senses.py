"""Reads off the simulation what the hand feels: link poses, contacts, distances."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.utils.structs import Actor
from mani_skill.utils.structs.link import Link
from torch import Tensor

from maniskill_taskgrasp.agents.rotations import pose_to_frame
from maniskill_taskgrasp.tasks.contacts import LinkContacts
from maniskill_taskgrasp.tasks.sensing import (
    HandBoxes,
    ObjectSurfaces,
    part_distances,
    part_forces,
)


@dataclass(frozen=True)
class Reading:
    """What the hand feels at one instant, and where the object is."""

    touch: Tensor
    """(num_envs, num_links) [N] size of the force on each hand link."""

    local_forces: Tensor
    """(num_envs, num_links, 3) [N] force of the object on each hand link, link frame."""
    forces: Tensor
    """(num_envs, num_parts) [N]"""
    distances: Tensor
    """(num_envs, num_parts) [m]"""
    obj_pose: Tensor
    """(num_envs, 7) [m, wxyz] world."""
    link_frames: Tensor
    """(num_envs, num_links, 3, 4) rotation and position [m], world."""


class LinkPoses:
    """Poses of some links of every environment at once."""

    def __init__(self, scene: ManiSkillScene, links: Sequence[Link]) -> None:
        self._scene = scene
        self._entities = [link._objs[0].entity for link in links]
        if scene.gpu_sim_enabled:
            self._rows = torch.stack([link._body_data_index for link in links], 1).long()

    def __call__(self) -> Tensor:
        """(num_envs, num_links, 7) [m, wxyz] world."""
        scene = self._scene
        if scene.gpu_sim_enabled:
            batched = scene.px.cuda_rigid_body_data.torch()[self._rows, :7]
            if scene.parallel_in_single_scene:
                batched[..., :3] -= scene.scene_offsets[:, None]
            return batched
        # ManiSkill takes ten times as long to make a pose of each link.
        poses = np.empty((1, len(self._entities), 7), dtype=np.float32)
        for row, entity in zip(poses[0], self._entities, strict=True):
            pose = entity.pose
            row[:3], row[3:] = pose.p, pose.q
        return torch.from_numpy(poses)


class HandSenses:
    """Sensors of one hand on the object of every environment."""

    def __init__(
        self,
        scene: ManiSkillScene,
        links: list[Link],
        part_of_link: Tensor,
        obj: Actor,
        boxes: HandBoxes,
        surfaces: ObjectSurfaces,
    ) -> None:
        """
        Args:
            links: of the hand; every tensor over links follows this order.
            part_of_link: (num_links,) long index of the part that a link belongs to.
            boxes: the hand's boxes, numbered by the same links.
            surfaces: of the objects.
        """
        self._obj = obj
        self._boxes = boxes
        self._surfaces = surfaces
        self._part_of_link = part_of_link
        self._num_parts = len(boxes.link) // boxes.width
        self._poses = LinkPoses(scene, links)
        self._contacts = LinkContacts(scene, links, obj)

    def read(self, local_forces: Tensor | None = None) -> Reading:
        """What is felt now.

        Args:
            local_forces: (num_envs, num_links, 3) [N] link frame, in place of the contacts of the
                last physics step: those are void once an environment was put into another state.
        """
        frames, obj_pose = pose_to_frame(self._poses()), self._obj.pose.raw_pose
        rotation, obj_frame = frames[..., :3], pose_to_frame(obj_pose)[:, None]
        if local_forces is None:
            forces = self._contacts.forces()
            local_forces = (forces[..., None, :] @ rotation)[..., 0, :]
        else:
            forces = (rotation @ local_forces[..., None])[..., 0]
        return Reading(
            local_forces=local_forces,
            touch=torch.linalg.vector_norm(local_forces, dim=-1),
            forces=part_forces(forces, self._part_of_link, self._num_parts),
            distances=part_distances(frames, self._boxes, self._surfaces, obj_frame)[:, 0],
            obj_pose=obj_pose,
            link_frames=frames,
        )

    def imagining(self, rows: Tensor, link_frames: Tensor) -> Callable[[Tensor], Tensor]:
        """What distances would be if objects were elsewhere.

        Args:
            rows: (n,) environments, rising.
            link_frames: (n, num_links, 3, 4) world, of theirs.

        Returns:
            object poses (n, k, 7) [m, wxyz] world -> (n, k, num_parts) [m].
        """
        every = len(rows) == len(self._surfaces.centres)
        surfaces = self._surfaces if every else self._surfaces.rows(rows)
        return lambda poses: part_distances(
            link_frames, self._boxes, surfaces, pose_to_frame(poses)
        )
