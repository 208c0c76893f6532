"""The multi-label target: how the file made it, and how it is made without looking at the test."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.selection.dataset import NUM_TOPOLOGIES, GraspTable


def label_sets(table: GraspTable, rows: np.ndarray | None = None) -> np.ndarray:
    """Union of the topologies seen with each row's (object, action).

    With all rows this is the file's own target, which therefore crosses any split made after it.
    Training sets of the honest protocol use the training rows only.

    Args:
        table: n rows; rows of platform add nothing.
        rows: (n,) bool, rows whose grasps count; all by default.

    Returns:
        (n, 15) bool; a row whose pair has no counting row gets an empty set.
    """
    counted = table.topology >= 0
    if rows is not None:
        counted &= rows
    seen = np.zeros((table.pairs.max() + 1, NUM_TOPOLOGIES), bool)
    seen[table.pairs[counted], table.topology[counted]] = True
    return seen[table.pairs]
