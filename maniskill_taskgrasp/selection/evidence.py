"""Rows condensed to what is learned from: distinct inputs and how often each grasp was seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.selection.dataset import NUM_TOPOLOGIES, GraspTable
from maniskill_taskgrasp.selection.features import FeatureEncoder


@dataclass(frozen=True, eq=False)
class Evidence:
    """Distinct inputs of a table with their topology counts."""

    features: np.ndarray
    """(groups, width) raw features."""
    counts: np.ndarray
    """(groups, 15) rows of each topology."""
    group_of_row: np.ndarray
    """(rows,) int: which input each row of the table has."""


def condense(table: GraspTable, encoder: FeatureEncoder) -> Evidence:
    """Group rows by (object, action, force, constraint, class), in order of first appearance."""
    columns = (table.objects, table.actions, table.forces, table.constraints, table.classes)
    keys = list(zip(*(column.tolist() for column in columns), strict=True))
    number = {key: i for i, key in enumerate(dict.fromkeys(keys))}
    group_of_row = np.array([number[key] for key in keys])
    counts = np.zeros((len(number), NUM_TOPOLOGIES))
    np.add.at(counts, (group_of_row, table.topology), 1)
    features = [
        encoder(
            table.affordances[obj],
            action,
            {"force": force, "constraint": constraint, "task_class": task_class},
        )
        for obj, action, force, constraint, task_class in number
    ]
    return Evidence(np.stack(features), counts, group_of_row)


def count_pairs(table: GraspTable) -> dict[tuple[str, str], np.ndarray]:
    """(object, action) -> rows of each topology (15,)."""
    counts: dict[tuple[str, str], np.ndarray] = {}
    rows = zip(table.objects.tolist(), table.actions.tolist(), table.topology, strict=True)
    for obj, action, topology in rows:
        counts.setdefault((obj, action), np.zeros(NUM_TOPOLOGIES))[topology] += 1
    return counts
