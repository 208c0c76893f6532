"""Runs episodes of many objects and topologies side by side, and keeps what became of each."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.episode import HELD_STEPS, MAX_EPISODE_STEPS
from maniskill_taskgrasp.tasks.grasp_library import Grasp
from maniskill_taskgrasp.tasks.noise import resolve_noise
from maniskill_taskgrasp.tasks.rollout import reset_options
from maniskill_taskgrasp.topology import Topology

Array = NDArray[Any]
EVALUATION = 2  # Stream of seeds; training's streams are 0 and 1 (train/environments.py).
SEED_LIMIT = 2**31
DIGITS = tuple(part for part in PARTS if part != "palm")
"""Parts whose tips leave a trajectory."""


@dataclass(frozen=True)
class Job:
    """An object to be grasped in a topology."""

    topology: Topology
    source: str
    """Library name or mesh file."""
    name: str
    """Decides, with topology and text, the seeds of the episodes."""
    text: str = ""
    grasp: Grasp | None = None
    """Used in place of the planner's."""


@dataclass(frozen=True)
class Conditions:
    """What all jobs of an evaluation share."""

    episodes: int
    noise: str
    presentation: str
    seed: int
    num_envs: int
    make_policy: Callable[[Any], Callable[[Tensor], Tensor]]
    env_kwargs: dict[str, Any]


@dataclass(frozen=True)
class Trace:
    """One episode, step by step; world frame."""

    seed: int
    tips: Array
    """(steps, digits, 3) [m] origin of each last link, in the order of `DIGITS`."""
    obj: Array
    """(steps, 7) [m, wxyz] object pose."""
    forces: Array
    """(steps, parts) [N] in the order of `PARTS`."""


@dataclass
class Episodes:
    """Outcomes of one job, in the order of their seeds."""

    lifted: list[bool] = field(default_factory=list)
    in_form: list[bool] = field(default_factory=list)
    """Contacts at the end were those of the topology's name."""
    failure: list[int] = field(default_factory=list)
    """Index into `outcome.FAILURES`."""
    lift_m: list[float] = field(default_factory=list)
    force_n: list[float] = field(default_factory=list)
    """[N] force of the whole hand on the object, mean over the last half second."""
    success: Trace | None = None
    """First episode that lifted the object in the named topology."""
    miss: Trace | None = None
    """First episode that did not lift it."""

    def __len__(self) -> int:
        return len(self.lifted)


def episode_seeds(seed: int, job: Job, count: int) -> list[int]:
    """Seeds of a job's episodes: the same for every policy, batch size and set of other jobs."""
    key = zlib.crc32("|".join((job.topology.slug, job.name, job.text)).encode())
    words = np.random.SeedSequence((seed % SEED_LIMIT, EVALUATION, key)).generate_state(count)
    return [int(word) for word in words % SEED_LIMIT]


def jobs_at_once(jobs: int, episodes: int, num_envs: int) -> int:
    """How many jobs share a scene, so that building and simulating them all is cheapest.

    A scene's jobs get the same number of environments each. Building a scene costs about as much
    as a round of episodes in it.
    """

    def cost(size: int) -> int:
        envs = min(episodes, num_envs // size)
        return math.ceil(jobs / size) * size * envs * (1 + math.ceil(episodes / envs))

    return min(range(1, min(jobs, num_envs) + 1), key=lambda size: (cost(size), size))


def run_jobs(jobs: Sequence[Job], conditions: Conditions) -> list[Episodes]:
    """All episodes of some jobs in one scene.

    Args:
        jobs: at most as many as there are environments.

    Raises:
        InputError: an object, a noise or a presentation that does not exist.
    """
    each = min(conditions.episodes, max(1, conditions.num_envs // len(jobs)))
    rounds = math.ceil(conditions.episodes / each)
    seeds = np.array([episode_seeds(conditions.seed, job, rounds * each) for job in jobs])
    spread = [job for job in jobs for _ in range(each)]
    redraw = resolve_noise(conditions.noise).draws_scene  # Then each episode needs a new scene.
    env: Any = gym.make(
        "TaskGrasp-v0",
        num_envs=len(spread),
        objects=[job.source for job in spread],
        topology=[job.topology.name for job in spread],
        noise=conditions.noise,
        presentation=conditions.presentation,
        reward_mode="none",
        **conditions.env_kwargs,
    )
    results = [Episodes() for _ in jobs]
    try:
        for number in range(rounds):
            columns = slice(number * each, (number + 1) * each)
            options = {"reconfigure": redraw or len(spread) == 1, **_grasp_options(spread)}
            recorder = _episode(env, conditions, seeds[:, columns].ravel().tolist(), options)
            for row, result in enumerate(results):
                count = min(each, conditions.episodes - number * each)
                recorder.add_to(result, range(row * each, row * each + count))
    finally:
        env.close()
    return results


def _grasp_options(jobs: Sequence[Job]) -> dict[str, Any]:
    grasps = [job.grasp for job in jobs if job.grasp is not None]
    assert len(grasps) in (0, len(jobs))
    return reset_options(grasps) if grasps else {}


@torch.no_grad()
def _episode(
    env: Any, conditions: Conditions, seeds: list[int], options: dict[str, Any]
) -> _Recorder:
    """One episode in every environment, to the end of the clock."""
    obs, _ = env.reset(seed=seeds, options=options)
    policy = conditions.make_policy(env)
    recorder = _Recorder(env.unwrapped, seeds)
    for _ in range(MAX_EPISODE_STEPS):
        obs, _, _, _, info = env.step(policy(obs))
        recorder.record(info)
    return recorder


class _Recorder:
    """Everything that is kept of a round, environment by environment."""

    def __init__(self, env: Any, seeds: list[int]) -> None:
        self._env = env
        self._seeds = seeds
        links, hand = env.agent.robot.links_map, env.agent.hand
        self._tips = [links[hand.tip_links[digit]] for digit in DIGITS]
        self._steps: list[tuple[Array, Array, Array]] = []
        self._info: dict[str, Any] = {}

    def record(self, info: dict[str, Any]) -> None:
        """Take in one control step."""
        tips = torch.stack([link.pose.p for link in self._tips], 1)
        step = (tips, self._env.obj.pose.raw_pose, info["part_forces"])
        self._steps.append(tuple(value.cpu().numpy().copy() for value in step))
        self._info = info

    def add_to(self, episodes: Episodes, envs: range) -> None:
        """Append the outcomes of some environments."""
        names = ("success", "fidelity", "failure")
        lifted, form, failure = (self._info[name].tolist() for name in names)
        lift = self._env.outcome.max_lift.tolist()
        held = np.stack([forces.sum(1) for _, _, forces in self._steps[-HELD_STEPS:]]).mean(0)
        for env in envs:
            episodes.lifted.append(lifted[env])
            episodes.in_form.append(form[env])
            episodes.failure.append(failure[env])
            episodes.lift_m.append(lift[env])
            episodes.force_n.append(float(held[env]))
            if lifted[env] and form[env] and episodes.success is None:
                episodes.success = self._trace(env)
            if not lifted[env] and episodes.miss is None:
                episodes.miss = self._trace(env)

    def _trace(self, env: int) -> Trace:
        tips, obj, forces = (np.stack([step[i][env] for step in self._steps]) for i in range(3))
        return Trace(self._seeds[env], tips, obj, forces)
