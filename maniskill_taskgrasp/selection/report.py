"""The report: measured figures beside targets, baselines and the paper, as one markdown page."""

from __future__ import annotations

from typing import Any

import numpy as np

from maniskill_taskgrasp.selection.splits import SPLITS
from maniskill_taskgrasp.selection.targets import (
    ECE_TARGETS,
    MEMORISED,
    PAPER,
    TARGETS,
    verdict,
)

Results = dict[str, Any]
"""What `train/selector.py` collects: {"honest": {model: {split: figures}}, "paper": ...}."""

SHOWN = ("hit@1", "match@3", "own@1", "own@3", "o", "p")
COMPARED = ("own@1", "own@3", "NLL")
LESS_IS_BETTER = ("NLL", "ECE")
RIVAL = "four"
"""The model that the targets were read from: each figure is paired with its, fold by fold."""
STANDING = {"met": "no worse", "level": "within 1 point", "missed": "worse"}


def markdown(results: Results) -> str:
    """The whole page; sections whose figures were not measured are left out."""
    parts = ["# Which grasp: measured figures", "", HOW_TO_READ]
    honest = results.get("honest", {})
    for split in SPLITS:
        if any(split in figures for figures in honest.values()):
            gaps = results.get("paired", {}).get(split, {})
            parts += ["", *_split_section(honest, split, gaps)]
    if "paper" in results:
        parts += ["", *_paper_section(results)]
    if "learning" in results:
        parts += ["", *_learning_section(results["learning"])]
    if "ceilings" in results:
        parts += ["", *_ceiling_section(results["ceilings"])]
    return "\n".join(parts) + "\n"


HOW_TO_READ = (
    "Percent, row-weighted / pair-weighted, mean over five folds; NLL in nats. "
    "`train/selector.py` wrote this page; docs/selection.md says what the figures mean. "
    "`four` is the strongest honest model before ours, the mean of trees, boosting, a perceptron "
    "and logistic regression. 95 % interval: of the row-weighted figure, had other pairs (objects, "
    "actions, rows) been filmed, drawn anew within each fold; of ECE, what a calibrated model of "
    "the same confidence and spread would score on average and at most in 95 % of cases. Label "
    "noise: deviation of the figure, had the same people done the same once more. Minus four: mean "
    "+- deviation over folds; in brackets 95 % of that mean, had other groups been filmed."
)


def _split_section(honest: Results, split: str, gaps: Results) -> list[str]:
    lines = [f"## Held out: {split}", ""]
    lines += [_row("model", *SHOWN, "NLL", "ECE"), _rule(9)]
    for model, by_split in honest.items():
        if split in by_split:
            lines.append(_model_row(model, by_split[split]))
    if split in honest.get("ours", {}):
        lines += ["", *_target_lines(honest, split, gaps)]
        lines += ["", *_paired_lines(honest, split)]
    return lines


def _model_row(model: str, figures: Results) -> str:
    cells = [_both(figures["row"][m][0], figures["pair"][m][0]) for m in SHOWN]
    cells.append(f"{figures['row']['NLL'][0]:.2f} / {figures['pair']['NLL'][0]:.2f}")
    cells.append(_both(figures["ECE"]["row"], figures["ECE"]["pair"]))
    return _row(model, *cells)


def _target_lines(honest: Results, split: str, gaps: Results) -> list[str]:
    """Each target of the split: what was measured, how sure that is, and the verdicts."""
    ours, rival = honest["ours"][split], honest.get(RIVAL, {}).get(split)
    header = ("figure of ours", "weighted by", "target", "measured", "std", "verdict")
    lines = [_row(*header, "95 % interval", "label noise", f"minus {RIVAL}"), _rule(9)]
    for metric, targets in TARGETS[split].items():
        for weighting, target in zip(("row", "pair"), targets, strict=True):
            if target is not None:
                mean, std = ours[weighting][metric]
                shown = [_one(metric, value) for value in (target, mean, std)]
                sure = _sureness(ours, metric) if weighting == "row" else ("", "")
                folds = "folds" if weighting == "row" else "pair_folds"
                gap = _gap(metric, ours[folds], rival[folds]) if rival else ""
                if weighting == "row" and metric in gaps:
                    low, high = (_signed(metric, value) for value in gaps[metric])
                    gap += f" ({low} to {high})"
                verdicts = verdict(metric, mean, target)
                lines.append(_row(metric, weighting, *shown, verdicts, *sure, gap))
    return [*lines, _calibration_line(ours, rival, split)]


def _sureness(figures: Results, metric: str) -> tuple[str, str]:
    """Interval and label noise of a row-weighted figure, empty where they were not made."""
    if metric not in figures["interval"]:
        return "", ""
    low, high = (_one(metric, value) for value in figures["interval"][metric])
    return f"{low} to {high}", _one(metric, figures["label_noise"][metric])


def _gap(metric: str, mine: Results, other: Results) -> str:
    """Mean and deviation over folds of ours minus the other, and how it stands to one point."""
    gaps = np.array(mine[metric]) - np.array(other[metric])
    standing = STANDING[verdict(metric, float(gaps.mean()), 0.0)]
    return f"{_signed(metric, gaps.mean())} +- {_one(metric, gaps.std())}: {standing}"


def _calibration_line(ours: Results, rival: Results | None, split: str) -> str:
    target, measured = ECE_TARGETS[split], ours["ECE"]["row"]
    mean, high = (_one("ECE", value) for value in ours["ECE"]["calibrated"])
    gap = measured - rival["ECE"]["row"] if rival else None
    standing = "" if gap is None else f"{_signed('ECE', gap)}: {STANDING[verdict('ECE', gap, 0.0)]}"
    cells = [_one("ECE", target), _one("ECE", measured), "", verdict("ECE", measured, target)]
    return _row("ECE, pooled", "row", *cells, f"calibrated: {mean}, up to {high}", "", standing)


def _paired_lines(honest: Results, split: str) -> list[str]:
    """Ours minus each other model on the same folds."""
    lines = [_row("ours minus", *(f"{m} row" for m in COMPARED), *(f"{m} pair" for m in COMPARED))]
    lines.append(_rule(1 + 2 * len(COMPARED)))
    for model, by_split in honest.items():
        if model == "ours" or split not in by_split:
            continue
        cells = []
        for folds in ("folds", "pair_folds"):
            for metric in COMPARED:
                mine, other = (honest[m][split][folds][metric] for m in ("ours", model))
                gaps = np.array(mine) - np.array(other)
                wins = int((gaps < 0).sum() if metric in LESS_IS_BETTER else (gaps > 0).sum())
                cells.append(f"{_signed(metric, gaps.mean())} ({wins} of {len(gaps)})")
        lines.append(_row(model, *cells))
    return [*lines, "", "In brackets: folds in which ours is better."]


def _paper_section(results: Results) -> list[str]:
    """The paper's own figures, its protocol followed here, and the same network without leaks."""
    paper = results["paper"]
    honest = results.get("honest", {}).get("paper", {}).get("random")
    ours = results.get("honest", {}).get("ours", {}).get("random")
    config = paper["config"]
    lines = [
        "## The paper's protocol, which leaks",
        "",
        f"Split after augmentation to {config['rows']:,} rows (noise {config['sigma']} deviations, "
        f"batch {config['batch']}), Duration as an input, label sets of the whole table. "
        f"Fold {config['fold'] + 1} of {config['folds']}, {config['epochs']} epochs, "
        f"seed {config['seed']}.",
        "",
        _row(
            "figure",
            "paper says",
            "paper protocol, test (LEAKING)",
            "paper network, honest random split",
            "ours, honest random split",
            "memorisation ceiling",
        ),
        _rule(6),
    ]
    columns = (
        PAPER,
        paper["test"],
        {name: both[0] for name, both in honest["row"].items()} if honest else {},
        {name: both[0] for name, both in ours["row"].items()} if ours else {},
        MEMORISED,
    )
    return lines + [
        _row(metric, *(_percent(column.get(metric)) for column in columns))
        for metric in ("hit@1", "match@3", "own@1", "o", "p")
    ]


def _learning_section(learning: Results) -> list[str]:
    lines = ["## Learning curves, by share of what is held out that training may use"]
    for split, points in learning.items():
        lines += ["", _row(f"{split} in training", "own@1", "own@3", "NLL", "ECE"), _rule(5)]
        for point in points:
            cells = [_both(*point[m]) for m in ("own@1", "own@3")]
            cells.append(f"{point['NLL'][0]:.2f} / {point['NLL'][1]:.2f}")
            lines.append(_row(f"{point['share']:.0%}", *cells, _both(*point["ECE"])))
    return lines


def _ceiling_section(ceilings: Results) -> list[str]:
    lines = ["## Noise floor: the pair's own rows, pairs with ten rows or more", ""]
    lines += [_row("knowledge", "own@1", "own@3", "o", "p"), _rule(5)]
    for name, figures in ceilings.items():
        lines.append(_row(name, *(_percent(figures[m]) for m in ("own@1", "own@3", "o", "p"))))
    return lines


def _row(*cells: object) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _rule(columns: int) -> str:
    return "|" + " --- |" * columns


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100 * value:.1f}"


def _both(row: float, pair: float) -> str:
    return f"{100 * row:.1f} / {100 * pair:.1f}"


def _one(metric: str, value: float) -> str:
    return f"{value:.2f}" if metric == "NLL" else f"{100 * value:.1f}"


def _signed(metric: str, value: float) -> str:
    return f"{value:+.2f}" if metric == "NLL" else f"{100 * value:+.1f}"
