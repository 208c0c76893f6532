"""Searches a grasp for one object: tries what is known, refines the best, checks the result."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks.cross_entropy import SearchSpace, cross_entropy
from maniskill_taskgrasp.tasks.grasp_library import Grasp, nearest_grasps
from maniskill_taskgrasp.tasks.pose_search import GraspTrials
from maniskill_taskgrasp.tasks.posture_space import (
    POSTURE_FLOOR,
    POSTURE_SPREAD,
    PREGRASP_FLOOR,
    PREGRASP_LOWER,
    PREGRASP_SPREAD,
    PREGRASP_UPPER,
    PostureSpace,
)
from maniskill_taskgrasp.topology import Topology

Array = NDArray[np.float64]

STARTS = 11  # Stored grasps that are tried first.
SCOOP = np.array([0.0, -0.018, 0.0, 0.25, 0.0, 0.0])  # Palm lower, fingers down: facts, 3.
GOOD_START = 0.5  # Share of trials in lift and form from which a search stays near its start.
GOOD_END = 0.8  # Share below which what came of a good start is not good enough.
NEAR, WIDE = 0.4, 1.0  # Spread of the first generation around a good and a poor start.
FINALISTS = 8  # Candidates that are tried again after a wide search.
RIVALS = 3  # Poor starts that share the first generation.
WIDE_SEARCHES = 3  # At most, each from other starts, until one comes to something.
PROVEN = 0.95  # Share of trials in lift and form at which a start needs no search.
HOPELESS = 2.5  # Score below which nothing was even lifted.
ENOUGH = 5.1  # Mean score of a generation of which nearly all lift in form.
SEED_STEP = 7919  # Between the seeds of batches, which no evaluation's seeds follow.


@dataclass(frozen=True, kw_only=True)
class SearchBudget:
    """How much simulation a search on one object may use."""

    generations: int
    """Most generations of the cross-entropy search; at least 1."""
    first: int = 2
    """Batches in the first generation, where no start is good."""
    num_envs: int = 64
    """Trials in each batch."""
    noise: str = "paper"
    seed: int = 0
    follow: bool = False
    """Whether the palm follows the object in the trials, as it will when the grasp is used."""

    def __post_init__(self) -> None:
        if self.generations < 1:
            raise InputError(f"a search needs at least 1 generation, got {self.generations}")

    @property
    def trials(self) -> int:
        """Most simulated grasps: starts, a check of the best, search about it, which of the two;
        then wide searches, with finalists, search about the winner, and a choice, each."""
        wide = self.generations + self.first + self.narrow + 1
        return self.num_envs * (self.narrow + 3 + WIDE_SEARCHES * wide)

    @property
    def narrow(self) -> int:
        """Most generations of the search about one good grasp."""
        return math.ceil(self.generations / 2)


@dataclass(frozen=True)
class SearchResult:
    """What a search found."""

    grasp: Grasp
    """Its lift and both are shares of fresh trials, after the search."""
    start: str
    """Train object whose stored grasp the search started from; "rule" for the bounding box."""
    spent: int
    """Simulated grasps of this search."""


class GraspSearch:
    """One search; every batch of trials has noise of its own."""

    def __init__(
        self,
        trials: GraspTrials,
        topology: Topology,
        budget: SearchBudget,
        known: Sequence[Grasp] | None = None,
    ) -> None:
        """
        Args:
            known: grasps to start from; by default those that are shipped.
        """
        self._trials = trials
        self._topology = topology
        self._budget = budget
        self._known = known
        self._placement = trials.env.placements[0]
        self._posture = PostureSpace.of(trials.env.agent.hand, topology)
        self._batches = 0

    def run(self) -> SearchResult:
        """Search until a grasp is proven or the budget is spent."""
        names, starts = self._starts()
        row = np.arange(self._budget.num_envs) % len(starts)
        _, both, score = self._try(starts[row], whole=True)
        order = np.argsort([-score[row == i].mean() for i in range(len(starts))], kind="stable")
        best = starts[order[0]]
        lifted, held, _ = self._try(np.tile(best, (self._budget.num_envs, 1)), whole=True)
        good = both[row == order[0]].mean() >= GOOD_START and held.mean() >= GOOD_START
        if good and held.mean() < PROVEN:
            best, lifted, held = self._better(best, self._narrow(best))
        for again in range(WIDE_SEARCHES):
            if held.mean() >= (GOOD_END if good or again else PROVEN):
                break
            rivals = starts[np.roll(order, -RIVALS * again)[:RIVALS]]
            centre = self._finalist(self._wide(rivals))
            best, lifted, held = self._better(best, self._narrow(centre))
        return SearchResult(
            self._grasp(best, lifted, held),
            names[order[0]],
            self._batches * self._budget.num_envs,
        )

    def _starts(self) -> tuple[list[str], Array]:
        """Names and numbers (k, 14) of what is tried first."""
        placement, topology = self._placement, self._topology
        stored = nearest_grasps(
            self._trials.env.agent.hand, topology, placement, STARTS, self._known
        )
        rule = self._trials.env.planner.bounding_box(topology.slug, placement).numpy()
        own = self._posture.start()
        rows = [self._numbers(grasp) for grasp in stored]
        rows += [np.concatenate([rule, own]), np.concatenate([rule + SCOOP, own])]
        limits = self._space(1.0)
        starts = np.clip(np.array(rows), limits.lower, limits.upper)
        return [grasp.obj for grasp in stored] + ["rule", "rule"], starts[: self._budget.num_envs]

    def _numbers(self, grasp: Grasp) -> Array:
        """(14,) the numbers that are searched, of a stored grasp."""
        shape = self._posture.compress(np.array(grasp.preshape), np.array(grasp.closing))
        return np.concatenate([grasp.pregrasp, shape])

    def _try(self, candidates: Array, *, whole: bool) -> tuple[Array, Array, Array]:
        """Lifted, lifted in form, and score of candidates (num_envs, 14)."""
        self._batches += 1
        shapes = self._posture.expand(candidates[:, 6:])
        seed = self._budget.seed + SEED_STEP * self._batches
        return self._trials.run(candidates[:, :6], *shapes, seed, whole=whole)

    def _rng(self) -> np.random.Generator:
        """Draws of their own for each search within this one."""
        return np.random.default_rng([self._budget.seed, self._batches])

    def _wide(self, starts: Array) -> Array:
        """(FINALISTS, 14) from several poor starts: where the search came to, the best it met."""
        mean, history = cross_entropy(
            lambda candidates: self._try(candidates, whole=False)[2],
            starts,
            self._space(WIDE),
            self._rng(),
            population=self._budget.num_envs,
            generations=self._budget.generations,
            first=self._budget.first,
            enough=ENOUGH,
            hopeless=HOPELESS,
        )
        order = np.argsort(-history[:, -1], kind="stable")[: FINALISTS - 1]
        return np.concatenate([mean[None], history[order, :-1]])

    def _finalist(self, finalists: Array) -> Array:
        """The best of some candidates in fresh trials of all the time there is.

        Between narrow basins the mean of good grasps is none, and one lucky trial proves nothing.
        """
        row = np.arange(self._budget.num_envs) % len(finalists)
        score = self._try(finalists[row], whole=True)[2]
        return finalists[np.argmax([score[row == i].mean() for i in range(len(finalists))])]

    def _narrow(self, centre: Array) -> Array:
        """Where a search about one grasp comes to."""
        return cross_entropy(
            lambda candidates: self._try(candidates, whole=True)[2],
            centre[None],
            self._space(NEAR),
            self._rng(),
            population=self._budget.num_envs,
            generations=self._budget.narrow,
            enough=ENOUGH,
        )[0]

    def _better(self, start: Array, refined: Array) -> tuple[Array, Array, Array]:
        """The better of two in fresh trials, half of them each: numbers, lifted, in form."""
        row = np.arange(self._budget.num_envs) % 2
        lifted, held, _ = self._try(np.array([start, refined])[row], whole=True)
        won = [(held[row == i].mean(), lifted[row == i].mean()) for i in (0, 1)]
        best = 1 if won[1] >= won[0] else 0
        return (start, refined)[best], lifted[row == best], held[row == best]

    def _space(self, spread: float) -> SearchSpace:
        return SearchSpace(
            lower=np.concatenate([PREGRASP_LOWER, self._posture.lower]),
            upper=np.concatenate([PREGRASP_UPPER, self._posture.upper]),
            spread=spread * np.concatenate([PREGRASP_SPREAD, POSTURE_SPREAD]),
            floor=np.concatenate([PREGRASP_FLOOR, POSTURE_FLOOR]),
        )

    def _grasp(self, numbers: Array, lifted: Array, held: Array) -> Grasp:
        preshape, closing = self._posture.expand(numbers[None, 6:])
        placement = self._placement
        return Grasp(
            topology=self._topology.slug,
            obj=placement.model.name,
            presentation=placement.presentation.kind,
            extents=tuple(np.round(placement.extents, 5).tolist()),
            height=round(float(placement.centre[2]), 5),
            mass=round(placement.model.mass_kg, 5),
            pregrasp=tuple(np.round(numbers[:6], 5).tolist()),
            preshape=tuple(np.round(preshape[0], 4).tolist()),
            closing=tuple(np.round(closing[0], 4).tolist()),
            lift=round(float(lifted.mean()), 4),
            both=round(float(held.mean()), 4),
            trials=len(lifted),
        )
