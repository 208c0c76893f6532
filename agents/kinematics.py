"""Batched forward kinematics and Jacobians in torch, of a loaded articulation or a description."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from maniskill_taskgrasp.agents.robot_model import Robot, rotation

if TYPE_CHECKING:
    from mani_skill.utils.structs import Articulation

FIXED, REVOLUTE, PRISMATIC = range(3)
_KINDS = {
    "fixed": FIXED,
    "undefined": FIXED,
    "revolute": REVOLUTE,
    "revolute_unwrapped": REVOLUTE,
    "prismatic": PRISMATIC,
}


@dataclass(frozen=True)
class Node:
    """A link and the joint that carries it: parent * before * motion(q) * after.

    The joint turns about, or slides along, the x axis that stands between `before` and `after`.
    """

    link: str
    parent: int
    """Place of the parent link, -1 for the root; parents come first."""
    kind: int
    column: int
    """Place of the joint in a posture, -1 where it does not move."""
    before: NDArray[np.float64]
    """(4, 4)"""
    after: NDArray[np.float64]
    """(4, 4)"""


@dataclass(frozen=True)
class _Chain:
    """Moving joints from the root to a link."""

    columns: Tensor
    """(k,) long places in a posture."""
    kinds: Tensor
    """(k,) long"""
    fixed: Tensor
    """(k, 4, 4) from one joint's motion to the next joint."""
    end: Tensor
    """(4, 4) from the last motion to the link."""


class ArticulationKinematics:
    """Link poses and Jacobians of one kinematic tree for a batch of postures.

    Links of one depth in the tree are computed together, so the number of torch calls grows with
    the depth only.
    """

    def __init__(
        self,
        nodes: Sequence[Node],
        joint_names: Sequence[str],
        device: torch.device | str = "cpu",
    ) -> None:
        """
        Args:
            nodes: links of the tree, the root first.
            joint_names: joints that move, in the order of a posture.
            device: where the results live.
        """
        self.device = torch.device(device)
        self.joint_names = tuple(joint_names)
        self.link_names = tuple(node.link for node in nodes)
        self._nodes = tuple(nodes)
        self._link_index = {link: i for i, link in enumerate(self.link_names)}
        self._column = {joint: i for i, joint in enumerate(self.joint_names)}
        self._kind = self._tensor([node.kind for node in nodes])
        self._before = self._tensor([node.before for node in nodes])
        self._after = self._tensor([node.after for node in nodes])
        self._levels = self._by_depth()
        self._chains: dict[str, _Chain] = {}

    @classmethod
    def of(cls, robot: Articulation) -> ArticulationKinematics:
        """Kinematics of a ManiSkill articulation, with its names and orders, on its device."""
        own: Any = robot._objs[0]
        columns = {joint.name: i for i, joint in enumerate(own.active_joints)}
        # SAPIEN wraps a component anew at each access; only its entity's number stays the same.
        place = {link.entity.global_id: i for i, link in enumerate(own.links)}
        nodes = [
            Node(
                link=name,
                parent=-1 if link.is_root else place[link.joint.parent_link.entity.global_id],
                kind=_KINDS[link.joint.type],
                column=columns.get(link.joint.name, -1),
                before=link.joint.pose_in_parent.to_transformation_matrix(),
                after=link.joint.pose_in_child.inv().to_transformation_matrix(),
            )
            for name, link in zip((link.name for link in robot.links), own.links, strict=True)
        ]
        return cls(nodes, [joint.name for joint in robot.active_joints], robot.device)

    @classmethod
    def of_description(cls, robot: Robot) -> ArticulationKinematics:
        """Kinematics of a robot that is described and not loaded; joints in the stated order."""
        place = {robot.root: 0}
        moving = [joint.name for joint in robot.joints if joint.type == "revolute"]
        nodes = [Node(robot.root, -1, FIXED, -1, np.eye(4), np.eye(4))]
        for joint in robot.joints:
            origin, turn = np.eye(4), np.eye(4)
            origin[:3, :3], origin[:3, 3] = rotation(joint.rpy), joint.xyz
            if joint.type == "revolute":
                turn[:3, :3] = _x_to(np.asarray(joint.axis))
            column = moving.index(joint.name) if joint.name in moving else -1
            parent = place[joint.parent]
            kind = _KINDS[joint.type]
            nodes.append(Node(joint.child, parent, kind, column, origin @ turn, turn.T))
            place[joint.child] = len(place)
        return cls(nodes, moving)

    @property
    def dof(self) -> int:
        """How many joints move."""
        return len(self.joint_names)

    def link_index(self, link: str) -> int:
        """Place of a link in `link_matrices`."""
        return self._link_index[link]

    def column(self, joint: str) -> int:
        """Place of a joint in a posture."""
        return self._column[joint]

    def _tensor(self, rows: Any) -> Tensor:
        values = np.asarray(rows)
        dtype = torch.float32 if values.dtype.kind == "f" else torch.long
        return torch.tensor(values, dtype=dtype, device=self.device)

    def _by_depth(self) -> list[tuple[Tensor, Tensor, Tensor]]:
        """Links of each depth below the root, their parents and their columns."""
        depth: list[int] = []
        for node in self._nodes:
            depth.append(0 if node.parent < 0 else depth[node.parent] + 1)
        levels = []
        for level in range(1, max(depth) + 1):
            members = [i for i, d in enumerate(depth) if d == level]
            parents = [self._nodes[i].parent for i in members]
            columns = [max(self._nodes[i].column, 0) for i in members]
            levels.append((self._tensor(members), self._tensor(parents), self._tensor(columns)))
        return levels

    def link_matrices(self, qpos: Tensor) -> Tensor:
        """Poses of all links in the root link's frame.

        Args:
            qpos: (n, dof) [rad, m] joints in the order of `joint_names`.

        Returns:
            (n, num_links, 4, 4) homogeneous transforms.
        """
        n = len(qpos)
        world = torch.empty(n, len(self.link_names), 4, 4, dtype=qpos.dtype, device=self.device)
        world[:, 0] = torch.eye(4, dtype=qpos.dtype, device=self.device)
        before, after = self._before.to(qpos.dtype), self._after.to(qpos.dtype)
        for members, parents, columns in self._levels:
            motion = _motion(qpos[:, columns], self._kind[members])
            world[:, members] = world[:, parents] @ before[members] @ motion @ after[members]
        return world

    def jacobian(self, qpos: Tensor, link: str) -> Tensor:
        """(n, 6, dof) velocity of a link's origin (rows 0-2) and its turn (3-5), root frame."""
        return self.pose_and_jacobian(qpos, link)[1]

    def pose_and_jacobian(self, qpos: Tensor, link: str) -> tuple[Tensor, Tensor]:
        """`link_matrices` of that link, (n, 4, 4), and its `jacobian`, from its own chain alone."""
        chain = self._chain(link)
        fixed, end = chain.fixed.to(qpos.dtype), chain.end.to(qpos.dtype)
        motion = _motion(qpos[:, chain.columns], chain.kinds)
        pose = torch.eye(4, dtype=qpos.dtype, device=self.device).expand(len(qpos), 4, 4)
        frames = []
        for i in range(len(fixed)):
            frames.append(pose @ fixed[i])
            pose = frames[-1] @ motion[:, i]
        pose = pose @ end
        frame = torch.stack(frames, 1)
        axis, origin = frame[..., :3, 0], frame[..., :3, 3]
        turns = (chain.kinds == REVOLUTE)[:, None]
        lever = torch.linalg.cross(axis, pose[:, None, :3, 3] - origin)
        jacobian = qpos.new_zeros(len(qpos), 6, self.dof)
        jacobian[:, :3, chain.columns] = torch.where(turns, lever, axis).transpose(1, 2)
        jacobian[:, 3:, chain.columns] = (axis * turns).transpose(1, 2)
        return pose, jacobian

    def _chain(self, link: str) -> _Chain:
        if link not in self._chains:
            fixed, since = [], np.eye(4)
            moving: list[Node] = []
            for node in self._from_root(link):
                since = since @ node.before
                if node.column >= 0:
                    fixed.append(since)
                    moving.append(node)
                    since = np.eye(4)
                since = since @ node.after
            self._chains[link] = _Chain(
                columns=self._tensor([node.column for node in moving]),
                kinds=self._tensor([node.kind for node in moving]),
                fixed=self._tensor(fixed),
                end=self._tensor(since),
            )
        return self._chains[link]

    def _from_root(self, link: str) -> list[Node]:
        path, i = [], self.link_index(link)
        while i >= 0:
            path.append(self._nodes[i])
            i = self._nodes[i].parent
        return path[::-1]


def _x_to(axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) rotation that turns x onto an axis (3,)."""
    axis = axis / np.linalg.norm(axis)
    helper = np.eye(3)[np.abs(axis).argmin()]
    second = np.cross(axis, helper)
    second /= np.linalg.norm(second)
    return np.stack([axis, second, np.cross(axis, second)], axis=1)


def _motion(q: Tensor, kinds: Tensor) -> Tensor:
    """(n, k, 4, 4) transform of joints of `kinds` (k,) at positions q (n, k) along their x."""
    turn, slide = q * (kinds == REVOLUTE), q * (kinds == PRISMATIC)
    motion = torch.zeros(*q.shape, 4, 4, dtype=q.dtype, device=q.device)
    cos, sin = turn.cos(), turn.sin()
    motion[..., 0, 0] = motion[..., 3, 3] = 1.0
    motion[..., 1, 1] = motion[..., 2, 2] = cos
    motion[..., 2, 1] = sin
    motion[..., 1, 2] = -sin
    motion[..., 0, 3] = slide
    return motion
