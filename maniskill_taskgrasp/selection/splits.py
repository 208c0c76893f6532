"""Which rows are held out: the four splits of the honest protocol, exactly reproducible."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from maniskill_taskgrasp.selection.dataset import GraspTable

SPLITS = ("random", "pairs", "objects", "actions")
"""What is new in a test row: nothing, the combination, the object, or the action."""
FOLDS = 5
SHUFFLE_SEED = 0
RANDOM_SHARE = 0.1


def group_of_rows(table: GraspTable, split: str) -> np.ndarray:
    """(n,) int group of each row; rows of one group are never divided.

    Objects and actions are numbered by name, pairs by first appearance, and every row is its own
    group under "random".
    """
    if split == "random":
        return np.arange(len(table))
    if split == "pairs":
        return table.pairs
    if split in ("objects", "actions"):
        return np.unique(getattr(table, split), return_inverse=True)[1]
    raise ValueError(f"split must be one of {', '.join(SPLITS)}, got {split!r}")


def deal(group: np.ndarray, folds: int = FOLDS, seed: int = SHUFFLE_SEED) -> np.ndarray:
    """(n,) int fold of each row: groups shuffled, then the i-th goes to fold i mod `folds`."""
    order = np.random.RandomState(seed).permutation(group.max() + 1)
    fold_of_group = np.empty(len(order), int)
    fold_of_group[order] = np.arange(len(order)) % folds
    return fold_of_group[group]


def folds_of(table: GraspTable, split: str) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Five (train, test) pairs of row masks (n,).

    `table` is the one without platform. "random" draws five independent tests of 10 %; the others
    deal their groups to five disjoint folds.
    """
    group = group_of_rows(table, split)
    if split == "random":
        for seed in range(FOLDS):
            test = np.zeros(len(table), bool)
            chosen = np.random.RandomState(seed).permutation(len(table))
            test[chosen[: round(RANDOM_SHARE * len(table))]] = True
            yield ~test, test
        return
    fold = deal(group)
    for number in range(FOLDS):
        yield fold != number, fold == number
