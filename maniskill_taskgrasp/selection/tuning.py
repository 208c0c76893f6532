"""How share, temperature and shrinkage are chosen: by folds inside the training rows only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.evidence import condense
from maniskill_taskgrasp.selection.metrics import pair_weights
from maniskill_taskgrasp.selection.mixture import blend, shrunk
from maniskill_taskgrasp.selection.recipe import Recipe, fit_selector
from maniskill_taskgrasp.selection.splits import deal, group_of_rows

INNER_FOLDS = 3
INNER_SEED = 1
INNER_MEMBERS = 4
"""Perceptrons per inner fit: enough to weigh them, and half the time."""
SHARES = (0.25, 0.5, 0.75)
TEMPERATURES = (0.8, 0.9, 1.0, 1.1, 1.2, 1.35)
SHRINKS = (1.0, 2.0, 3.0, 5.0, 8.0)


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Predictions for rows that the predicting model did not see; n rows."""

    kernels: np.ndarray
    """(n, 15)"""
    perceptrons: np.ndarray
    """(n, 15)"""
    counts: np.ndarray
    """(n, 15) training rows of the same pair."""
    observed: np.ndarray
    """(n,) int"""
    weights: np.ndarray
    """(n,) sums to 1: half shared by rows, half by pairs."""

    def log_loss(self, share: float, temperature: float, shrink: float) -> float:
        """Mean negative log probability of what was observed."""
        model = blend(self.kernels, self.perceptrons, share, temperature)
        probability = shrunk(self.counts, model, shrink)[np.arange(len(model)), self.observed]
        return float(-np.log(np.maximum(probability, 1e-12)) @ self.weights)


def held_out(table: GraspTable, split: str, recipe: Recipe) -> HeldOut:
    """Predictions for every row of `table` by models that were trained on other folds of it."""
    fold = deal(group_of_rows(table, split), INNER_FOLDS, INNER_SEED)
    weights = pair_weights(table.pairs)
    weights = 0.5 / len(table) + 0.5 * weights / weights.sum()
    light = replace(recipe, perceptrons=replace(recipe.perceptrons, members=INNER_MEMBERS))
    parts = []
    for number in range(INNER_FOLDS):
        selector = fit_selector(table.take(fold != number), light)
        test = condense(table.take(fold == number))
        row = test.pair_of_row
        kernels, perceptrons = selector.parts(test.pairs)
        counts = selector.counts(test.keys)
        parts.append((kernels[row], perceptrons[row], counts[row]))
    order = np.concatenate([np.flatnonzero(fold == number) for number in range(INNER_FOLDS)])
    kernels, perceptrons, counts = (np.concatenate(part) for part in zip(*parts, strict=True))
    return HeldOut(kernels, perceptrons, counts, table.topology[order], weights[order])


def tuned(splits: Sequence[str], table: GraspTable, recipe: Recipe) -> Recipe:
    """The recipe with the share, temperature and shrinkage of the least held-out log loss.

    Several splits count alike; a selector that will meet all kinds of news is tuned on all.
    """
    views = [held_out(table, split, recipe) for split in splits]
    # Only the random split repeats pairs, so only there does the shrinkage change anything.
    shrinks = SHRINKS if "random" in splits else (recipe.shrink,)
    best = min(
        product(SHARES, TEMPERATURES, shrinks),
        key=lambda setting: sum(view.log_loss(*setting) for view in views),
    )
    return replace(recipe, share=best[0], temperature=best[1], shrink=best[2])
