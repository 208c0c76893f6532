"""Would more data help? The recipe on ever more of the training pairs or objects."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from maniskill_taskgrasp.selection import metrics
from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.evidence import condense
from maniskill_taskgrasp.selection.recipe import Recipe, fit_selector
from maniskill_taskgrasp.selection.splits import folds_of, group_of_rows

SHARES = (0.125, 0.25, 0.5, 1.0)
CURVES = ("pairs", "objects")
"""Splits of which a curve is drawn."""


def learning_curve(
    table: GraspTable, split: str, recipe: Recipe, seed: int, advance: Callable[[], None]
) -> list[dict[str, Any]]:
    """Scores on what the split holds out when only a share of the training groups is used.

    The groups (pairs, objects) used with one share are among those used with the next. The recipe
    is not tuned, so that the curve shows the data and not the tuning.

    Returns:
        One dict per share: {"share", metric: (row-weighted, pair-weighted) mean over folds, "ECE":
        of the top answer over the rows of all folds, row- and pair-weighted}.
    """
    weights, group = metrics.pair_weights(table.pairs), group_of_rows(table, split)
    points = []
    for share in SHARES:
        scores: dict[str, list[tuple[float, float]]] = {}
        top: list[np.ndarray] = []
        for train, test in folds_of(table, split):
            names = np.unique(group[train])
            order = np.random.default_rng(seed).permutation(len(names))
            used = names[order[: max(round(share * len(names)), 1)]]
            selector = fit_selector(table.take(train & np.isin(group, used)), recipe)
            rows = np.flatnonzero(test)
            asked = condense(table.take(rows))
            found = selector.predict(asked.pairs)[asked.pair_of_row]
            values = metrics.per_row(found, table.topology[rows], table.label_sets[rows])
            for metric, both in metrics.summarise(values, weights[rows]).items():
                scores.setdefault(metric, []).append(both)
            top.append(np.stack([found.max(1), values["own@1"], weights[rows]]))
            advance()
        means = {metric: np.mean(folds, axis=0).tolist() for metric, folds in scores.items()}
        confidence, correct, weight = np.concatenate(top, axis=1)
        error = metrics.calibration_error
        means["ECE"] = [error(confidence, correct), error(confidence, correct, weight)]
        points.append({"share": share, **means})
    return points
