"""How far a figure would move had other things been filmed, or the same things once more."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.selection.metrics import ECE_BINS

DRAWS = 2_000
COVERED = (2.5, 97.5)
"""Percentiles of the interval."""


def group_interval(values: np.ndarray, group: np.ndarray, fold: np.ndarray) -> list[float]:
    """95 % interval of the mean over folds, groups drawn anew within each fold.

    Rows of one group (a pair, an object) share what makes them easy or hard, so groups and not
    rows are drawn.

    Args:
        values: (n,) a metric of each test row.
        group: (n,) int, the split's group of each row.
        fold: (n,) int, the fold in which the row was tested.
    """
    rng = np.random.default_rng(0)
    means = np.zeros(DRAWS)
    folds = np.unique(fold)
    for number in folds:
        inside = fold == number
        members = np.unique(group[inside], return_inverse=True)[1]
        rows, total = np.bincount(members), np.bincount(members, values[inside])
        drawn = rng.multinomial(len(rows), np.full(len(rows), 1 / len(rows)), DRAWS)
        means += (drawn @ total) / (drawn @ rows) / len(folds)
    return np.percentile(means, COVERED).tolist()


def label_noise(values: np.ndarray, pairs: np.ndarray, fold: np.ndarray) -> float:
    """Deviation of the mean over folds had the same people been filmed once more.

    Rows of the same (object, action) get the same prediction; what is left of the spread within a
    pair is people grasping the same thing differently. Pairs with a single row add nothing, so this
    is a lower bound.

    Args:
        values: (n,) a metric of each test row.
        pairs: (n,) int, the (object, action) of each row.
        fold: (n,) int, the fold in which the row was tested.
    """
    folds = np.unique(fold)
    variance = 0.0
    for number in folds:
        inside = fold == number
        members = np.unique(pairs[inside], return_inverse=True)[1]
        rows = np.bincount(members)
        mean = np.bincount(members, values[inside]) / rows
        squares = np.bincount(members, (values[inside] - mean[members]) ** 2)
        unbiased = squares / np.maximum(rows - 1, 1)
        variance += float(rows @ unbiased) / inside.sum() ** 2 / len(folds) ** 2
    return float(np.sqrt(variance))


def calibration_floor(
    confidence: np.ndarray, correct: np.ndarray, group: np.ndarray
) -> tuple[float, float]:
    """ECE of a calibrated model with as much spread between groups: mean and 95th percentile.

    A calibrated model is as often too sure of a group as too unsure, so the sign of each group's
    gap is drawn; the gap of a group with many rows does not average out, whatever its sign.

    Args:
        confidence: (n,) probability of the top answer.
        correct: (n,) 0/1.
        group: (n,) int, the split's group of each row.
    """
    bins = np.minimum((confidence * ECE_BINS).astype(int), ECE_BINS - 1)
    gaps = np.zeros((group.max() + 1, ECE_BINS))
    np.add.at(gaps, (group, bins), confidence - correct)
    signs = np.random.default_rng(0).choice((-1.0, 1.0), (DRAWS, len(gaps)))
    errors = np.abs(signs @ gaps).sum(1) / len(confidence)
    return float(errors.mean()), float(np.percentile(errors, 95))
