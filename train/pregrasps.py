"""Search grasps on train objects and store them in assets/pregrasps.json; resumes where it was.

python train/pregrasps.py --per-topology 6
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2

from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.presentation import KINDS
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.selection.feasibility import feasible
from maniskill_taskgrasp.tasks.cross_entropy import SearchSpace, cross_entropy
from maniskill_taskgrasp.tasks.grasp_library import Grasp, dump_grasps
from maniskill_taskgrasp.tasks.placement import place
from maniskill_taskgrasp.tasks.pose_search import (
    POSTURE_FLOOR,
    POSTURE_SPREAD,
    PREGRASP_FLOOR,
    PREGRASP_LOWER,
    PREGRASP_SPREAD,
    PREGRASP_UPPER,
    GraspTrials,
    PostureSpace,
)
from maniskill_taskgrasp.topology import TOPOLOGIES, Topology, resolve_topology

Array = NDArray[np.float64]
GOOD_START = 0.5  # Success in lift and form from which a grasp may start another search.
LOW = 0.04  # [m] lying objects lower than this want the fingertips below them.
SCOOP = np.array([0.0, -0.018, 0.0, 0.25, 0.0, 0.0])  # Palm lower and fingers down (facts, 3).
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
    first: int = 3
    """Populations in the first generation of a search that starts from the rule."""
    final: int = 2
    """Generations of them that run to the end of the clock."""
    noise: str = "paper"
    seed: int = 0
    out: Path = ASSETS / "pregrasps.json"
    """Library to add to."""

    def __post_init__(self) -> None:
        test = set(library.names("test"))
        for name in self.objects:
            if name in test:
                raise InputError(f"{name!r} is a test object; grasps are searched on train objects")


def suitable(topology: Topology) -> list[str]:
    """Train objects that the hand can hold so, and that people were seen to hold so."""
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
    return [name for name in able if name in human] or able


def typical(names: list[str], count: int, topology: Topology) -> list[str]:
    """The most typical objects: nearest to the centres of `count` clusters of placed sizes."""
    if len(names) <= count:
        return names
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
            names = typical(suitable(topology), config.per_topology, topology)
        lists.append([(topology, name) for name in names])
    for row in itertools.zip_longest(*lists):
        yield from (pair for pair in row if pair is not None)


def first_guess(
    trials: GraspTrials, topology: Topology, posture: PostureSpace, done: list[Grasp]
) -> tuple[Array, float, int]:
    """Where a search starts, its spread and the generations it may skip.

    A good grasp of the same topology on another object is a better start than the rule.
    """
    placement = trials.env.placements[0]
    known = [g for g in done if g.topology == topology.slug and g.both >= GOOD_START]
    if known:
        near = min(known, key=lambda grasp: grasp.mismatch(placement))
        numbers = posture.compress(np.array(near.preshape), np.array(near.closing))
        return np.concatenate([near.pregrasp, numbers]), 0.7, 2
    rule = trials.env.planner.bounding_box(topology.slug, placement).numpy()
    if placement.extents[2] < LOW:
        rule += SCOOP
    return np.concatenate([rule, posture.start()]), 1.0, 0


def search(topology: Topology, obj: str, config: PregraspConfig, done: list[Grasp]) -> Grasp:
    """Search one pair; the figures stored are of fresh trials."""
    trials = GraspTrials(obj, topology, config.presentation, config.noise, config.num_envs)
    placement = trials.env.placements[0]
    posture = PostureSpace.of(AR10, topology)
    start, spread, skipped = first_guess(trials, topology, posture, done)
    generations = config.generations - skipped
    space = SearchSpace(
        lower=np.concatenate([PREGRASP_LOWER, posture.lower]),
        upper=np.concatenate([PREGRASP_UPPER, posture.upper]),
        spread=spread * np.concatenate([PREGRASP_SPREAD, POSTURE_SPREAD]),
        floor=np.concatenate([PREGRASP_FLOOR, POSTURE_FLOOR]),
    )
    wide = 1 if skipped else config.first
    evaluations = generations + wide - 1
    generation = itertools.count()

    def score(candidates: Array) -> Array:
        number = next(generation)
        whole = number >= evaluations - config.final
        shapes = posture.expand(candidates[:, 6:])
        seed = config.seed + 1000 * (number + 1)
        return trials.run(candidates[:, :6], *shapes, seed, whole=whole)[2]

    best, _ = cross_entropy(
        score,
        start,
        space,
        np.random.default_rng(config.seed),
        population=config.num_envs,
        generations=generations,
        first=wide,
    )
    preshape, closing = posture.expand(np.tile(best[6:], (config.num_envs, 1)))
    lifted, both, _ = trials.run(
        np.tile(best[:6], (config.num_envs, 1)), preshape, closing, config.seed, whole=True
    )
    trials.close()
    return Grasp(
        topology=topology.slug,
        obj=obj,
        presentation=placement.presentation.kind,
        extents=tuple(np.round(placement.extents, 5).tolist()),
        height=round(float(placement.centre[2]), 5),
        pregrasp=tuple(np.round(best[:6], 5).tolist()),
        preshape=tuple(np.round(preshape[0], 4).tolist()),
        closing=tuple(np.round(closing[0], 4).tolist()),
        lift=round(float(lifted.mean()), 4),
        both=round(float(both.mean()), 4),
        trials=config.num_envs,
    )


def main(config: PregraspConfig) -> None:
    done: list[Grasp] = []
    if config.out.exists():
        done = [Grasp(**row) for row in json.loads(config.out.read_text("utf-8"))]
    have = {(grasp.topology, grasp.obj) for grasp in done}
    for topology, obj in pairs(config):
        if (topology.slug, obj) in have:
            continue
        grasp = search(topology, obj, config, done)
        print(
            f"{topology.name:24s} {obj:28s} {grasp.presentation:6s} "
            f"lift {grasp.lift:.2f} both {grasp.both:.2f}",
            flush=True,
        )
        done.append(grasp)
        partial = config.out.with_suffix(".partial")
        partial.write_text(dump_grasps(done), "utf-8")
        partial.replace(config.out)


if __name__ == "__main__":
    main(tyro.cli(PregraspConfig))
