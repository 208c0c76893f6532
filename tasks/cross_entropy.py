"""Wide search for palm pose and posture in batched physics: the cross-entropy method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
    start: Array,
    space: SearchSpace,
    rng: np.random.Generator,
    *,
    population: int,
    generations: int,
    first: int = 1,
    elite: float = 0.15,
) -> tuple[Array, Array]:
    """Maximise a noisy score.

    Args:
        score: (population, dims) candidates -> (population,) scores.
        start: (dims,) centre of the first generation.
        first: populations in the first generation; a wide look keeps out of bad basins.

    Returns:
        (dims,) mean of the best generation's elite, and every candidate with its score,
        (generations * population, dims + 1).
    """
    mean, spread, history = start.copy(), space.spread.copy(), []
    best_mean, best_value = mean, -np.inf
    count = max(4, int(elite * population))
    for generation in range(generations):
        looks = []
        for _ in range(first if generation == 0 else 1):
            batch = rng.normal(mean, spread, (population, len(mean)))
            batch[0] = mean
            batch = batch.clip(space.lower, space.upper)
            looks.append(np.column_stack([batch, score(batch)]))
        tried = np.concatenate(looks)
        candidates, values = tried[:, :-1], tried[:, -1]
        history.append(tried)
        top = candidates[np.argsort(-values, kind="stable")[:count]]
        value = float(np.sort(values)[-count:].mean())
        mean = 0.2 * mean + 0.8 * top.mean(0)
        spread = np.maximum(0.3 * spread + 0.7 * top.std(0), space.floor)
        if value >= best_value:
            best_mean, best_value = mean, value
    return best_mean, np.concatenate(history)
