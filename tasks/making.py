"""What gymnasium calls to make the task: ManiSkill's own makers, bound to its name."""

from __future__ import annotations

from functools import partial

import mani_skill.envs  # noqa: F401  (Registers ManiSkill's own robots and tasks first.)
from mani_skill.utils.registration import make as _make
from mani_skill.utils.registration import make_vec as _make_vec

import maniskill_taskgrasp.tasks.task_grasp  # noqa: F401  (Enters ManiSkill's registry.)
from maniskill_taskgrasp import ENV_ID

make = partial(_make, env_id=ENV_ID)
make_vec = partial(_make_vec, env_id=ENV_ID)
