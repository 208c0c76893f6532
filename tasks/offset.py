"""Where the object really stands: an iterated extended Kalman filter over what the hand senses.

The state is the object's offset from its nominal pose (x, y, yaw) and the constant error of each
part's distance. Distances before the closing, or touch during it, update it. All is batched, and
knows nominal data, link poses and sensed values alone (facts: grasping, section 7).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.rotations import quat_multiply, quat_to_matrix, yaw_quat
from maniskill_taskgrasp.episode import HOVER, LIFT_START, PHASE_ENDS
from maniskill_taskgrasp.tasks.noise import NOISES

STEP = (0.003, 0.003, 0.04)
"""[m, m, rad] of the central differences."""
_WIDEST = NOISES["blind"]
PRIOR_STD = tuple(w / math.sqrt(3) for w in (_WIDEST.position, _WIDEST.position, _WIDEST.yaw))
"""[m, m, rad] of the offset's uniform draws."""
MODEL_ERROR = 0.001  # [m] what distances of surfaces in patches are off, independent each time.
TOUCH_ERROR = 0.001  # [m] distance that a part may still have when its contact is felt.
TOUCH_FORCE = 0.05  # [N] contact that counts as felt.
PUSH_STD = (0.0015, 0.0015, 0.02)
"""[m, m, rad] by which a touched object may move between two updates."""
PASSES = 2  # Of an update: distances bend over the centimetres that the object may be off.
UNSEEN = 1.0  # [m] error of a distance that says nothing.
LIMIT = (0.03, 0.03, 0.35)
"""[m, m, rad] no offset is believed to be larger."""
LOOKS = (1, 4, PHASE_ENDS[HOVER] - 1, 10, 13, 16, 19)
"""Control steps at which distances are taken; the object is not touched before the last."""
FEELS = tuple(range(14, LIFT_START, 2))
"""Control steps at which touch is taken, from the middle of the descent on."""

Distances = Callable[[Tensor], Tensor]


class OffsetFilter:
    """Mean and covariance of every environment's offset and distance errors."""

    def __init__(self, num_envs: int, num_parts: int, error: float, device: torch.device) -> None:
        """
        Args:
            error: [m] standard deviation of a distance's constant error.
        """
        std = torch.tensor([*PRIOR_STD, *[error] * num_parts], device=device)
        self._prior = torch.diag(std.float() ** 2)
        self._limit = torch.tensor(LIMIT, device=device)
        self._push = torch.diag(torch.tensor([*PUSH_STD, *[0.0] * num_parts], device=device) ** 2)
        self.mean = torch.zeros(num_envs, 3 + num_parts, device=device)
        self.covariance = self._prior.expand(num_envs, -1, -1).clone()

    def reset(self, env_idx: Tensor) -> None:
        """Forget what some environments have sensed."""
        self.mean[env_idx] = 0.0
        self.covariance[env_idx] = self._prior

    def look(self, rows: Tensor, sensed: Tensor, expected: Distances) -> None:
        """Take in distances of some environments.

        Args:
            rows: (n,) environments.
            sensed: (n, num_parts) [m].
            expected: object offsets (n, k, 3) -> distances (n, k, num_parts) [m] now.
        """
        bias = torch.eye(sensed.shape[1], device=sensed.device)
        error = torch.full_like(sensed, MODEL_ERROR)
        self._update(rows, sensed, expected, bias, error)

    def feel(self, rows: Tensor, forces: Tensor, expected: Distances) -> None:
        """Take in which parts touch, (n, num_parts) [N]: their distance is zero."""
        touching = forces >= TOUCH_FORCE
        self.covariance[rows] = self.covariance[rows] + self._push
        bias = forces.new_zeros(forces.shape[1], forces.shape[1])
        error = torch.where(touching, TOUCH_ERROR, UNSEEN)
        self._update(rows, torch.zeros_like(forces), expected, bias, error)

    def _update(
        self, rows: Tensor, sensed: Tensor, expected: Distances, bias: Tensor, error: Tensor
    ) -> None:
        """Iterated Kalman update: linear about the mean, then once more about where that led.

        Args:
            bias: (num_parts, num_parts) how the constant errors enter what is sensed.
            error: (n, num_parts) [m] standard deviation of each value's own error.
        """
        prior, covariance = self.mean[rows], self.covariance[rows]
        mean = prior
        for _ in range(PASSES):
            at_mean, slope = _linear(expected, mean[:, :3])
            model = torch.cat([slope, bias.expand(len(rows), -1, -1)], 2)
            surprise = sensed - at_mean - (bias @ mean[:, 3:, None])[..., 0]
            surprise = surprise - (model @ (prior - mean)[..., None])[..., 0]
            spread = model @ covariance @ model.transpose(1, 2) + torch.diag_embed(error**2)
            gain = torch.linalg.solve(spread, model @ covariance).transpose(1, 2)
            mean = prior + (gain @ surprise[..., None])[..., 0]
            mean[:, :3] = torch.minimum(torch.maximum(mean[:, :3], -self._limit), self._limit)
        self.mean[rows] = mean
        self.covariance[rows] = covariance - gain @ model @ covariance


def _linear(expected: Distances, offset: Tensor) -> tuple[Tensor, Tensor]:
    """Distances (n, num_parts) [m] at offsets (n, 3), and how they change with them
    (n, num_parts, 3), by central differences."""
    steps = torch.diag(torch.tensor(STEP, device=offset.device))
    around = torch.cat([torch.zeros_like(steps[:1]), steps, -steps])
    at_offset, ahead, behind = expected(offset[:, None] + around).split([1, 3, 3], 1)
    slope = (ahead - behind) / (2 * steps.sum(1))[:, None]
    return at_offset[:, 0], slope.transpose(1, 2)


def displaced(pose: Tensor, centre: Tensor, offset: Tensor) -> Tensor:
    """Poses moved and turned about a vertical.

    Args:
        pose: (..., 7) [m, wxyz].
        centre: (..., 3) [m] point of the vertical.
        offset: (..., 3) [m, m, rad] x, y and yaw.
    """
    turn = yaw_quat(offset[..., 2])
    arm = (pose[..., :3] - centre)[..., None]
    moved = centre + (quat_to_matrix(turn) @ arm)[..., 0]
    moved = moved + torch.nn.functional.pad(offset[..., :2], (0, 1))
    return torch.cat([moved, quat_multiply(turn, pose[..., 3:])], -1)


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
