"""Wide search for palm pose and posture in batched physics: the cross-entropy method."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PATIENCE = 3  # Generations before a search is given up.


@dataclass(frozen=True)
class SearchSpace:
    """Box and spread of the numbers that are searched; each (dims,)."""

    lower: Array
    upper: Array
    spread: Array
    """Standard deviation of the first generation."""
    floor: Array
    """Standard deviation below which a generation never shrinks."""


def cross_entropy(
    score: Callable[[Array], Array],
    starts: Array,
    space: SearchSpace,
    rng: np.random.Generator,
    *,
    population: int,
    generations: int,
    first: int = 1,
    elite: float = 0.15,
    enough: float = math.inf,
    hopeless: float = -math.inf,
) -> tuple[Array, Array]:
    """Maximise a noisy score.

    Args:
        score: (population, dims) candidates -> (population,) scores.
        starts: (k, dims) centres of the first generation, which share it evenly, the best first.
        first: populations in the first generation; a wide look keeps out of bad basins.
        enough: mean score of a generation after which the search stops.
        hopeless: score that one candidate must reach within `PATIENCE` generations.

    Returns:
        (dims,) mean of the best generation's elite, and every candidate with its score,
        (tried, dims + 1).
    """
    mean, spread, history = starts[0], space.spread.copy(), []
    best_mean, best_value = mean, -np.inf
    for generation in range(generations):
        centres = starts if generation == 0 else mean[None]
        looks = []
        for _ in range(first if generation == 0 else 1):
            centre = centres[np.arange(population) % len(centres)]
            batch = rng.normal(centre, spread, (population, len(mean)))
            batch[: len(centres)] = centres
            batch = batch.clip(space.lower, space.upper)
            looks.append(np.column_stack([batch, score(batch)]))
        tried = np.concatenate(looks)
        history.append(tried)
        group, value, top = _best_group(np.stack(looks), len(centres), elite)
        mean = 0.2 * centres[group] + 0.8 * top.mean(0)
        spread = np.maximum(0.3 * spread + 0.7 * top.std(0), space.floor)
        if value >= best_value:
            best_mean, best_value = mean, value
        lost = generation + 1 >= PATIENCE and max(h[:, -1].max() for h in history) < hopeless
        if lost or tried[:, -1].mean() >= enough:
            break
    return best_mean, np.concatenate(history)


def _best_group(looks: Array, num_groups: int, elite: float) -> tuple[int, float, Array]:
    """The group of candidates whose best are best: basins must not be averaged.

    Args:
        looks: (first, population, dims + 1) candidates with their scores; groups take turns.

    Returns:
        its number, the mean score of its elite, and the elite (count, dims).
    """
    best = (0, -np.inf, looks[0, :1, :-1])
    for number in range(num_groups):
        group = looks[:, number::num_groups].reshape(-1, looks.shape[-1])
        order = np.argsort(-group[:, -1], kind="stable")
        top = group[order[: max(4, int(elite * looks.shape[1]) // num_groups)]]
        if top[:, -1].mean() > best[1]:
            best = (number, float(top[:, -1].mean()), top[:, :-1])
    return best
