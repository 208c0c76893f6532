"""What a controller may know beside its senses: clock, topology, plan and nominal dimensions."""

from __future__ import annotations

import torch
from torch import Tensor

from maniskill_taskgrasp.episode import MAX_EPISODE_STEPS, PHASES
from maniskill_taskgrasp.tasks.phases import phase_at
from maniskill_taskgrasp.topology import TOPOLOGIES


class KnownFacts:
    """The part of the default observation that is no sensor's."""

    def __init__(self, extents: Tensor) -> None:
        """
        Args:
            extents: (num_envs, 3) [m] nominal dimensions of each environment's object.
        """
        self._extents = extents
        device = extents.device
        phases = phase_at(torch.arange(MAX_EPISODE_STEPS + 1, device=device))
        codes = torch.eye(len(PHASES), device=device)
        self._phase_of_step = codes[phases.clamp(max=len(PHASES) - 1)]
        self._topology_code = torch.eye(len(TOPOLOGIES), device=device)

    def __call__(
        self, step: Tensor, topology_index: Tensor, pregrasp: Tensor, shift: Tensor
    ) -> dict[str, Tensor]:
        """Named rows, each (num_envs, ...).

        Args:
            step: (num_envs,) control steps taken.
            topology_index: (num_envs,) into `TOPOLOGIES`.
            pregrasp: (num_envs, 6) of the plan.
            shift: (num_envs, 3) [m, m, rad] by which sensing puts the palm off its plan.
        """
        return {
            "phase": self._phase_of_step[step.clamp(max=MAX_EPISODE_STEPS).long()],
            "progress": (step / MAX_EPISODE_STEPS)[:, None],
            "topology": self._topology_code[topology_index],
            "extents": self._extents,
            "pregrasp": pregrasp,
            "shift": shift,
        }
