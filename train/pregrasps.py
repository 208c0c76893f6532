"""Search grasps on train objects and store them in assets/pregrasps.json; resumes where it was.

python train/pregrasps.py --per-topology 6
"""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import torch
from scipy.cluster.vq import kmeans2
from tqdm import tqdm

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.presentation import KINDS
from maniskill_taskgrasp.assets.objects.store import write_atomically
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.selection.feasibility import feasible
from maniskill_taskgrasp.tasks.closing import ConstantClosing, FollowRule
from maniskill_taskgrasp.tasks.grasp_library import Grasp, dump_grasps
from maniskill_taskgrasp.tasks.grasp_search import GraspSearch, SearchBudget, SearchResult
from maniskill_taskgrasp.tasks.placement import place
from maniskill_taskgrasp.tasks.pose_search import GraspTrials
from maniskill_taskgrasp.topology import TOPOLOGIES, Topology, resolve_topology
from maniskill_taskgrasp.train.batched_episodes import Conditions, Job, run_jobs
from maniskill_taskgrasp.train.script import run_script

ASSETS = Path(__file__).resolve().parent.parent / "assets"


@dataclass(frozen=True, kw_only=True)
class PregraspConfig:
    """Search grasps on train objects."""

    topologies: tuple[str, ...] = ()
    """Which topologies; all where it is left out."""
    objects: tuple[str, ...] = ()
    """Which train objects; left out, the most typical ones that suit the topology."""
    per_topology: int = 6
    """How many objects a topology, where they are not named."""
    presentation: str = "auto"
    num_envs: int = 64
    """Candidates a generation."""
    generations: int = 9
    """Most generations of a search."""
    first: int = 3
    """Batches in the first generation of a search that knows no good start."""
    processes: int = 2
    """Searches at a time."""
    noise: str = "paper"
    seed: int = 0
    follow: bool = True
    """Whether the palm follows the object by exact distances, as it does where grasps are used."""
    again: float = 0.0
    """Search once more for stored grasps that lift in form in less than this share of trials."""
    remeasure: bool = False
    """Search nothing: measure what the library holds again, in `remeasure_trials` fresh trials."""
    remeasure_trials: int = 32
    out: Path = ASSETS / "pregrasps.json"
    """Library to add to."""

    def __post_init__(self) -> None:
        test = set(library.names("test"))
        for name in self.objects:
            if name in test:
                raise InputError(f"{name!r} is a test object; grasps are searched on train objects")


def suitable(topology: Topology) -> tuple[list[str], list[str]]:
    """Train objects that the hand can hold so: those that people were seen to hold so, others."""
    human = {
        obj
        for (obj, _), counts in load_knowledge().pair_counts.items()
        if counts[topology.index] > 0
    }
    able = [
        name
        for name in library.names("train")
        if feasible(topology, library.load(name).affordance)[0]
    ]
    return [name for name in able if name in human], [n for n in able if n not in human]


def typical(names: list[str], count: int, topology: Topology) -> list[str]:
    """The most typical objects: nearest to the centres of `count` clusters of placed sizes."""
    if len(names) <= count or count < 1:
        return names[: max(count, 0)]
    placed = [place(library.load(name), topology=topology) for name in names]
    # Along the object (y) its size matters little; a stand of its own is a class of its own.
    scale = np.array([1.0, 0.25, 0.7])
    features = np.array(
        [[*(scale * np.log(p.extents)), float(KINDS.index(p.presentation.kind))] for p in placed]
    )
    centres, owner = kmeans2(features, count, minit="++", rng=np.random.default_rng(0))
    order = np.argsort(-np.bincount(owner, minlength=count), kind="stable")
    nearest = [int(np.linalg.norm(features - centres[i], axis=1).argmin()) for i in order]
    return [names[i] for i in dict.fromkeys(nearest)]


def pairs(config: PregraspConfig) -> Iterator[tuple[Topology, str]]:
    """Topology and object of each search, round robin, so that an early stop is fair."""
    wanted = [resolve_topology(name) for name in config.topologies] or list(TOPOLOGIES)
    lists = []
    for topology in wanted:
        names = list(config.objects)
        if not names:
            seen, others = suitable(topology)
            names = typical(seen, config.per_topology, topology)
            names += typical(others, config.per_topology - len(names), topology)
        lists.append([(topology, name) for name in names])
    for row in itertools.zip_longest(*lists):
        yield from (pair for pair in row if pair is not None)


def search(topology: Topology, obj: str, config: PregraspConfig, done: list[Grasp]) -> SearchResult:
    """Search one pair, starting from what was found for others."""
    trials = GraspTrials(
        obj,
        topology,
        config.presentation,
        config.noise,
        config.num_envs,
        processes=1,
        follow=config.follow,
    )
    budget = SearchBudget(
        generations=config.generations,
        first=config.first,
        num_envs=config.num_envs,
        noise=config.noise,
        seed=config.seed,
        follow=config.follow,
    )
    try:
        return GraspSearch(trials, topology, budget, done).run()
    finally:
        trials.close()


def main(config: PregraspConfig) -> None:
    torch.set_num_threads(1)  # Tensors are small: threads would wait for each other,
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # also in the processes that search.
    done: list[Grasp] = []
    if config.out.exists():
        done = [Grasp(**row) for row in json.loads(config.out.read_text("utf-8"))]
    if config.remeasure:
        write_atomically(config.out, dump_grasps(remeasured(done, config)).encode())
        return
    todo = _todo(config, done)
    # Spawned, not forked: a simulation that was built before a fork is no good after it.
    with ProcessPoolExecutor(config.processes, mp_context=get_context("spawn")) as pool:
        waiting: dict[Future[SearchResult], Topology] = {}
        bar = tqdm(total=len(todo), unit="search")
        while todo or waiting:
            while todo and len(waiting) < config.processes:
                topology, obj = todo.pop(0)
                waiting[pool.submit(search, topology, obj, config, done)] = topology
            for future in wait(waiting, return_when=FIRST_COMPLETED).done:
                topology, result = waiting.pop(future), future.result()
                done = _with(done, result.grasp)
                write_atomically(config.out, dump_grasps(done).encode())
                bar.update()
                bar.write(_line(topology, result))


def _todo(config: PregraspConfig, done: list[Grasp]) -> list[tuple[Topology, str]]:
    """What to search: stored pairs that are poor, then pairs that are not stored."""
    have = {(grasp.topology, grasp.obj) for grasp in done}
    poor = [(resolve_topology(g.topology), g.obj) for g in done if g.both < config.again]
    return poor + [(t, obj) for t, obj in pairs(config) if (t.slug, obj) not in have]


def _with(grasps: list[Grasp], found: Grasp) -> list[Grasp]:
    """The library with a grasp that was found, where it beats what was there for its pair."""
    rivals = [g for g in grasps if (g.topology, g.obj) == (found.topology, found.obj)]
    if any((g.both, g.lift) >= (found.both, found.lift) for g in rivals):
        return grasps
    return [g for g in grasps if g not in rivals] + [found]


def remeasured(grasps: list[Grasp], config: PregraspConfig) -> list[Grasp]:
    """The same grasps with what they do today."""
    conditions = Conditions(
        episodes=config.remeasure_trials,
        noise=config.noise,
        presentation=config.presentation,
        seed=config.seed,
        num_envs=2 * config.num_envs,
        make_policy=FollowRule if config.follow else ConstantClosing,
        env_kwargs={"control_mode": "pd_synergy_wrist"} if config.follow else {"obs": "paper"},
    )
    by_slug = {topology.slug: topology for topology in TOPOLOGIES}
    jobs = [Job(by_slug[g.topology], g.obj, g.obj, grasp=g) for g in grasps]
    size = max(1, conditions.num_envs // config.remeasure_trials)
    found = []
    for first in tqdm(range(0, len(jobs), size), unit="batch"):
        for grasp, episodes in zip(
            grasps[first : first + size],
            run_jobs(jobs[first : first + size], conditions),
            strict=True,
        ):
            held = np.logical_and(episodes.lifted, episodes.in_form)
            lift, both = (round(float(np.mean(x)), 4) for x in (episodes.lifted, held))
            found.append(replace(grasp, lift=lift, both=both, trials=len(episodes)))
    return found


def _line(topology: Topology, result: SearchResult) -> str:
    grasp = result.grasp
    return (
        f"{topology.name:22s} {grasp.obj:26s} {grasp.presentation:6s} lift {grasp.lift:.2f} "
        f"both {grasp.both:.2f}  {result.spent:4d} trials, from {result.start!r}"
    )


if __name__ == "__main__":
    run_script(main, PregraspConfig)
