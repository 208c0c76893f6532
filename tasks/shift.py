"""How far the palm must move to stand to the object as planned, by what the hand has sensed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.episode import HOVER, MAX_EPISODE_STEPS, PHASE_ENDS
from maniskill_taskgrasp.tasks.offset import FEELS, LOOKS, OffsetFilter, displaced, following
from maniskill_taskgrasp.tasks.senses import Reading

DISTANCE_ERROR = (0.003, 0.005)  # [m] size of the error that "noisy" draws once an episode.


class ShiftEstimate:
    """Per-environment estimate; every field is (num_envs, ...)."""

    def __init__(self, num_envs: int, track: str, device: torch.device) -> None:
        """
        Args:
            track: one of `arguments.DISTANCES`: what is known of the distances.
        """
        self._track = track
        error = sum(DISTANCE_ERROR) / 2 if track == "noisy" else 0.0
        self.filter = OffsetFilter(num_envs, len(PARTS), error, device)
        self.shift = torch.zeros(num_envs, 3, device=device)
        """[m, m, rad] x, y and yaw."""
        self.hover_shift = torch.zeros(num_envs, 3, device=device)
        """[m, m, rad] the same as it was known when the hover ended."""
        self.palm = torch.zeros(num_envs, 3, device=device)
        """[m] where the palm closes, by plan, from the vertical that objects turn about."""
        self.distance_error = torch.zeros(num_envs, len(PARTS), device=device)
        """[m]"""
        self._due = torch.zeros(MAX_EPISODE_STEPS + 1, dtype=torch.bool, device=device)
        self._due[list(FEELS if track == "none" else LOOKS)] = True

    def reset(self, env_idx: Tensor, palm: Tensor, draws: NDArray[np.float64]) -> None:
        """Start new episodes.

        Args:
            env_idx: (n,) environments.
            palm: (n, 3) [m] of their plans.
            draws: (n, 2, num_parts) uniform in [-1, 1]: size and sign of the distances' errors.
        """
        self.filter.reset(env_idx)
        self.palm[env_idx] = palm
        self.shift[env_idx] = 0.0
        self.hover_shift[env_idx] = 0.0
        low, high = DISTANCE_ERROR
        size = low + (high - low) * np.abs(draws[:, 0])
        self.distance_error[env_idx] = torch.tensor(
            np.sign(draws[:, 1]) * size, dtype=torch.float32, device=self.palm.device
        )

    def sensed(self, distances: Tensor) -> Tensor:
        """(num_envs, num_parts) [m] true distances as the chosen track knows them."""
        if self._track == "none":
            return torch.zeros_like(distances)
        if self._track == "noisy":
            return (distances + self.distance_error).clamp(min=0)
        return distances

    def update(
        self,
        step: Tensor,
        reading: Reading,
        nominal_pose: Tensor,
        imagining: Callable[[Tensor, Tensor], Callable[[Tensor], Tensor]],
    ) -> None:
        """Take in what is felt, in the environments where it is time to.

        Args:
            step: (num_envs,) control steps taken before this one.
            nominal_pose: (num_envs, 7) [m, wxyz] of the objects, as planned with.
            imagining: `HandSenses.imagining`.
        """
        rows = self._due[step.clamp(max=MAX_EPISODE_STEPS).long()].nonzero()[:, 0]
        if not len(rows):
            return
        nominal, distances = nominal_pose[rows, None], imagining(rows, reading.link_frames[rows])

        def expected(offset: Tensor) -> Tensor:
            return distances(displaced(nominal, torch.zeros_like(offset), offset))

        if self._track == "none":
            self.filter.feel(rows, reading.forces[rows], expected)
        else:
            self.filter.look(rows, self.sensed(reading.distances)[rows], expected)
        shift = following(self.filter.mean[rows, :3], self.palm[rows])
        self.shift[rows] = shift
        hovering = (step[rows] < PHASE_ENDS[HOVER])[:, None]
        self.hover_shift[rows] = torch.where(hovering, shift, self.hover_shift[rows])
