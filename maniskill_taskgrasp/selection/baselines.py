"""What our model must beat: frequencies, neighbours, linear models and trees on the same rows.

scikit-learn is needed here and nowhere at run time (`pip install maniskill-taskgrasp[train]`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from maniskill_taskgrasp.selection.dataset import NUM_TOPOLOGIES, GraspTable
from maniskill_taskgrasp.selection.ensemble import InputLayout
from maniskill_taskgrasp.selection.evidence import condense, fit_describer
from maniskill_taskgrasp.selection.scoring import Prediction

PRIOR_ROWS = 1.0
"""Rows that the coarser frequency is worth beside a finer one."""
FLOOR = 1e-4
"""Probability of a topology that a classifier never saw."""


def prior(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """How often each topology was seen at all."""
    counts = np.bincount(train.topology, minlength=NUM_TOPOLOGIES)
    return Prediction(np.tile(counts / counts.sum(), (len(test), 1)))


def by_action(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """How often each topology was seen with the action."""
    return Prediction(_frequencies(train.actions, train.topology, test.actions, _prior_of(train)))


def by_object(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """How often each topology was seen with the object."""
    return Prediction(_frequencies(train.objects, train.topology, test.objects, _prior_of(train)))


def by_pair(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """How often each topology was seen with the object and action; a table of what is known."""
    keys = [np.char.add(np.char.add(t.objects, "|"), t.actions) for t in (train, test)]
    return Prediction(_frequencies(keys[0], train.topology, keys[1], _prior_of(train)))


def _prior_of(train: GraspTable) -> np.ndarray:
    return np.bincount(train.topology, minlength=NUM_TOPOLOGIES) / len(train)


def _frequencies(
    keys: np.ndarray, topology: np.ndarray, asked: np.ndarray, base: np.ndarray
) -> np.ndarray:
    """(n, 15) frequencies under each asked key, shrunk to `base`, which unknown keys get."""
    names = {name: i for i, name in enumerate(dict.fromkeys(keys.tolist()))}
    counts = np.zeros((len(names) + 1, NUM_TOPOLOGIES))
    rows = np.array([names[key] for key in keys.tolist()])
    np.add.at(counts, (rows, topology), 1)
    found = counts[[names.get(key, len(names)) for key in asked.tolist()]]
    return (found + PRIOR_ROWS * base) / (found.sum(1, keepdims=True) + PRIOR_ROWS)


def neighbours(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """The 25 nearest training rows, weighted by inverse distance."""
    from sklearn.neighbors import KNeighborsClassifier

    return _classified(train, test, lambda: KNeighborsClassifier(25, weights="distance"), rows=True)


def logistic(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """Multinomial logistic regression."""
    from sklearn.linear_model import LogisticRegression

    return _classified(train, test, lambda: LogisticRegression(C=0.01, max_iter=300))


def trees(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """300 extremely randomised trees."""
    return _classified(train, test, make_trees)


def boosting(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """Histogram gradient boosting."""
    return _classified(train, test, make_boosting)


def make_trees() -> Any:
    """The untrained trees."""
    from sklearn.ensemble import ExtraTreesClassifier

    return ExtraTreesClassifier(300, min_samples_leaf=2, random_state=0)


def make_boosting() -> Any:
    """The untrained boosting."""
    from sklearn.ensemble import HistGradientBoostingClassifier

    return HistGradientBoostingClassifier(
        learning_rate=0.05, max_iter=80, max_leaf_nodes=8, l2_regularization=5.0, random_state=0
    )


def _classified(
    train: GraspTable, test: GraspTable, make: Callable[[], Any], rows: bool = False
) -> Prediction:
    """A scikit-learn classifier on the perceptrons' inputs.

    A pair is one sample per topology seen with it, the samples of a pair that was seen n times
    weighing n ** 0.5 in total; or n samples where the classifier takes no weights (`rows`).
    """
    known, asked, describer = condense(train), condense(test), fit_describer(train)
    described = describer(known.pairs)
    layout = InputLayout.fit(described)
    inputs = layout(described)
    pair, topology = np.nonzero(known.counts)
    seen = known.counts[pair, topology]
    if rows:
        pair, topology = np.repeat(pair, seen.astype(int)), np.repeat(topology, seen.astype(int))
        weights = {}
    else:
        weights = {"sample_weight": seen * known.counts.sum(1)[pair] ** -0.5}
    classifier, asked_inputs = make(), scaled(layout(describer(asked.pairs)), inputs)
    found = learned(classifier, scaled(inputs, inputs)[pair], topology, asked_inputs, **weights)
    return Prediction(found[asked.pair_of_row])


def scaled(inputs: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Columns scaled by mean and deviation of `reference`; constant ones are only centred."""
    scale = reference.std(0)
    scale[scale < 1e-6] = 1
    return (inputs - reference.mean(0)) / scale


def learned(
    classifier: Any, inputs: np.ndarray, topology: np.ndarray, asked: np.ndarray, **weights: Any
) -> np.ndarray:
    """(m, 15) probabilities for `asked` (m, width) after training on inputs (n, width)."""
    classifier.fit(inputs, topology, **weights)
    found = np.full((len(asked), NUM_TOPOLOGIES), FLOOR)
    found[:, classifier.classes_] += classifier.predict_proba(asked)
    return found / found.sum(1, keepdims=True)
