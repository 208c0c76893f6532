"""The clock of an episode: how many control steps each phase takes, and what ends it.

Apart from the task so that the environment can be registered without importing torch.
"""

from __future__ import annotations

CONTROL_FREQ = 20  # [Hz]
HOVER, DESCEND, CLOSE, LIFT, HOLD = range(5)
PHASES = ("hover", "descend", "close", "lift", "hold")
PHASE_STEPS = (8, 16, 30, 24, 14)
"""Control steps a phase. Hover leaves a policy time to move the palm before the descent (facts:
grasping, section 7, at least 6 steps); closing 1.2 rad at 1.1 rad/s takes 22 steps, the rest
builds up force; the lift is 0.26 m in 1.2 s; holding asks for 0.5 s."""
PHASE_ENDS = tuple(sum(PHASE_STEPS[: i + 1]) for i in range(len(PHASE_STEPS)))
CLOSE_START = PHASE_ENDS[DESCEND]
LIFT_START = PHASE_ENDS[CLOSE]
MAX_EPISODE_STEPS = PHASE_ENDS[HOLD]
HELD_STEPS = 10
"""Control steps (0.5 s) for which the object must be held up to count as success."""
