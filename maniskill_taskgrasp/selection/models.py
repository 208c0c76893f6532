"""The models that `train/selector.py` can train and score, by name."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.selection import baselines
from maniskill_taskgrasp.selection.committee import committee
from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.evidence import condense
from maniskill_taskgrasp.selection.fit import EnsembleConfig
from maniskill_taskgrasp.selection.labels import label_sets
from maniskill_taskgrasp.selection.metrics import SMALLEST_PROBABILITY
from maniskill_taskgrasp.selection.recipe import Recipe, fit_selector
from maniskill_taskgrasp.selection.scoring import Model, Prediction
from maniskill_taskgrasp.selection.tuning import tuned

PAPER_EPOCHS = 15
"""Of the paper's network under the honest protocol; more only fits the training rows better."""


def ours(recipe: Recipe) -> Model:
    """The shipped model, tuned by folds of the same kind inside the training rows."""

    def model(train: GraspTable, test: GraspTable, split: str) -> Prediction:
        selector = fit_selector(train, tuned([split], train, recipe))
        asked = condense(test)
        return Prediction(selector.predict(asked.pairs)[asked.pair_of_row])

    return model


def paper(seed: int) -> Model:
    """The paper's network: no Duration, label sets and scales from training rows only."""
    from maniskill_taskgrasp.selection import paper as published

    def model(train: GraspTable, test: GraspTable, split: str) -> Prediction:
        raw = published.paper_features(train, duration=False)
        targets = published.paper_targets(train, label_sets(train))
        inputs = published.standardised(raw, raw)
        trainer = published.PaperTrainer(inputs, targets, published.BATCH, seed)
        for _ in range(PAPER_EPOCHS):
            trainer.epoch()
        asked = published.standardised(published.paper_features(test, duration=False), raw)
        scores, opposition, pip = published.predict(trainer.network, asked)
        return Prediction(np.maximum(scores, SMALLEST_PROBABILITY), opposition, pip)

    return model


def all_models(seed: int = 0) -> dict[str, Model]:
    """Name -> model, in the order of the report."""
    return {
        "prior": baselines.prior,
        "action": baselines.by_action,
        "object": baselines.by_object,
        "pair": baselines.by_pair,
        "neighbours": baselines.neighbours,
        "logistic": baselines.logistic,
        "boosting": baselines.boosting,
        "trees": baselines.trees,
        "four": committee,
        "paper": paper(seed),
        "ours": ours(Recipe(perceptrons=EnsembleConfig(seed=seed))),
    }
