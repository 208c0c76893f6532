"""The report's pictures: thresholds, confusion, training time, learning curves, sureness."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from maniskill_taskgrasp.selection.targets import ECE_TARGETS, MEMORISED, PAPER, TARGETS
from maniskill_taskgrasp.topology import OPPOSITIONS, PIPS

SPLIT_COLOURS = ("tab:blue", "tab:green")


def write_figures(results: dict[str, Any], folder: Path) -> list[Path]:
    """Draw what was measured as PNG files; returns their paths."""
    import matplotlib as mpl

    mpl.use("Agg")
    written = []
    honest = results.get("honest", {}).get("paper", {})
    if "paper" in results:
        written.append(_training_time(results["paper"]["curve"], folder / "training_time.png"))
    if honest:
        leaking = results.get("paper")
        written.append(_thresholds(honest, leaking, folder / "thresholds.png"))
        written.append(_confusion(honest, leaking, folder / "confusion.png"))
    ours = results.get("honest", {}).get("ours", {})
    if ours:
        floor = results.get("ceilings", {}).get("left out", {}).get("own@1")
        written.append(_sureness(ours, floor, folder / "sureness.png"))
    if "learning" in results:
        written.append(_learning(results["learning"], folder / "learning.png"))
    return written


def _training_time(curve: list[dict[str, float]], path: Path) -> Path:
    """o and p over epochs under the leaking protocol, beside the paper's and the ceiling."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 4.2))
    epochs = [point["epoch"] for point in curve]
    for metric, colour in (("o", "tab:blue"), ("p", "tab:orange")):
        axes.plot(epochs, [100 * p[metric] for p in curve], color=colour, label=f"{metric}, test")
        train = [100 * p[f"train_{metric}"] for p in curve]
        axes.plot(epochs, train, color=colour, linestyle=":", label=f"{metric}, training")
        axes.axhline(100 * PAPER[metric], color=colour, linestyle="--", linewidth=0.8)
    axes.axhline(100 * MEMORISED["o"], color="grey", linewidth=0.8)
    axes.text(epochs[-1], 100 * MEMORISED["o"] + 0.3, "memorisation ceiling", ha="right")
    axes.text(epochs[-1], 100 * PAPER["p"] + 0.3, "paper, 5,000 epochs (dashed)", ha="right")
    axes.set(xlabel="epochs", ylabel="accuracy [%]", title="Paper protocol: the test leaks")
    axes.legend(loc="lower right")
    return _saved(figure, path)


def _thresholds(honest: dict[str, Any], leaking: dict[str, Any] | None, path: Path) -> Path:
    """Micro precision, recall and F1 of the label sets over the threshold (their Fig. 7)."""
    import matplotlib.pyplot as plt

    panels = {f"honest: {split}": figures["thresholds"] for split, figures in honest.items()}
    if leaking:
        panels = {"paper protocol (leaks)": leaking["thresholds"], **panels}
    figure, axes = plt.subplots(1, len(panels), figsize=(3.1 * len(panels), 3.2), sharey=True)
    for axis, (title, points) in zip(_each(axes), panels.items(), strict=True):
        for name in ("precision", "recall", "f1"):
            axis.plot([p["threshold"] for p in points], [p[name] for p in points], label=name)
        axis.set(xlabel="threshold", title=title, ylim=(0, 1))
    _each(axes)[0].legend(loc="lower left")
    return _saved(figure, path)


def _confusion(honest: dict[str, Any], leaking: dict[str, Any] | None, path: Path) -> Path:
    """Row-normalised confusion of the opposition and PIP heads (their Fig. 6)."""
    import matplotlib.pyplot as plt
    import numpy as np

    columns = {f"honest: {split}": figures["confusion"] for split, figures in honest.items()}
    if leaking:
        columns = {"paper protocol (leaks)": leaking["confusion"], **columns}
    size = (3.0 * len(columns), 6.0)
    figure, grid = plt.subplots(2, len(columns), figsize=size, squeeze=False)
    heads = (("opposition", OPPOSITIONS), ("pip", PIPS))
    for column, (title, matrices) in enumerate(columns.items()):
        for row, (head, names) in enumerate(heads):
            counts = np.array(matrices[head], float)
            shares = counts / np.maximum(counts.sum(1, keepdims=True), 1)
            axis = grid[row][column]
            axis.imshow(shares, cmap="Blues", vmin=0, vmax=1)
            for (i, j), share in np.ndenumerate(shares):
                colour = "white" if share > 0.5 else "black"
                axis.text(j, i, f"{share:.2f}", ha="center", va="center", color=colour)
            axis.set_xticks(range(3), names, rotation=30)
            axis.set_yticks(range(3), names)
            axis.set(xlabel="predicted", ylabel="observed", title=title if row == 0 else "")
    return _saved(figure, path)


def _learning(curves: dict[str, list[dict[str, Any]]], path: Path) -> Path:
    """Row-weighted figures on new pairs and objects over the share trained on, with the targets."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6))
    for axis, metric in zip(axes, ("own@1", "NLL", "ECE"), strict=True):
        scale = 1 if metric == "NLL" else 100
        for (split, points), colour in zip(curves.items(), SPLIT_COLOURS, strict=False):
            shares = [100 * point["share"] for point in points]
            values = [scale * point[metric][0] for point in points]
            axis.plot(shares, values, color=colour, marker="o", label=f"new {split}")
            axis.axhline(
                scale * _target(split, metric), color=colour, linestyle="--", linewidth=0.8
            )
        axis.set(xlabel="share of them in training [%]", title=f"{metric}, by rows")
    axes[0].legend(title="dashed: target")
    return _saved(figure, path)


def _sureness(ours: dict[str, Any], floor: float | None, path: Path) -> Path:
    """Figures by rows with the spread that the choice of what was filmed gives them.

    `floor` is the own@1 of one who knows the pair's other rows.
    """
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6))
    for axis, metric in zip(axes, ("own@1", "NLL", "ECE"), strict=True):
        scale = 1 if metric == "NLL" else 100
        axis.use_sticky_edges = False
        for place, (split, figures) in enumerate(ours.items()):
            measured, (low, high) = _with_range(figures, metric)
            axis.bar(place, scale * (high - low), 0.25, scale * low, color="lightsteelblue")
            axis.plot(place, scale * measured, "o", color="tab:blue")
            axis.plot(place, scale * _target(split, metric), "_", color="tab:red", markersize=22)
        axis.set_xticks(range(len(ours)), list(ours))
        axis.set(xlim=(-0.5, len(ours) - 0.5), title=f"{metric}, by rows")
    if floor is not None:
        axes[0].axhline(100 * floor, color="grey", linewidth=0.8)
        axes[0].text(
            3.45, 100 * floor + 0.2, "other rows of the pair known", ha="right", fontsize=7
        )
    axes[0].set_ylabel("dot: ours; dash: target; bar: 95 %", fontsize=8)
    axes[2].set_ylabel("bar: 95 % of calibrated models", fontsize=8)
    return _saved(figure, path)


def _with_range(figures: dict[str, Any], metric: str) -> tuple[float, tuple[float, float]]:
    """A row-weighted figure and the range in which chance puts it."""
    if metric == "ECE":
        return figures["ECE"]["row"], (0.0, figures["ECE"]["calibrated"][1])
    low, high = figures["interval"][metric]
    return figures["row"][metric][0], (low, high)


def _target(split: str, metric: str) -> float:
    return ECE_TARGETS[split] if metric == "ECE" else TARGETS[split][metric][0]


def _each(axes: Any) -> list[Any]:
    return list(axes.flat) if hasattr(axes, "flat") else [axes]


def _saved(figure: Any, path: Path) -> Path:
    import matplotlib.pyplot as plt

    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path
