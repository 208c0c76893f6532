"""Runs a model over the folds of a split, keeps its predictions, and condenses them to figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from maniskill_taskgrasp.selection import metrics
from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.intervals import calibration_floor, group_interval, label_noise
from maniskill_taskgrasp.selection.splits import folds_of, group_of_rows

TRUSTED_ROWS = 10
"""Pairs with at least this many rows have label sets that can be trusted (83 % of the rows)."""
INTERVALS_OF = ("own@1", "own@3", "NLL")
"""Metrics whose spread is reported."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a model says of n test rows."""

    scores: np.ndarray
    """(n, 15), a distribution or sigmoid scores."""
    opposition: np.ndarray | None = None
    """(n, 3) where the model has an own head for it; else the sums of `scores` count."""
    pip: np.ndarray | None = None


Model = Callable[[GraspTable, GraspTable, str], Prediction]
"""(training rows, test rows, split) -> prediction; must not read the test rows' topology."""


def predictions(
    name: str, model: Model, table: GraspTable, split: str, folder: Path
) -> Iterator[Prediction]:
    """The model's prediction for each fold, computed once and kept in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, (train, test) in enumerate(folds_of(table, split)):
        path = folder / f"{name}_{split}_{number}.npz"
        if not path.exists():
            found = model(table.take(train), table.take(test), split)
            arrays = {k: v.astype(np.float32) for k, v in vars(found).items() if v is not None}
            partial = path.with_suffix(".partial.npz")
            np.savez_compressed(partial, **arrays)
            partial.replace(path)
        with np.load(path) as kept:
            yield Prediction(**{key: kept[key].astype(float) for key in kept.files})


def evaluate(
    name: str, model: Model, table: GraspTable, split: str, folder: Path
) -> dict[str, Any]:
    """Figures of a model on a split, all in fractions except NLL [nats].

    Returns:
        {"row" | "pair" | "trusted": {metric: [mean, std]}, "folds": {metric: [row-weighted per
        fold]}, "pair_folds": likewise, and of all test rows together what `_pooled` says};
        "trusted" is row-weighted over pairs with ten rows or more.
    """
    weights = metrics.pair_weights(table.pairs)
    often = weights <= 1 / TRUSTED_ROWS
    folds: list[dict[str, tuple[float, float]]] = []
    trusted: list[dict[str, float]] = []
    columns: list[dict[str, np.ndarray]] = []
    found = predictions(name, model, table, split, folder)
    for number, ((_, test), prediction) in enumerate(
        zip(folds_of(table, split), found, strict=True)
    ):
        rows = np.flatnonzero(test)
        values = row_values(prediction, table.take(rows))
        folds.append(metrics.summarise(values, weights[rows]))
        trusted.append({key: float(v[often[rows]].mean()) for key, v in values.items()})
        opposition, pip = _heads(prediction)
        columns.append(
            {
                **{"rows": rows, "fold": np.full(len(rows), number), "scores": prediction.scores},
                **{"opposition": opposition, "pip": pip},
                **{metric: values[metric] for metric in INTERVALS_OF},
            }
        )
    tested = {key: np.concatenate([part[key] for part in columns]) for key in columns[0]}
    return {
        "row": {k: _mean_std([fold[k][0] for fold in folds]) for k in metrics.PER_ROW},
        "pair": {k: _mean_std([fold[k][1] for fold in folds]) for k in metrics.PER_ROW},
        "trusted": {k: _mean_std([fold[k] for fold in trusted]) for k in metrics.PER_ROW},
        "folds": {k: [fold[k][0] for fold in folds] for k in metrics.PER_ROW},
        "pair_folds": {k: [fold[k][1] for fold in folds] for k in metrics.PER_ROW},
        **_pooled(tested, table, split),
    }


def _pooled(tested: dict[str, np.ndarray], table: GraspTable, split: str) -> dict[str, Any]:
    """Calibration, spread, threshold curve and confusion over the test rows of all folds.

    Returns:
        {"ECE": {"row", "pair", "calibrated": (mean, 95th percentile) of a calibrated model},
        "interval": {metric: [2.5 %, 97.5 %]}, "label_noise": {metric: std}, "thresholds": [...],
        "confusion": {...}}; interval and noise are of the row-weighted mean over folds.
    """
    rows, fold, scores = (tested[key] for key in ("rows", "fold", "scores"))
    confidence, correct = scores.max(1) / scores.sum(1), tested["own@1"]
    group, pairs, observed = group_of_rows(table, split)[rows], table.pairs[rows], table.topology
    weights = metrics.pair_weights(table.pairs)[rows]
    opposition, pip = metrics.OPPOSITION_OF[observed[rows]], metrics.PIP_OF[observed[rows]]
    return {
        "ECE": {
            "row": metrics.calibration_error(confidence, correct),
            "pair": metrics.calibration_error(confidence, correct, weights),
            "calibrated": calibration_floor(confidence, correct, group),
        },
        "interval": {m: group_interval(tested[m], group, fold) for m in INTERVALS_OF},
        "label_noise": {m: label_noise(tested[m], pairs, fold) for m in INTERVALS_OF},
        "thresholds": metrics.threshold_curve(scores, table.label_sets[rows]),
        "confusion": {
            "opposition": metrics.confusion(tested["opposition"], opposition, 3),
            "pip": metrics.confusion(tested["pip"], pip, 3),
        },
    }


def paired_intervals(
    first: str, second: str, models: dict[str, Model], table: GraspTable, split: str, folder: Path
) -> dict[str, list[float]]:
    """95 % interval [low, high] of first minus second, row-weighted mean over folds, per metric.

    Both are scored on the same rows and the split's groups are drawn anew for both at once.
    """
    gaps: dict[str, list[np.ndarray]] = {metric: [] for metric in INTERVALS_OF}
    tested, fold = [], []
    pairs_of_predictions = zip(
        folds_of(table, split),
        *(predictions(name, models[name], table, split, folder) for name in (first, second)),
        strict=True,
    )
    for number, ((_, test), mine, other) in enumerate(pairs_of_predictions):
        rows = np.flatnonzero(test)
        asked = table.take(rows)
        values, others = row_values(mine, asked), row_values(other, asked)
        for metric, parts in gaps.items():
            parts.append(values[metric] - others[metric])
        tested.append(rows)
        fold.append(np.full(len(rows), number))
    group = group_of_rows(table, split)[np.concatenate(tested)]
    return {
        metric: group_interval(np.concatenate(parts), group, np.concatenate(fold))
        for metric, parts in gaps.items()
    }


def row_values(prediction: Prediction, test: GraspTable) -> dict[str, np.ndarray]:
    """`metrics.per_row` of a prediction; o and p by the model's own heads where it has them."""
    values = metrics.per_row(prediction.scores, test.topology, test.label_sets)
    if prediction.opposition is not None and prediction.pip is not None:
        opposition, pip = _heads(prediction)
        values["o"] = (opposition == metrics.OPPOSITION_OF[test.topology]).astype(float)
        values["p"] = (pip == metrics.PIP_OF[test.topology]).astype(float)
    return values


def _heads(prediction: Prediction) -> tuple[np.ndarray, np.ndarray]:
    """(n,) most probable opposition and PIP class of each row."""
    opposition, pip = prediction.opposition, prediction.pip
    if opposition is None:
        opposition = metrics.marginal(prediction.scores, metrics.OPPOSITION_OF)
    if pip is None:
        pip = metrics.marginal(prediction.scores, metrics.PIP_OF)
    return opposition.argmax(1), pip.argmax(1)


def _mean_std(values: list[float]) -> list[float]:
    return [float(np.mean(values)), float(np.std(values))]
