"""Records successful demonstrations of the scripted solution in ManiSkill's trajectory format.

python train/demonstrations.py
python train/demonstrations.py --topology "power palm abd 2-5" --objects hammer --count 10
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import gymnasium as gym
from mani_skill.utils.wrappers.record import RecordEpisode
from tqdm import tqdm

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.pipeline import SEED_LIMIT
from maniskill_taskgrasp.tasks.arguments import resolve_objects
from maniskill_taskgrasp.tasks.closing import ConstantClosing
from maniskill_taskgrasp.train.script import run_script

TRIES = 20  # Episodes for each demonstration asked for, after which something must be wrong.
SOURCE = "constant closing along the topology's synergy; the arm follows the planned path"


@dataclass(frozen=True, kw_only=True)
class DemonstrationConfig:
    """Record the scripted solution; episodes that fail are left out."""

    count: int = 100
    """Demonstrations to record."""
    topology: str = "precision pad abd 2-3"
    """How to grasp."""
    objects: tuple[str, ...] = ("train",)
    """train, test, all, or names; each episode draws one of them."""
    noise: str = "paper"
    """How far the object is from where the planner thinks: none, paper, hard or blind."""
    obs_mode: Literal["state", "state_dict", "none"] = "state"
    """What is recorded as observation; "none" keeps states and actions only."""
    seed: int = 0
    """Seed of the first episode; the next ones count on."""
    out: Path = Path("demos/TaskGrasp-v0/scripted")
    """Folder for trajectory.h5 and trajectory.json."""

    def __post_init__(self) -> None:
        if self.count < 1:
            raise InputError(f"--count must be 1 or more, got {self.count}")
        if not 0 <= self.seed < SEED_LIMIT - TRIES * self.count:
            raise InputError(f"--seed must be from 0 to below 2**32, got {self.seed}")
        for name in resolve_objects(_one_or_list(self.objects)):
            library.load(name)


def record(config: DemonstrationConfig) -> dict[str, Any]:
    """Record, and say what was recorded.

    Raises:
        InputError: something does not exist, or too few episodes succeed.
    """
    env = RecordEpisode(
        gym.make(
            "TaskGrasp-v0",
            topology=config.topology,
            objects=_one_or_list(config.objects),
            noise=config.noise,
            obs_mode=config.obs_mode,
        ),
        str(config.out),
        trajectory_name="trajectory",
        save_video=False,
        save_on_reset=False,
        source_type="scripted",
        source_desc=SOURCE,
    )
    policy, recorded, episodes = ConstantClosing(env), 0, 0
    with tqdm(total=config.count, file=sys.stderr, unit="demo") as progress:
        while recorded < config.count and episodes < TRIES * config.count:
            if _succeeds(env, policy, config.seed + episodes):
                env.flush_trajectory()
                recorded += 1
                progress.update()
            else:
                env.flush_trajectory(save=False)
            episodes += 1
    env.close()
    if recorded < config.count:
        raise InputError(
            f"only {recorded} of {episodes} episodes succeeded: see `taskgrasp evaluate`"
        )
    return {
        "trajectory": str(config.out / "trajectory.h5"),
        "demonstrations": recorded,
        "episodes": episodes,
    }


def _one_or_list(objects: tuple[str, ...]) -> str | list[str]:
    return objects[0] if len(objects) == 1 else list(objects)


def _succeeds(env: gym.Env, policy: ConstantClosing, seed: int) -> bool:
    """Run one episode with an object of its own."""
    obs, _ = env.reset(seed=seed, options={"reconfigure": True})
    while True:
        obs, _, terminated, truncated, info = env.step(policy(obs))
        if bool(terminated) or bool(truncated):
            return bool(info["success"])


if __name__ == "__main__":
    run_script(lambda config: print(json.dumps(record(config))), DemonstrationConfig, __doc__)
