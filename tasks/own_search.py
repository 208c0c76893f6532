"""Searches a grasp on the very object that is to be grasped, within a stated budget of trials."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.folders import cache_folder
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.assets.objects.store import part_to_json, write_atomically
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks.cross_entropy import SearchSpace, cross_entropy
from maniskill_taskgrasp.tasks.fingerprint import code_fingerprint
from maniskill_taskgrasp.tasks.grasp_library import Grasp, nearest_grasps
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
from maniskill_taskgrasp.topology import Topology

Array = NDArray[np.float64]

STARTS = 8  # Stored grasps, the rule among them, that are tried before the search.
GOOD_START = 0.5  # Share of trials in lift and form from which a search stays near its start.
NEAR, WIDE = 0.4, 1.0  # Spread of the first generation around a good and a poor start.
ACTED = ("pregrasp", "preshape", "closing")  # What of a grasp the environment is given.
SEED_STEP = 7919  # Between the seeds of batches, which no evaluation's seeds follow.


@dataclass(frozen=True, kw_only=True)
class SearchBudget:
    """How much simulation a search on one object may use."""

    generations: int
    """Generations of the cross-entropy search; at least 1."""
    num_envs: int = 64
    """Trials in each batch."""
    noise: str = "paper"
    seed: int = 0

    def __post_init__(self) -> None:
        if self.generations < 1:
            raise InputError(f"a search needs at least 1 generation, got {self.generations}")

    @property
    def trials(self) -> int:
        """Simulated grasps on the object: starts, generations, and the choice at the end."""
        return self.num_envs * (self.generations + 2)


@dataclass(frozen=True)
class FoundGrasp:
    """A grasp that was searched on the object itself, and what that took."""

    grasp: Grasp
    """Its lift and both are shares of fresh trials, after the search."""
    start: str
    """Train object whose stored grasp the search started from; "rule" for the bounding box."""
    spent: int
    """Simulated grasps of this search."""
    cached: bool = False
    """Whether an earlier run had searched already."""

    @property
    def note(self) -> str:
        """One line for a person."""
        when = "by an earlier run" if self.cached else "now"
        return (
            f"the grasp was searched on this very object ({self.spent} simulated trials, {when}), "
            f"from {self.start!r}"
        )

    def summary(self) -> dict[str, Any]:
        """What a result says about the search."""
        return {
            "trials": self.spent,
            "start": self.start,
            "lift": self.grasp.lift,
            "both": self.grasp.both,
            "cached": self.cached,
            "grasp": {name: getattr(self.grasp, name) for name in ACTED},
        }


def find_grasp(obj: str, topology: Topology, presentation: str, budget: SearchBudget) -> FoundGrasp:
    """The best grasp within the budget, from the cache where the same search was made before.

    Raises:
        InputError: unknown object, presentation or noise.
    """
    path = _cache_path(library.load(obj), topology, presentation, budget)
    if path.is_file():
        data = json.loads(path.read_text("utf-8"))
        fields: dict[str, Any] = data.pop("grasp")
        frozen: dict[str, Any] = {
            name: tuple(v) if isinstance(v, list) else v for name, v in fields.items()
        }
        return FoundGrasp(Grasp(**frozen), **data, cached=True)
    found = search(obj, topology, presentation, budget)
    data = asdict(found)
    del data["cached"]
    write_atomically(path, json.dumps(data).encode())
    return found


def search(obj: str, topology: Topology, presentation: str, budget: SearchBudget) -> FoundGrasp:
    """Try stored grasps and the rule, refine the best, keep what wins in fresh trials."""
    trials = GraspTrials(obj, topology, presentation, budget.noise, budget.num_envs)
    try:
        return _search(trials, topology, budget)
    finally:
        trials.close()


def _search(trials: GraspTrials, topology: Topology, budget: SearchBudget) -> FoundGrasp:
    placement = trials.env.placements[0]
    posture = PostureSpace.of(AR10, topology)
    batch = 0

    def run(candidates: Array) -> tuple[Array, Array, Array]:
        nonlocal batch
        batch += 1
        shapes = posture.expand(candidates[:, 6:])
        whole = batch in (1, budget.generations + 2)
        seed = budget.seed + SEED_STEP * batch
        return trials.run(candidates[:, :6], *shapes, seed, whole=whole)

    stored = nearest_grasps(topology.slug, placement, STARTS - 1)
    names = [grasp.obj for grasp in stored] + ["rule"]
    rule = trials.env.planner.bounding_box(topology.slug, placement).numpy()
    starts = [_numbers(grasp, posture) for grasp in stored]
    starts.append(np.concatenate([rule, posture.start()]))
    row = np.arange(budget.num_envs) % len(starts)
    _, both, score = run(np.array(starts)[row])
    means = [float(score[row == i].mean()) for i in range(len(starts))]
    first = int(np.argmax(means))
    spread = NEAR if both[row == first].mean() >= GOOD_START else WIDE
    refined, _ = cross_entropy(
        lambda candidates: run(candidates)[2],
        starts[first],
        _space(posture, spread),
        np.random.default_rng(budget.seed),
        population=budget.num_envs,
        generations=budget.generations,
    )
    finals = np.array([starts[first], refined])
    row = np.arange(budget.num_envs) % 2
    lifted, both, _ = run(finals[row])
    shares = [(float(both[row == i].mean()), float(lifted[row == i].mean())) for i in (0, 1)]
    best = 1 if shares[1] >= shares[0] else 0
    preshape, closing = posture.expand(finals[best : best + 1, 6:])
    grasp = Grasp(
        topology=topology.slug,
        obj=placement.model.name,
        presentation=placement.presentation.kind,
        extents=tuple(np.round(placement.extents, 5).tolist()),
        height=round(float(placement.centre[2]), 5),
        pregrasp=tuple(finals[best, :6].tolist()),
        preshape=tuple(preshape[0].tolist()),
        closing=tuple(closing[0].tolist()),
        lift=shares[best][1],
        both=shares[best][0],
        trials=budget.num_envs // 2,
    )
    return FoundGrasp(grasp, names[first], budget.trials)


def _numbers(grasp: Grasp, posture: PostureSpace) -> Array:
    """(14,) the numbers that are searched, of a stored grasp."""
    shape = posture.compress(np.array(grasp.preshape), np.array(grasp.closing))
    return np.concatenate([grasp.pregrasp, shape])


def _space(posture: PostureSpace, spread: float) -> SearchSpace:
    return SearchSpace(
        lower=np.concatenate([PREGRASP_LOWER, posture.lower]),
        upper=np.concatenate([PREGRASP_UPPER, posture.upper]),
        spread=spread * np.concatenate([PREGRASP_SPREAD, POSTURE_SPREAD]),
        floor=np.concatenate([PREGRASP_FLOOR, POSTURE_FLOOR]),
    )


def _cache_path(
    model: ObjectModel, topology: Topology, presentation: str, budget: SearchBudget
) -> Path:
    """File of a search; its name changes with anything that could change the result."""
    body = {
        "parts": [part_to_json(part) for part in model.parts],
        "mass": model.mass_kg,
        "friction": model.friction,
        "presentation": presentation,
        "budget": asdict(budget),
        "code": code_fingerprint(),
    }
    digest = hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()[:16]
    name = "".join(c if c.isalnum() else "_" for c in model.name)
    return cache_folder() / "searches" / f"{topology.slug}--{name}--{digest}.json"
