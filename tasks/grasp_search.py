"""Searches a grasp for one object: tries what is known, refines the best, checks the result."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks.cross_entropy import SearchSpace, cross_entropy
from maniskill_taskgrasp.tasks.grasp_library import Grasp, nearest_grasps
from maniskill_taskgrasp.tasks.noise import resolve_noise
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
Places = NDArray[np.integer]

STARTS = 11  # Stored grasps that are tried first.
SCOOP = np.array([0.0, -0.018, 0.0, 0.25, 0.0, 0.0])  # Palm lower, fingers down: facts, 3.
GOOD_START = 0.5  # Share of trials in lift and form from which a search stays near its start.
GOOD_END = 0.8  # Share below which what came of a good start is not good enough.
NEAR, WIDE = 0.4, 1.0  # Spread of the first generation around a good and a poor start.
FINALISTS = 16  # Candidates that are tried again after a search.
KEPT = 4  # One in so many of them goes on to the next round.
ROUNDS = 2  # In which one of the finalists is left.
RIVALS = 3  # Poor starts that share the first generation.
WIDE_SEARCHES = 2  # At most, each from other starts, until one comes to something.
PROVEN = 0.95  # Share of trials in lift and form at which a start needs no search.
HOPELESS = 2.5  # Score below which nothing was even lifted.
ENOUGH = 5.1  # Mean score of a generation of which nearly all lift in form.
WIDEST = "blind"  # Noise under which grasps are hardened, for any that is wide.
HARD_GENERATIONS = 8  # Of the search on under wide noise.
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
    hardened: str | None = None
    """Noise under which what was found is searched on; None leaves it."""
    seed: int = 0
    follow: bool = False
    """Whether the palm follows the object in the trials, as it will when the grasp is used."""

    def __post_init__(self) -> None:
        if self.generations < 1:
            raise InputError(f"a search needs at least 1 generation, got {self.generations}")

    @classmethod
    def on_object(cls, generations: int, seed: int, noise: str) -> SearchBudget:
        """What `--search` stands for on an object that will meet some noise.

        Raises:
            InputError: no generation, or no noise has that name.
        """
        return cls(generations=generations, seed=seed, follow=True).meeting(noise)

    def meeting(self, noise: str) -> SearchBudget:
        """The same budget for grasps that will meet some noise: hardened, where it is wide.

        Raises:
            InputError: no noise has that name.
        """
        wide = resolve_noise(noise).position > resolve_noise(self.noise).position
        return replace(self, hardened=WIDEST if wide else None)

    @property
    def trials(self) -> int:
        """Most simulated grasps: starts, a check of the best, and a search about it; then wide
        searches with a search about what each found. Searches end with rounds and a check."""
        narrow = self.narrow + ROUNDS + 1
        wide = self.generations + self.first - 1 + ROUNDS
        batches = 2 + narrow + WIDE_SEARCHES * (wide + narrow)
        if self.hardened is not None:
            batches += HARD_GENERATIONS + ROUNDS + 2
        return self.num_envs * batches

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


@dataclass(frozen=True)
class Checked:
    """A grasp with what it did in fresh trials."""

    numbers: Array
    """(14,) six of the pregrasp, eight of `PostureSpace`."""
    lift: float
    both: float


def _best_first(score: Array, row: Places) -> Places:
    """Numbers of candidates by their mean score; `row` says whose each score (n,) is."""
    means = [-score[row == i].mean() for i in range(row.max() + 1)]
    return np.argsort(means, kind="stable")


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
        order = _best_first(score, row)
        best = self._checked(starts[order[0]])
        good = both[row == order[0]].mean() >= GOOD_START and best.both >= GOOD_START
        if good and best.both < PROVEN:
            best = self._narrow(best, best.numbers)
        for again in range(WIDE_SEARCHES):
            if best.both >= (GOOD_END if good or again else PROVEN):
                break
            rivals = starts[np.roll(order, -RIVALS * again)[:RIVALS]]
            best = self._narrow(best, self._wide(rivals))
        return SearchResult(
            self._grasp(best),
            names[order[0]],
            self._batches * self._budget.num_envs,
        )

    def harden(self, found: SearchResult) -> SearchResult:
        """Search on about a grasp that another search found, whose trials knew less noise."""
        best = self._checked(self._numbers(found.grasp))
        if best.both < PROVEN:
            best = self._narrow(best, best.numbers, HARD_GENERATIONS)
        spent = found.spent + self._batches * self._budget.num_envs
        return SearchResult(self._grasp(best), found.start, spent)

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
        """(14,) the best that was met from several poor starts."""
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
        return self._race([mean], history)

    def _narrow(self, best: Checked, centre: Array, generations: int | None = None) -> Checked:
        """Where a search about one grasp comes to, if it is better than the best so far."""
        mean, history = cross_entropy(
            lambda candidates: self._try(candidates, whole=True)[2],
            centre[None],
            self._space(NEAR),
            self._rng(),
            population=self._budget.num_envs,
            generations=generations or self._budget.narrow,
            enough=ENOUGH,
        )
        found = self._checked(self._race([best.numbers, centre, mean], history))
        return max(best, found, key=lambda grasp: (grasp.both, grasp.lift))

    def _race(self, known: list[Array], history: Array) -> Array:
        """The best of some candidates and of those that a search liked most, in fresh trials.

        Between narrow basins the mean of good grasps is none, and one lucky trial proves nothing:
        those that do well in a few trials are tried more often.
        """
        count = min(FINALISTS, self._budget.num_envs) - len(known)
        liked = np.argsort(-history[:, -1], kind="stable")[:count]
        rivals = np.concatenate([known, history[liked, :-1]])
        while len(rivals) > 1:
            row = np.arange(self._budget.num_envs) % len(rivals)
            score = self._try(rivals[row], whole=True)[2]
            rivals = rivals[_best_first(score, row)[: len(rivals) // KEPT or 1]]
        return rivals[0]

    def _checked(self, numbers: Array) -> Checked:
        """What a grasp does in fresh trials."""
        many = np.tile(numbers, (self._budget.num_envs, 1))
        lifted, held, _ = self._try(many, whole=True)
        return Checked(numbers, float(lifted.mean()), float(held.mean()))

    def _space(self, spread: float) -> SearchSpace:
        return SearchSpace(
            lower=np.concatenate([PREGRASP_LOWER, self._posture.lower]),
            upper=np.concatenate([PREGRASP_UPPER, self._posture.upper]),
            spread=spread * np.concatenate([PREGRASP_SPREAD, POSTURE_SPREAD]),
            floor=np.concatenate([PREGRASP_FLOOR, POSTURE_FLOOR]),
        )

    def _grasp(self, best: Checked) -> Grasp:
        numbers = best.numbers
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
            lift=round(best.lift, 4),
            both=round(best.both, 4),
            trials=self._budget.num_envs,
        )
