"""Which phase of the episode an environment is in."""

from __future__ import annotations

import torch
from torch import Tensor

from maniskill_taskgrasp.episode import PHASE_ENDS


def phase_at(step: Tensor) -> Tensor:
    """(num_envs,) long index into `episode.PHASES` at a control step (num_envs,)."""
    ends = torch.tensor(PHASE_ENDS[:-1], device=step.device)
    return torch.bucketize(step, ends, right=True)
