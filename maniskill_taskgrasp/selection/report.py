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


def markdown(results: Results) -> str:
    """The whole page; sections whose figures were not measured are left out."""
    parts = ["# Which grasp: measured figures", "", HOW_TO_READ]
    honest = results.get("honest", {})
    for split in SPLITS:
        if any(split in figures for figures in honest.values()):
            parts += ["", *_split_section(honest, split)]
    if "paper" in results:
        parts += ["", *_paper_section(results)]
    if "learning" in results:
        parts += ["", *_learning_section(results["learning"])]
    if "ceilings" in results:
        parts += ["", *_ceiling_section(results["ceilings"])]
    return "\n".join(parts) + "\n"


HOW_TO_READ = (
    "Percent, row-weighted / pair-weighted, mean over five folds; NLL in nats. "
    "`train/selector.py` wrote this page; docs/selection.md says what the figures mean."
)


def _split_section(honest: Results, split: str) -> list[str]:
    lines = [f"## Held out: {split}", ""]
    lines += [_row("model", *SHOWN, "NLL", "ECE"), _rule(9)]
    for model, by_split in honest.items():
        if split in by_split:
            lines.append(_model_row(model, by_split[split]))
    if split in honest.get("ours", {}):
        lines += ["", *_target_lines(honest["ours"][split], split)]
        lines += ["", *_paired_lines(honest, split)]
    return lines


def _model_row(model: str, figures: Results) -> str:
    cells = [_both(figures["row"][m][0], figures["pair"][m][0]) for m in SHOWN]
    cells.append(f"{figures['row']['NLL'][0]:.2f} / {figures['pair']['NLL'][0]:.2f}")
    cells.append(_both(figures["ECE"]["row"], figures["ECE"]["pair"]))
    return _row(model, *cells)


def _target_lines(ours: Results, split: str) -> list[str]:
    """Each target of the split with what was measured and the verdict."""
    lines = [_row("ours: figure", "weighted by", "target", "measured", "std", "verdict"), _rule(6)]
    for metric, targets in TARGETS[split].items():
        for weighting, target in zip(("row", "pair"), targets, strict=True):
            if target is not None:
                mean, std = ours[weighting][metric]
                shown = [_one(metric, value) for value in (target, mean, std)]
                lines.append(_row(metric, weighting, *shown, verdict(metric, mean, target)))
    target, mean = ECE_TARGETS[split], ours["ECE"]["row"]
    shown = [_one("ECE", target), _one("ECE", mean)]
    lines.append(_row("ECE, pooled", "row", *shown, "", verdict("ECE", mean, target)))
    return lines


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
    last = paper["curve"][-1]
    honest = results.get("honest", {}).get("paper", {}).get("random")
    ours = results.get("honest", {}).get("ours", {}).get("random")
    config = paper["config"]
    lines = [
        "## The paper's protocol, which leaks",
        "",
        f"Split after augmentation to {config['rows']:,} rows (noise {config['sigma']} deviations, "
        f"batch {config['batch']}), Duration as an input, label sets of the whole table. "
        f"Fold {config['fold'] + 1} of {config['folds']}, {last['epoch']} epochs, "
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
        last,
        {name: both[0] for name, both in honest["row"].items()} if honest else {},
        {name: both[0] for name, both in ours["row"].items()} if ours else {},
        MEMORISED,
    )
    return lines + [
        _row(metric, *(_percent(column.get(metric)) for column in columns))
        for metric in ("hit@1", "match@3", "own@1", "o", "p")
    ]


def _learning_section(learning: list[Results]) -> list[str]:
    lines = ["## Learning curve: new objects, by share of the training objects", ""]
    lines += [_row("objects in training", "own@1", "own@3", "NLL"), _rule(4)]
    for point in learning:
        cells = [_both(*point[m]) for m in ("own@1", "own@3")]
        cells.append(f"{point['NLL'][0]:.2f} / {point['NLL'][1]:.2f}")
        lines.append(_row(f"{point['share']:.0%}", *cells))
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
