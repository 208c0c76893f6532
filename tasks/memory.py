"""What the task remembers of the running episodes: what a saved state must hold beside bodies."""

from __future__ import annotations

import torch
from torch import Tensor

from maniskill_taskgrasp.tasks.outcome import Outcome
from maniskill_taskgrasp.tasks.shift import ShiftEstimate


class EpisodeMemory:
    """Per-environment record; every field is (num_envs, ...)."""

    def __init__(
        self, num_envs: int, num_links: int, num_actions: int, track: str, device: torch.device
    ) -> None:
        """
        Args:
            num_links: of the hand.
            num_actions: numbers in an action.
            track: one of `arguments.DISTANCES`.
        """
        self.topology_index = torch.zeros(num_envs, dtype=torch.long, device=device)
        self.pregrasp = torch.zeros(num_envs, 6, device=device)
        """`pregrasp.PREGRASP_FIELDS`"""
        self.true_shift = torch.zeros(num_envs, 3, device=device)
        """[m, m, rad] palm displacement that would have restored the plan at the start."""
        self.start_pos = torch.zeros(num_envs, 3, device=device)
        """[m] of the object."""
        self.last_action = torch.zeros(num_envs, num_actions, device=device)
        self.touch = torch.zeros(num_envs, num_links, 3, device=device)
        """[N] force of the object on each hand link at the last step, link frame."""
        self.estimate = ShiftEstimate(num_envs, track, device)
        self.outcome = Outcome(num_envs, num_links, device)

    def fields(self) -> dict[str, Tensor]:
        """Everything, by the names and in the order of a saved state."""
        estimate = self.estimate
        return {
            "topology_index": self.topology_index,
            "pregrasp": self.pregrasp,
            "shift": estimate.shift,
            "true_shift": self.true_shift,
            "start_pos": self.start_pos,
            "hover_shift": estimate.hover_shift,
            "palm": estimate.palm,
            "distance_error": estimate.distance_error,
            "last_action": self.last_action,
            "touch": self.touch,
            "offset_mean": estimate.filter.mean,
            "offset_covariance": estimate.filter.covariance,
            **vars(self.outcome),
        }
