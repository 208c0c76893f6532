"""Where the object really stands: an estimate from the distances that the hovering hand senses.

Six distances are nearly linear in the object's offset (x, y, yaw) and can be solved for it (facts:
grasping, section 7). Everything here is batched and knows nominal data and distances alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from mani_skill.utils.geometry.rotation_conversions import matrix_to_quaternion
from torch import Tensor

from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.rotations import quat_multiply, quat_to_matrix, yaw_quat
from maniskill_taskgrasp.agents.sawyer_ar10.agent import SawyerAR10
from maniskill_taskgrasp.episode import CLOSE_START
from maniskill_taskgrasp.tasks.noise import NOISES
from maniskill_taskgrasp.tasks.placement import Placement
from maniskill_taskgrasp.tasks.sensing import HandBoxes, ObjectSurfaces, part_distances
from maniskill_taskgrasp.tasks.surface import surface_of

STEP = (0.005, 0.005, 0.08)
"""[m, m, rad] of the central differences."""
ERRORS = {"exact": 0.0015, "noisy": 0.0045}
"""[m] standard deviation of a distance on each track; exact ones are off the linear model."""
_WIDEST = NOISES["blind"]
PRIOR_STD = tuple(w / math.sqrt(3) for w in (_WIDEST.position, _WIDEST.position, _WIDEST.yaw))
"""[m, m, rad] of the offset's uniform draws."""


@dataclass(frozen=True)
class OffsetModel:
    """Linear model of n hovering hands: distances from the object's offset, and back."""

    nominal: Tensor
    """(n, num_parts) [m] distances where nothing is off."""
    jacobian: Tensor
    """(n, num_parts, 3) change of the distances with the object's (x, y, yaw)."""
    gain: Tensor
    """(n, 3, num_parts) posterior mean of the offset for each metre of distance."""
    hover: Tensor
    """(n, 3) [m] palm's origin at hover, from the vertical about which the object is turned."""
    grasp: Tensor
    """(n, 3) [m] the same once the palm is in place."""

    @classmethod
    def blind(cls, n: int, num_parts: int, device: torch.device) -> OffsetModel:
        """Models that never see an offset."""
        return cls(
            torch.zeros(n, num_parts, device=device),
            torch.zeros(n, num_parts, 3, device=device),
            torch.zeros(n, 3, num_parts, device=device),
            torch.zeros(n, 3, device=device),
            torch.zeros(n, 3, device=device),
        )

    def put(self, env_idx: Tensor, models: OffsetModel) -> None:
        """Overwrite the models of environments (m,) with m others."""
        for mine, new in zip(vars(self).values(), vars(models).values(), strict=True):
            mine[env_idx] = new

    def gaps(self, distances: Tensor, residual: Tensor) -> Tensor:
        """How far distances are from nominal, had the palm stayed on its path.

        Args:
            distances: (n, num_parts) [m] now.
            residual: (n, 3) [m, m, rad] how far the palm stands off its path already.

        Returns:
            (n, num_parts) [m]
        """
        x, y, yaw = residual.unbind(1)
        # The palm's displacement looks like the opposite displacement of the object.
        moved = torch.stack([x + yaw * self.hover[:, 1], y - yaw * self.hover[:, 0], yaw], 1)
        return distances - self.nominal + (self.jacobian @ moved[..., None])[..., 0]

    def shift(self, gaps: Tensor) -> Tensor:
        """Palm displacement that restores the planned grasp.

        Args:
            gaps: (n, num_parts) [m] from `gaps`.

        Returns:
            (n, 3) [m, m, rad] x, y and yaw about the palm's own origin.
        """
        return following((self.gain @ gaps[..., None])[..., 0], self.grasp)


def following(offset: Tensor, palm: Tensor) -> Tensor:
    """Palm displacement that follows an object which was moved and turned.

    Args:
        offset: (n, 3) [m, m, rad] of the object, turned about a vertical.
        palm: (n, 3) [m] palm's origin from that vertical.

    Returns:
        (n, 3) [m, m, rad] x, y and yaw about the palm's own origin.
    """
    x, y = palm[:, 0], palm[:, 1]
    cos, sin = offset[:, 2].cos(), offset[:, 2].sin()
    carried = torch.stack([cos * x - sin * y - x, sin * x + cos * y - y], 1)
    return torch.cat([offset[:, :2] + carried, offset[:, 2:]], 1)


class HoverSense:
    """Makes the offset models of planned grasps for one robot."""

    def __init__(
        self, agent: SawyerAR10, boxes: HandBoxes, links: Sequence[str], root: Tensor, error: float
    ) -> None:
        """
        Args:
            boxes: the hand's boxes, numbered by `links`.
            root: (7,) [m, wxyz] of the robot's root link.
            error: [m] standard deviation of a distance.
        """
        self._agent = agent
        self._kinematics = ArticulationKinematics.of(agent.robot)
        self._links = [self._kinematics.link_index(name) for name in links]
        self._palm = self._kinematics.link_index(agent.hand.palm_frame)
        self._boxes = boxes
        self._root = torch.eye(4, device=root.device)
        self._root[:3, :3], self._root[:3, 3] = quat_to_matrix(root[3:]), root[:3]
        self._error = error

    def __call__(
        self, path: Tensor, preshape: Tensor, placements: Sequence[Placement]
    ) -> OffsetModel:
        """Models of n plans.

        Args:
            path: (n, num_steps, num_arm) [rad] arm waypoints, hover first.
            preshape: (n, num_actuators) [rad].
            placements: of the n objects; nominal.
        """
        device = path.device
        hover = self._link_matrices(path[:, 0], preshape)
        grasp = self._link_matrices(path[:, CLOSE_START - 1], preshape)
        links = hover[:, self._links]
        poses = torch.cat([links[..., :3, 3], matrix_to_quaternion(links[..., :3, :3])], -1)
        surfaces = ObjectSurfaces.of([surface_of(p.model) for p in placements], device)
        centre = torch.tensor(np.stack([p.centre for p in placements])).float().to(device)
        rows = [np.concatenate([p.position, p.quat_wxyz]) for p in placements]
        obj = torch.tensor(np.stack(rows)).float().to(device)

        def sensed(offset: Tensor) -> Tensor:
            moved = displaced(obj, centre, offset.expand(len(obj), 3))
            return part_distances(poses, self._boxes, surfaces, moved)

        steps = torch.tensor(STEP, device=device)
        changes = [sensed(step) - sensed(-step) for step in torch.diag(steps)]
        jacobian = torch.stack(changes, 2) / (2 * steps)
        return OffsetModel(
            nominal=sensed(torch.zeros_like(steps)),
            jacobian=jacobian,
            gain=posterior_gain(jacobian, self._error),
            hover=hover[:, self._palm, :3, 3] - centre,
            grasp=grasp[:, self._palm, :3, 3] - centre,
        )

    def _link_matrices(self, arm: Tensor, hand: Tensor) -> Tensor:
        """(n, num_links, 4, 4) world poses of all links."""
        qpos = self._agent.full_qpos(arm.cpu().numpy(), hand.cpu().numpy())
        return self._root @ self._kinematics.link_matrices(torch.from_numpy(qpos).to(arm.device))


def displaced(pose: Tensor, centre: Tensor, offset: Tensor) -> Tensor:
    """Poses moved and turned about a vertical.

    Args:
        pose: (n, 7) [m, wxyz].
        centre: (n, 3) [m] point of the vertical.
        offset: (n, 3) [m, m, rad] x, y and yaw.
    """
    turn = yaw_quat(offset[:, 2])
    arm = (pose[:, :3] - centre)[..., None]
    moved = centre + (quat_to_matrix(turn) @ arm)[..., 0]
    moved = moved + torch.nn.functional.pad(offset[:, :2], (0, 1))
    return torch.cat([moved, quat_multiply(turn, pose[:, 3:])], 1)


def posterior_gain(jacobian: Tensor, error: float) -> Tensor:
    """Gain of the offset's posterior mean under Gaussian prior and error (ridge regression).

    Args:
        jacobian: (n, num_parts, 3).
        error: [m] standard deviation of a distance.

    Returns:
        (n, 3, num_parts)
    """
    prior = torch.diag(torch.tensor(PRIOR_STD, dtype=jacobian.dtype, device=jacobian.device) ** 2)
    spread = jacobian @ prior @ jacobian.transpose(1, 2)
    spread = spread + error**2 * torch.eye(spread.shape[1], device=spread.device)
    return torch.linalg.solve(spread, jacobian @ prior).transpose(1, 2)
