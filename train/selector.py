"""Train and score the grasp-topology selector on the authors' CSV.

python train/selector.py --dataset CSV --ship                        # the shipped checkpoint
python train/selector.py --dataset CSV --model all --split all       # honest protocol
python train/selector.py --dataset CSV --model paper --protocol paper --paper.epochs 200
python train/selector.py --dataset CSV --learning-curve              # would more data help?

Every run adds its figures to the report folder and rewrites report.md and its pictures there.
Interrupted runs go on where they stopped: finished folds and epochs are kept in the work folder.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

import torch
from tqdm import tqdm

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.selection.ceiling import ceilings
from maniskill_taskgrasp.selection.dataset import GraspTable, load_table
from maniskill_taskgrasp.selection.figures import write_figures
from maniskill_taskgrasp.selection.fit import EnsembleConfig
from maniskill_taskgrasp.selection.learning import CURVES, SHARES, learning_curve
from maniskill_taskgrasp.selection.models import all_models
from maniskill_taskgrasp.selection.paper_protocol import PaperConfig, train_leaking
from maniskill_taskgrasp.selection.recipe import Recipe, fit_selector
from maniskill_taskgrasp.selection.report import RIVAL, markdown
from maniskill_taskgrasp.selection.scoring import evaluate, paired_intervals
from maniskill_taskgrasp.selection.splits import FOLDS, SPLITS
from maniskill_taskgrasp.selection.targets import leaks
from maniskill_taskgrasp.selection.tuning import tuned
from maniskill_taskgrasp.train.script import run_script

CHECKPOINT = Path(__file__).resolve().parent.parent / "assets" / "checkpoints" / "selector.npz"


@dataclass(frozen=True, kw_only=True)
class SelectorConfig:
    """Train and score the grasp-topology selector."""

    dataset: Path
    """The authors' CSV (`taskgrasp data fetch` gets it)."""
    model: str = "ours"
    """A model's name, several joined by commas, or "all"."""
    split: Literal["random", "pairs", "objects", "actions", "all", "none"] = "none"
    """What is held out under the honest protocol; "none" scores nothing."""
    protocol: Literal["honest", "paper"] = "honest"
    """"paper" splits after augmentation and keeps Duration, as published; its test leaks."""
    paper: PaperConfig = field(default_factory=PaperConfig)
    """The paper protocol's recipe."""
    learning_curve: bool = False
    """Score our recipe on new pairs and objects with ever more of them in training."""
    ship: bool = False
    """Train on all rows and write the checkpoint."""
    out: Path = CHECKPOINT
    """Where --ship writes."""
    report: Path = Path("runs/selection/report")
    """Folder of results.json, report.md and the pictures."""
    work: Path = Path("runs/selection/work")
    """Folder of finished folds and epochs; remove it to start afresh."""
    seed: int = 0
    threads: int = 1


def score(config: SelectorConfig, table: GraspTable, results: dict[str, Any]) -> None:
    """Score the named models under the honest protocol."""
    models = all_models(config.seed)
    names = list(models) if config.model == "all" else config.model.split(",")
    for name in names:
        if name not in models:
            raise InputError(f"unknown model {name!r}: use {', '.join(models)} or all")
    splits = SPLITS if config.split == "all" else (config.split,)
    work = config.work / f"seed{config.seed}"
    honest = results.setdefault("honest", {})
    for split in splits:
        for name in tqdm(names, desc=f"held out: {split}", unit="model"):
            figures = evaluate(name, models[name], table, split, work)
            honest.setdefault(name, {})[split] = figures
            found = leaks({k: v[0] for k, v in figures["row"].items()}) if split == "random" else []
            if found:
                raise InputError(f"{name} on a random split is too good to be true: {found}")
        if {"ours", RIVAL} <= set(names):
            gaps = paired_intervals("ours", RIVAL, models, table, split, work)
            results.setdefault("paired", {})[split] = gaps
    results["honest"] = {name: honest[name] for name in models if name in honest}


def follow_paper(config: SelectorConfig, table: GraspTable, results: dict[str, Any]) -> None:
    """Train the paper's network under its own, leaking protocol."""
    config.work.mkdir(parents=True, exist_ok=True)
    key = f"{config.paper.rows}_{config.paper.sigma}_{config.paper.batch}_{config.paper.fold}"
    with tqdm(total=config.paper.epochs, unit="epoch") as bar:

        def watch(point: dict[str, float]) -> None:
            bar.n = int(point["epoch"])
            bar.set_postfix({name: f"{point[name]:.3f}" for name in ("hit@1", "match@3", "o", "p")})

        state = config.work / f"paper_{key}_{config.paper.seed}.pt"
        curve, last = train_leaking(table, config.paper, state, watch)
    results["paper"] = {"config": asdict(config.paper), "curve": curve, **last}


def ship(config: SelectorConfig, table: GraspTable) -> None:
    """Tune on all kinds of news, train on all rows, write the checkpoint."""
    start = Recipe(perceptrons=EnsembleConfig(seed=config.seed))
    recipe = tuned(SPLITS, table, start)
    selector = fit_selector(table, recipe)
    card = {"rows": len(table), "recipe": json.loads(json.dumps(asdict(recipe)))}
    selector.save(config.out, card)
    settings = f"share {recipe.share}, temperature {recipe.temperature}, shrink {recipe.shrink}"
    print(f"trained on {len(table)} rows ({settings}); wrote {config.out}")


def _rounded(results: dict[str, Any]) -> dict[str, Any]:
    """Floats to five digits, so that the committed file stays small and diffs stay readable."""
    return json.loads(json.dumps(results), parse_float=lambda text: round(float(text), 5))


def main(config: SelectorConfig) -> None:
    torch.set_num_threads(config.threads)
    table = load_table(config.dataset).without_platform()
    if config.ship:
        ship(config, table)
    config.report.mkdir(parents=True, exist_ok=True)
    path = config.report / "results.json"
    results = json.loads(path.read_text("utf-8")) if path.exists() else {}
    if config.protocol == "paper":
        follow_paper(config, table, results)
    elif config.split != "none":
        score(config, table, results)
    if config.learning_curve:
        recipe = Recipe(perceptrons=EnsembleConfig(seed=config.seed))
        with tqdm(total=len(CURVES) * len(SHARES) * FOLDS, unit="fit") as bar:
            results["learning"] = {
                split: learning_curve(table, split, recipe, config.seed, bar.update)
                for split in CURVES
            }
    results["ceilings"] = ceilings(table)
    results = _rounded(results)
    partial = path.with_suffix(".partial")
    partial.write_text(json.dumps(results, indent=1) + "\n", "utf-8")
    partial.replace(path)
    (config.report / "report.md").write_text(markdown(results), "utf-8")
    for picture in write_figures(results, config.report):
        print(f"wrote {picture}")


if __name__ == "__main__":
    run_script(main, SelectorConfig)
