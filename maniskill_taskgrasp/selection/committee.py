"""The strongest honest model before ours, made again from its description: a mean of four."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.selection import paper
from maniskill_taskgrasp.selection.baselines import learned, make_boosting, make_trees, scaled
from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.ensemble import InputLayout
from maniskill_taskgrasp.selection.evidence import condense, fit_describer
from maniskill_taskgrasp.selection.features import measurements
from maniskill_taskgrasp.selection.fit import EnsembleConfig, fit_ensemble
from maniskill_taskgrasp.selection.scoring import Prediction

PERCEPTRON = EnsembleConfig(
    members=1, hidden=(256, 128, 64), row_power=1.0, input_dropout=0.0, blank_object_name=0.0
)


def committee(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """Mean of trees, boosting, a perceptron and logistic regression, each trained on rows.

    Trees and perceptron see names as vectors, boosting and logistic regression actions as
    indicators; all but the perceptron see the task parameters too. The settings of the first are
    not known in full, so that its figures come out only nearly the same.
    """
    from sklearn.linear_model import LogisticRegression

    known, asked, describer = condense(train), condense(test), fit_describer(train)
    pairs, asked_pairs = describer(known.pairs), describer(asked.pairs)
    layout = InputLayout.fit(pairs)
    names = np.hstack([layout(pairs)[known.pair_of_row], paper.parameter_indicators(train)])
    asked_names = np.hstack(
        [layout(asked_pairs)[asked.pair_of_row], paper.parameter_indicators(test)]
    )
    classes, asked_classes = _indicators(train), _indicators(test)
    parts = [fit_ensemble(pairs, known.counts, PERCEPTRON).predict(asked_pairs)[asked.pair_of_row]]
    for classifier, inputs, questions in (
        (make_trees(), names, asked_names),
        (make_boosting(), classes, asked_classes),
        (LogisticRegression(C=0.01, max_iter=300), classes, asked_classes),
    ):
        questions = scaled(questions, inputs)
        parts.append(learned(classifier, scaled(inputs, inputs), train.topology, questions))
    return Prediction(np.mean(parts, axis=0))


def _indicators(table: GraspTable) -> np.ndarray:
    """(n, 126): the paper's inputs without Duration, sizes and mass as logarithms."""
    sizes = [measurements(table.affordances[name]) for name in table.objects.tolist()]
    return np.hstack([sizes, paper.paper_features(table, duration=False)[:, len(sizes[0]) :]])
