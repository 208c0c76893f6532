"""How a ranking of the 15 topologies is scored; the formulas of docs/selection.md as code."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.topology import OPPOSITIONS, PIPS, TOPOLOGIES

OPPOSITION_OF = np.array([OPPOSITIONS.index(t.opposition) for t in TOPOLOGIES])
PIP_OF = np.array([PIPS.index(t.pip) for t in TOPOLOGIES])
ECE_BINS = 10
SMALLEST_PROBABILITY = 1e-9
THRESHOLDS = tuple(round(0.05 * step, 2) for step in range(1, 20))
"""Score from which a topology counts as predicted (the paper's Fig. 7)."""
PER_ROW = ("hit@1", "match@3", "any@3", "P@3", "own@1", "own@3", "o", "p", "NLL")


def marginal(probabilities: np.ndarray, group_of: np.ndarray) -> np.ndarray:
    """(n, 15) -> (n, groups): sums over the topologies of each opposition or PIP class."""
    return probabilities @ np.eye(group_of.max() + 1)[group_of]


def per_row(scores: np.ndarray, observed: np.ndarray, label_sets: np.ndarray) -> dict:
    """Each metric for each row, as {name: (n,) float}.

    Args:
        scores: (n, 15) non-negative; a distribution, or sigmoid scores (then NLL is of the
            normalised row, and o and p sum the scores).
        observed: (n,) int, the topology seen.
        label_sets: (n, 15) bool, topologies that count as right for hit@1, match@3, any@3, P@3.
    """
    rows = np.arange(len(scores))
    ranked = np.argsort(-scores, axis=1, kind="stable")[:, :3]
    in_set = label_sets[rows[:, None], ranked]
    own = ranked == observed[:, None]
    distribution = scores / scores.sum(1, keepdims=True)
    return {
        "hit@1": in_set[:, 0].astype(float),
        "match@3": in_set.sum(1) / np.minimum(3, label_sets.sum(1)),
        "any@3": in_set.any(1).astype(float),
        "P@3": in_set.mean(1),
        "own@1": own[:, 0].astype(float),
        "own@3": own.any(1).astype(float),
        "o": _class_hit(scores, observed, OPPOSITION_OF),
        "p": _class_hit(scores, observed, PIP_OF),
        "NLL": -np.log(np.maximum(distribution[rows, observed], SMALLEST_PROBABILITY)),
    }


def _class_hit(scores: np.ndarray, observed: np.ndarray, group_of: np.ndarray) -> np.ndarray:
    return (marginal(scores, group_of).argmax(1) == group_of[observed]).astype(float)


def pair_weights(pairs: np.ndarray) -> np.ndarray:
    """(n,) weight of each row so that every (object, action) pair of the table weighs 1 in total.

    Computed on the whole table and then restricted to the test rows: under a random split a pair
    weighs what share of it fell into the test.
    """
    return 1.0 / np.bincount(pairs)[pairs]


def summarise(values: dict[str, np.ndarray], weights: np.ndarray) -> dict[str, tuple[float, float]]:
    """{metric: (row-weighted, pair-weighted)} means of per-row values; `weights` (n,) of pairs."""
    weights = weights / weights.sum()
    return {name: (float(v.mean()), float(v @ weights)) for name, v in values.items()}


def calibration_error(
    confidence: np.ndarray, correct: np.ndarray, weights: np.ndarray | None = None
) -> float:
    """Expected calibration error of the top answer over ten equal bins of confidence."""
    weights = np.ones(len(confidence)) if weights is None else weights
    weights = weights / weights.sum()
    bins = np.minimum((confidence * ECE_BINS).astype(int), ECE_BINS - 1)
    gaps = np.bincount(bins, weights * (confidence - correct), minlength=ECE_BINS)
    return float(np.abs(gaps).sum())


def micro_scores(predicted: np.ndarray, label_sets: np.ndarray) -> tuple[float, float, float]:
    """Micro precision, recall and F1 of predicted sets (n, 15) bool; 0 where undefined."""
    true_positive = int((predicted & label_sets).sum())
    precision = true_positive / max(int(predicted.sum()), 1)
    recall = true_positive / max(int(label_sets.sum()), 1)
    f1 = 2 * precision * recall / max(precision + recall, SMALLEST_PROBABILITY)
    return precision, recall, f1


def threshold_curve(scores: np.ndarray, labels: np.ndarray) -> list[dict[str, float]]:
    """Micro precision, recall and F1 of the label sets at each threshold."""
    points = []
    for threshold in THRESHOLDS:
        precision, recall, f1 = micro_scores(scores >= threshold, labels)
        points.append({"threshold": threshold, "precision": precision, "recall": recall, "f1": f1})
    return points


def confusion(predicted: np.ndarray, observed: np.ndarray, classes: int) -> list[list[int]]:
    """Counts, observed class by row, predicted class by column."""
    counts = np.zeros((classes, classes), int)
    np.add.at(counts, (observed, predicted), 1)
    return counts.tolist()
