"""Rows condensed to what is learned from: (object, action) pairs and their topology counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.selection.dataset import NUM_TOPOLOGIES, GraspTable
from maniskill_taskgrasp.selection.features import Describer, Pair
from maniskill_taskgrasp.selection.names import name_vectors


@dataclass(frozen=True, eq=False)
class Evidence:
    """Distinct pairs of a table, in order of first appearance."""

    pairs: list[Pair]
    counts: np.ndarray
    """(pairs, 15) rows of each topology."""
    pair_of_row: np.ndarray
    """(rows,) int into `pairs`."""

    @property
    def keys(self) -> list[tuple[str, str]]:
        """(object name, action) of each pair."""
        return [(affordance.name, action) for affordance, action in self.pairs]


def condense(table: GraspTable) -> Evidence:
    """Count the topologies of each pair; the table must be without platform."""
    keys = list(zip(table.objects.tolist(), table.actions.tolist(), strict=True))
    number = {key: i for i, key in enumerate(dict.fromkeys(keys))}
    pair_of_row = np.array([number[key] for key in keys])
    counts = np.zeros((len(number), NUM_TOPOLOGIES))
    np.add.at(counts, (pair_of_row, table.topology), 1)
    pairs = [(table.affordances[obj], action) for obj, action in number]
    return Evidence(pairs, counts, pair_of_row)


def fit_describer(table: GraspTable) -> Describer:
    """Scales from the table's own objects, name vectors from the shipped file."""
    names = dict.fromkeys(table.objects.tolist())
    return Describer.fit([table.affordances[name] for name in names], *name_vectors())
