"""Batched forward kinematics and Jacobians in torch, read from a loaded SAPIEN articulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import torch
from torch import Tensor

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


class ArticulationKinematics:
    """Link poses and Jacobians of one articulation for a batch of postures.

    SAPIEN joints turn about (or slide along) their frame's x axis:
    child = parent * pose_in_parent * motion(q) * pose_in_child^-1. Links of one depth in the tree
    are computed together, so the number of torch calls grows with the depth only.
    """

    def __init__(
        self,
        articulation: object,
        link_names: Sequence[str] | None = None,
        joint_names: Sequence[str] | None = None,
        device: torch.device | str = "cpu",
    ) -> None:
        """
        Args:
            articulation: a `sapien.physx.PhysxArticulation`.
            link_names: what to call its links, in its own order; its own names if None.
            joint_names: what to call its active joints, in its own order.
            device: where the results live.
        """
        links = articulation.links  # type: ignore[attr-defined]
        self.link_names = list(link_names or (link.name for link in links))
        self._index = {name: i for i, name in enumerate(self.link_names)}
        self.dof = len(articulation.active_joints)  # type: ignore[attr-defined]
        self.device = torch.device(device)
        active = {j.name: i for i, j in enumerate(articulation.active_joints)}  # type: ignore[attr-defined]
        place = {id_of(link): i for i, link in enumerate(links)}
        self._parent = [
            place[id_of(link.joint.parent_link)] if link.joint.parent_link is not None else -1
            for link in links
        ]
        self._columns = dict(zip(joint_names or active, active.values(), strict=True))
        self._column = [active.get(link.joint.name, -1) for link in links]
        self._kind = [_KINDS[link.joint.type] for link in links]
        before = np.stack([link.joint.pose_in_parent.to_transformation_matrix() for link in links])
        after = np.stack(
            [link.joint.pose_in_child.inv().to_transformation_matrix() for link in links]
        )
        self._before = torch.tensor(before, dtype=torch.float32, device=self.device)
        self._after = torch.tensor(after, dtype=torch.float32, device=self.device)
        self._levels = self._by_depth()

    @classmethod
    def of(cls, robot: Articulation) -> ArticulationKinematics:
        """Kinematics of a ManiSkill articulation, with its link names, on its device."""
        links = [link.name for link in robot.links]
        joints = [joint.name for joint in robot.active_joints]
        return cls(robot._objs[0], links, joints, robot.device)

    def link_index(self, link: str) -> int:
        """Place of a link in every result."""
        return self._index[link]

    def column(self, joint: str) -> int:
        """Place of an active joint in a posture."""
        return self._columns[joint]

    def _by_depth(self) -> list[tuple[Tensor, Tensor, Tensor, Tensor]]:
        """Links of each depth below the root with their parents, columns and joint kinds."""
        depth = [0] * len(self._parent)
        for i, parent in enumerate(self._parent):  # SAPIEN lists parents before children.
            depth[i] = 0 if parent < 0 else depth[parent] + 1
        levels = []
        for level in range(1, max(depth) + 1):
            members = [i for i, d in enumerate(depth) if d == level]
            fields = (
                members,
                [self._parent[i] for i in members],
                [max(self._column[i], 0) for i in members],
                [self._kind[i] for i in members],
            )
            levels.append(tuple(torch.tensor(f, device=self.device) for f in fields))
        return levels  # type: ignore[return-value]

    def link_matrices(self, qpos: Tensor) -> Tensor:
        """Poses of all links in the root link's frame.

        Args:
            qpos: (n, dof) [rad, m] in the order of the articulation's active joints.

        Returns:
            (n, num_links, 4, 4) homogeneous transforms.
        """
        n = len(qpos)
        world = torch.empty(n, len(self.link_names), 4, 4, dtype=qpos.dtype, device=self.device)
        world[:, self._parent.index(-1)] = torch.eye(4, device=self.device)
        before, after = self._before.to(qpos.dtype), self._after.to(qpos.dtype)
        for members, parents, columns, kinds in self._levels:
            motion = _motion(qpos[:, columns], kinds)
            world[:, members] = world[:, parents] @ before[members] @ motion @ after[members]
        return world

    def link_poses(self, qpos: Tensor, root_pose: Tensor | None = None) -> Tensor:
        """(n, num_links, 7) [m, wxyz] poses in the root link's frame, or in the world where the
        root link stands at `root_pose` (n, 7) or (7,)."""
        matrices = self.link_matrices(qpos)
        if root_pose is not None:
            matrices = pose_matrix(root_pose.expand(len(qpos), 7))[:, None] @ matrices
        return matrix_pose(matrices)

    def link_pose(self, qpos: Tensor, link: str) -> Tensor:
        """(n, 7) [m, wxyz] pose of one link in the root link's frame."""
        return matrix_pose(self.link_matrices(qpos)[:, self._index[link]])

    def jacobian(self, qpos: Tensor, link: str) -> Tensor:
        """(n, 6, dof) velocity of a link's origin (rows 0-2) and its turn (3-5), root frame."""
        return self.pose_and_jacobian(qpos, link)[1]

    def pose_and_jacobian(self, qpos: Tensor, link: str) -> tuple[Tensor, Tensor]:
        """`link_matrices` of that link, (n, 4, 4), and its `jacobian`, in one pass."""
        world = self.link_matrices(qpos)
        at = self._index[link]
        jacobian = qpos.new_zeros(len(qpos), 6, self.dof)
        chain, i = [], at
        while i >= 0:
            if self._column[i] >= 0:
                chain.append(i)
            i = self._parent[i]
        members = torch.tensor(chain, device=self.device)
        columns = [self._column[i] for i in chain]
        parents = torch.tensor([self._parent[i] for i in chain], device=self.device)
        frame = world[:, parents] @ self._before.to(qpos.dtype)[members]
        axis, origin = frame[..., :3, 0], frame[..., :3, 3]
        turning = torch.tensor([self._kind[i] == REVOLUTE for i in chain], device=self.device)
        arm = world[:, at, None, :3, 3] - origin
        linear = torch.where(turning[:, None], torch.linalg.cross(axis, arm), axis)
        angular = torch.where(turning[:, None], axis, torch.zeros_like(axis))
        jacobian[:, :3, columns] = linear.transpose(1, 2)
        jacobian[:, 3:, columns] = angular.transpose(1, 2)
        return world[:, at], jacobian


def id_of(link: object) -> int:
    """Identity of a SAPIEN link component; its Python wrapper is made anew at each access."""
    return link.entity.global_id  # type: ignore[attr-defined, no-any-return]


def _motion(q: Tensor, kinds: Tensor) -> Tensor:
    """(n, k, 4, 4) transform of joints of `kinds` (k,) at positions q (n, k) along their x."""
    turn = torch.where(kinds == REVOLUTE, q, torch.zeros_like(q))
    slide = torch.where(kinds == PRISMATIC, q, torch.zeros_like(q))
    motion = torch.zeros(*q.shape, 4, 4, dtype=q.dtype, device=q.device)
    cos, sin = turn.cos(), turn.sin()
    motion[..., 0, 0] = motion[..., 3, 3] = 1.0
    motion[..., 1, 1] = motion[..., 2, 2] = cos
    motion[..., 2, 1] = sin
    motion[..., 1, 2] = -sin
    motion[..., 0, 3] = slide
    return motion


def pose_matrix(pose: Tensor) -> Tensor:
    """(..., 4, 4) transform of a pose (..., 7) [m, wxyz]."""
    w, x, y, z = pose[..., 3:].unbind(-1)
    matrix = torch.zeros(*pose.shape[:-1], 4, 4, dtype=pose.dtype, device=pose.device)
    matrix[..., 0, 0] = 1 - 2 * (y * y + z * z)
    matrix[..., 0, 1] = 2 * (x * y - w * z)
    matrix[..., 0, 2] = 2 * (x * z + w * y)
    matrix[..., 1, 0] = 2 * (x * y + w * z)
    matrix[..., 1, 1] = 1 - 2 * (x * x + z * z)
    matrix[..., 1, 2] = 2 * (y * z - w * x)
    matrix[..., 2, 0] = 2 * (x * z - w * y)
    matrix[..., 2, 1] = 2 * (y * z + w * x)
    matrix[..., 2, 2] = 1 - 2 * (x * x + y * y)
    matrix[..., :3, 3] = pose[..., :3]
    matrix[..., 3, 3] = 1.0
    return matrix


def matrix_pose(matrix: Tensor) -> Tensor:
    """(..., 7) [m, wxyz] pose of a transform (..., 4, 4); the sign of w is not fixed."""
    m = matrix
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    # Column of the outer product q q^T with the largest diagonal: no division by a small number.
    rows = torch.stack(
        [
            torch.stack(
                [
                    1 + xx + yy + zz,
                    m[..., 2, 1] - m[..., 1, 2],
                    m[..., 0, 2] - m[..., 2, 0],
                    m[..., 1, 0] - m[..., 0, 1],
                ],
                -1,
            ),
            torch.stack(
                [
                    m[..., 2, 1] - m[..., 1, 2],
                    1 + xx - yy - zz,
                    m[..., 0, 1] + m[..., 1, 0],
                    m[..., 0, 2] + m[..., 2, 0],
                ],
                -1,
            ),
            torch.stack(
                [
                    m[..., 0, 2] - m[..., 2, 0],
                    m[..., 0, 1] + m[..., 1, 0],
                    1 - xx + yy - zz,
                    m[..., 1, 2] + m[..., 2, 1],
                ],
                -1,
            ),
            torch.stack(
                [
                    m[..., 1, 0] - m[..., 0, 1],
                    m[..., 0, 2] + m[..., 2, 0],
                    m[..., 1, 2] + m[..., 2, 1],
                    1 - xx - yy + zz,
                ],
                -1,
            ),
        ],
        -2,
    )
    best = rows.diagonal(dim1=-2, dim2=-1).argmax(-1)
    pick = best[..., None, None].expand(*best.shape, 1, 4)
    quat = rows.gather(-2, pick)[..., 0, :]
    return torch.cat([m[..., :3, 3], quat / quat.norm(dim=-1, keepdim=True)], -1)
