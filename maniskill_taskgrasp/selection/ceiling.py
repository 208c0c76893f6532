"""How well the grasp could be known at all: people differ on the same object and action."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.selection import metrics
from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.evidence import condense
from maniskill_taskgrasp.selection.scoring import TRUSTED_ROWS


def ceilings(table: GraspTable) -> dict[str, dict[str, float]]:
    """own@1, own@3, o and p of knowing each pair's own rows, over pairs with ten rows or more.

    Returns:
        "in sample": the row itself counts, so chance agreement flatters the figure;
        "left out": the row itself does not, so a few lacking rows depress it;
        both also as "..., pairs", each pair weighing the same.
    """
    evidence = condense(table)
    rows = np.flatnonzero(evidence.counts.sum(1)[evidence.pair_of_row] >= TRUSTED_ROWS)
    counts = evidence.counts[evidence.pair_of_row[rows]]
    observed, weights = table.topology[rows], metrics.pair_weights(table.pairs)[rows]
    without = counts.copy()
    without[np.arange(len(rows)), observed] -= 1
    found = {}
    for name, scores in (("in sample", counts), ("left out", without)):
        values = metrics.per_row(scores, observed, table.label_sets[rows])
        summary = metrics.summarise(
            {key: values[key] for key in ("own@1", "own@3", "o", "p")}, weights
        )
        found[name] = {key: both[0] for key, both in summary.items()}
        found[f"{name}, pairs"] = {key: both[1] for key, both in summary.items()}
    return found
