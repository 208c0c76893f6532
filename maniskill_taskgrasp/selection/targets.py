"""The figures to reach, and whether a measured one reaches them."""

from __future__ import annotations

PAPER = {"hit@1": 1.0, "match@3": 0.986, "o": 0.859, "p": 0.863}
"""Li et al. 2021, test rows of their own split."""
MEMORISED = {"o": 0.902, "p": 0.896}
"""What the 127 inputs allow when every row, Duration included, is learned by heart."""

TARGETS: dict[str, dict[str, tuple[float, float | None]]] = {
    "random": {
        **{"own@1": (0.505, 0.39), "own@3": (0.795, 0.66), "hit@1": (0.97, 0.68)},
        **{"match@3": (0.965, 0.76), "o": (0.70, None), "p": (0.67, None), "NLL": (1.50, None)},
    },
    "pairs": {
        **{"own@1": (0.38, 0.32), "own@3": (0.68, 0.61), "hit@1": (0.84, 0.51)},
        **{"match@3": (0.82, 0.64), "o": (0.62, None), "p": (0.60, None), "NLL": (1.85, None)},
    },
    "objects": {
        **{"own@1": (0.32, 0.31), "own@3": (0.58, 0.555), "hit@1": (0.80, 0.49)},
        **{"match@3": (0.78, 0.59), "o": (0.60, None), "p": (0.55, None), "NLL": (2.05, None)},
    },
    "actions": {
        **{"own@1": (0.32, 0.28), "own@3": (0.575, 0.56), "hit@1": (0.80, 0.46)},
        **{"match@3": (0.80, 0.60), "o": (0.60, None), "p": (0.55, None), "NLL": (2.10, None)},
    },
}
"""Split -> metric -> (row-weighted, pair-weighted or None): the best honest models so far."""
ECE_TARGETS = {"random": 0.05, "pairs": 0.08, "objects": 0.08, "actions": 0.10}
"""Split -> calibration error of the top answer, row-weighted over all test rows."""
MARGIN = 0.01
"""The targets were chosen on these folds, so falling short by one point counts as level."""

LEAK_LIMITS = {"o": 0.75, "p": 0.75, "own@1": 0.57}
"""Row-weighted figures of a random split that honest inputs cannot exceed."""


def leaks(row_figures: dict[str, float]) -> list[str]:
    """Metrics of a random split under the honest protocol that only a leak can explain."""
    return [name for name, limit in LEAK_LIMITS.items() if row_figures[name] > limit]


def verdict(metric: str, measured: float, target: float) -> str:
    """ "met", "level" (short by at most one point) or "missed"; NLL is better when smaller."""
    gain = target - measured if metric in ("NLL", "ECE") else measured - target
    return "met" if gain >= 0 else "level" if gain >= -MARGIN else "missed"
