"""Turns palm key poses into a joint path of the arm: batched damped least squares at reset."""

from __future__ import annotations

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.controllers.palm_motion import joint_step
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.rotations import pose_error, quat_to_matrix
from maniskill_taskgrasp.episode import PHASE_STEPS
from maniskill_taskgrasp.tasks.pregrasp import PalmPath

SEED_ITERATIONS = 60
TRACK_ITERATIONS = 4
MAX_STEP = 0.3  # [rad] largest joint change of one iteration.
POSITION_TOLERANCE = 1e-3  # [m]
ROTATION_TOLERANCE = 1e-2  # [rad]
TRACK_POINTS = 8  # Cartesian points a straight segment is followed through.

SEEDS = (
    (-0.233, -0.432, -0.065, 1.483, -0.294, -1.084, 0.376),
    (-0.388, -0.374, 0.053, 1.434, -0.421, -1.080, 1.901),
    (-0.437, -0.787, 0.311, 1.536, -0.080, 0.084, -0.050),
    (-0.301, -0.753, 0.150, 1.126, -0.117, 1.206, 0.018),
)
"""[rad] palm down, sideways, tilted and fingers down at 0.75 to 0.85 m (fact sheet, 1.5)."""


class ArmIK:
    """Inverse kinematics of an arm that stands at a fixed place, for a batch of palm poses."""

    def __init__(
        self,
        kinematics: ArticulationKinematics,
        arm_indices: Tensor,
        palm_link: str,
        qlimits: Tensor,
        root_pose: Tensor,
    ) -> None:
        """
        Args:
            kinematics: of the whole robot.
            arm_indices: (num_arm,) columns of the arm's joints in a full posture.
            palm_link: link whose pose is asked for.
            qlimits: (num_arm, 2) [rad].
            root_pose: (7,) [m, wxyz] of the robot's root link.
        """
        self._kinematics = kinematics
        self._arm = arm_indices
        self._palm_link = palm_link
        self._qlimits = qlimits
        self._root_position = root_pose[:3]
        self._root_rotation = quat_to_matrix(root_pose[3:])

    def path(self, palm: PalmPath) -> tuple[Tensor, Tensor]:
        """Joint path of a whole episode.

        Returns:
            (n, MAX_EPISODE_STEPS, num_arm) [rad] waypoints, one a control step, and
            (n,) bool whether the arm reaches all of it.
        """
        grasp, _ = self._best_seed(palm.grasp, palm.rotation)
        up, up_ok = self._follow(grasp, palm.grasp, palm.hover, palm.rotation)
        lift, lift_ok = self._follow(grasp, palm.grasp, palm.lift, palm.rotation)
        descend = up.flip(1)
        hover_steps, descend_steps, close_steps, lift_steps, hold_steps = PHASE_STEPS
        pieces = [
            descend[:, :1].expand(-1, hover_steps, -1),
            resample(descend, descend_steps),
            grasp[:, None].expand(-1, close_steps, -1),
            resample(lift, lift_steps),
            lift[:, -1:].expand(-1, hold_steps, -1),
        ]
        return torch.cat(pieces, 1), up_ok & lift_ok

    def _best_seed(self, position: Tensor, rotation: Tensor) -> tuple[Tensor, Tensor]:
        """Solution nearest the middle of the joint ranges among those of all seeds."""
        n = len(position)
        seeds = torch.tensor(SEEDS, dtype=position.dtype, device=position.device)
        qpos = seeds.repeat_interleave(n, 0)
        many = len(SEEDS)
        qpos, ok = self._solve(
            qpos, position.repeat(many, 1), rotation.repeat(many, 1, 1), SEED_ITERATIONS
        )
        middle = self._qlimits.mean(1)
        cost = ((qpos - middle) ** 2).sum(1) + 1e3 * ~ok
        best = cost.view(many, n).argmin(0)
        pick = best * n + torch.arange(n, device=best.device)
        return qpos[pick], ok[pick]

    def _follow(
        self, qpos: Tensor, start: Tensor, end: Tensor, rotation: Tensor
    ) -> tuple[Tensor, Tensor]:
        """(n, TRACK_POINTS + 1, num_arm) postures along a straight line, and whether all reach."""
        postures, reached = [qpos], torch.ones(len(qpos), dtype=torch.bool, device=qpos.device)
        for i in range(1, TRACK_POINTS + 1):
            target = torch.lerp(start, end, i / TRACK_POINTS)
            qpos, ok = self._solve(qpos, target, rotation, TRACK_ITERATIONS)
            postures.append(qpos)
            reached &= ok
        return torch.stack(postures, 1), reached

    def _solve(
        self, qpos: Tensor, position: Tensor, rotation: Tensor, iterations: int
    ) -> tuple[Tensor, Tensor]:
        position = (position - self._root_position) @ self._root_rotation
        rotation = self._root_rotation.T @ rotation
        for _ in range(iterations):
            pose, jacobian = self._palm(qpos)
            step = joint_step(jacobian, pose_error(pose, position, rotation))
            qpos = qpos + step.clamp(-MAX_STEP, MAX_STEP)
            qpos = qpos.clamp(self._qlimits[:, 0], self._qlimits[:, 1])
        error = pose_error(self._palm(qpos)[0], position, rotation)
        ok = (error[:, :3].norm(dim=1) <= POSITION_TOLERANCE) & (
            error[:, 3:].norm(dim=1) <= ROTATION_TOLERANCE
        )
        return qpos, ok

    def _palm(self, qpos: Tensor) -> tuple[Tensor, Tensor]:
        """The palm's pose (n, 4, 4) and its Jacobian (n, 6, num_arm), base frame."""
        full = qpos.new_zeros(len(qpos), self._kinematics.dof)
        full[:, self._arm] = qpos
        pose, jacobian = self._kinematics.pose_and_jacobian(full, self._palm_link)
        return pose, jacobian[:, :, self._arm]


def resample(path: Tensor, steps: int) -> Tensor:
    """Postures along a path at `steps` instants of a smooth start and stop.

    Args:
        path: (n, points, joints) [rad]; the first point is where the arm stands already.

    Returns:
        (n, steps, joints) [rad], ending at the last point.
    """
    time = torch.arange(1, steps + 1, device=path.device, dtype=path.dtype) / steps
    place = time * time * (3 - 2 * time) * (path.shape[1] - 1)  # Smoothstep: no jerk at the ends.
    left = place.floor().long().clamp(max=path.shape[1] - 2)
    share = (place - left)[None, :, None]
    return path[:, left] * (1 - share) + path[:, left + 1] * share
