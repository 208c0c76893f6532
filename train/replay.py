"""ManiSkill's replay_trajectory for recordings of our tasks, whose names it does not know.

python -m maniskill_taskgrasp.train.replay --traj-path demos/trajectory.h5 --use-env-states
"""

from __future__ import annotations

from mani_skill.trajectory.replay_trajectory import main, parse_args

import maniskill_taskgrasp  # noqa: F401  (Registers our tasks, in ManiSkill's helper processes too.)

if __name__ == "__main__":
    main(parse_args())
