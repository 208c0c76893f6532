"""The models that `train/selector.py` can train and score, by name."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.selection import baselines
from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.evidence import condense
from maniskill_taskgrasp.selection.labels import label_sets
from maniskill_taskgrasp.selection.recipe import Recipe, fit_selector
from maniskill_taskgrasp.selection.scoring import Model, Prediction
from maniskill_taskgrasp.selection.tuning import tuned

PAPER_EPOCHS = 15
"""Of the paper's network under the honest protocol; more only fits the training rows better."""


def ours(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """The shipped model, tuned by folds of the same kind inside the training rows."""
    selector = fit_selector(train, tuned([split], train, Recipe()))
    asked = condense(test)
    return Prediction(selector.predict(asked.pairs)[asked.pair_of_row])


def paper(train: GraspTable, test: GraspTable, split: str) -> Prediction:
    """The paper's network: no Duration, label sets and scales from training rows only."""
    from maniskill_taskgrasp.selection import paper as published

    raw = published.paper_features(train, duration=False)
    targets = published.paper_targets(train, label_sets(train))
    trainer = published.PaperTrainer(
        published.standardised(raw, raw), targets, published.BATCH, seed=0
    )
    for _ in range(PAPER_EPOCHS):
        trainer.epoch()
    asked = published.paper_features(test, duration=False)
    scores, opposition, pip = published.predict(trainer.network, published.standardised(asked, raw))
    return Prediction(np.maximum(scores, 1e-9), opposition, pip)


MODELS: dict[str, Model] = {
    "prior": baselines.prior,
    "action": baselines.by_action,
    "object": baselines.by_object,
    "pair": baselines.by_pair,
    "neighbours": baselines.neighbours,
    "logistic": baselines.logistic,
    "boosting": baselines.boosting,
    "trees": baselines.trees,
    "paper": paper,
    "ours": ours,
}
"""Name -> model, in the order of the report."""
