"""The clock of an episode: how many control steps each phase takes, and what ends it."""

from __future__ import annotations

import torch
from torch import Tensor

CONTROL_FREQ = 20  # [Hz]
HOVER, DESCEND, CLOSE, LIFT, HOLD = range(5)
PHASES = ("hover", "descend", "close", "lift", "hold")
PHASE_STEPS = (8, 16, 30, 24, 14)
"""Control steps a phase. Hover leaves a policy time to move the palm before the descent (facts:
grasping, section 7, at least 6 steps); closing 1.2 rad at 1.1 rad/s takes 22 steps, the rest
builds up force; the lift is 0.25 m in 1.2 s; holding asks for 0.5 s."""
PHASE_ENDS = tuple(sum(PHASE_STEPS[: i + 1]) for i in range(len(PHASE_STEPS)))
MAX_EPISODE_STEPS = PHASE_ENDS[-1]
LIFT_START = PHASE_ENDS[CLOSE]
HELD_STEPS = 10
"""Control steps (0.5 s) for which the object must be held up to count as success."""


def phase_at(step: Tensor) -> Tensor:
    """(num_envs,) long phase (`PHASES`) at a control step (num_envs,)."""
    ends = torch.tensor(PHASE_ENDS[:-1], device=step.device)
    return torch.bucketize(step, ends, right=True)
