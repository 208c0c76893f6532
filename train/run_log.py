"""Where a run's numbers go: TensorBoard, Weights and Biases, CSV files and the progress bar."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from typing import Any

from tqdm import tqdm

from maniskill_taskgrasp.train.ppo_config import PPOConfig

CURVE_NAME = "curve.csv"  # One row an iteration.
EVALUATIONS_NAME = "evaluations.csv"  # One row an evaluation.


def note(text: str) -> None:
    """Tell the user something, without tearing the progress bar."""
    tqdm.write(text, file=sys.stderr)


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write a JSON file whole."""
    temporary = path.with_name(path.name + ".tmp")
    temporary.write_text(json.dumps(content, indent=2, sort_keys=True) + "\n")
    temporary.replace(path)


class CurveFile:
    """A CSV table of one row per iteration, rewritten whole so that a kill leaves no torn row."""

    def __init__(self, path: Path, upto_iteration: int) -> None:
        self._path = path
        self._rows: list[dict[str, Any]] = []
        if path.is_file():
            with path.open(newline="") as file:
                rows = list(csv.DictReader(file))
            self._rows = [row for row in rows if int(row["iteration"]) <= upto_iteration]

    def append(self, row: dict[str, Any]) -> None:
        """Add a row; columns that appear later are empty in earlier rows."""
        self._rows.append(row)
        columns = dict.fromkeys(name for each in self._rows for name in each)
        temporary = self._path.with_name(self._path.name + ".tmp")
        with temporary.open("w", newline="") as file:
            writer = csv.DictWriter(file, list(columns), restval="")
            writer.writeheader()
            writer.writerows(self._rows)
        temporary.replace(self._path)


def _tensorboard(run_dir: Path, global_step: int) -> Any:
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError:
        note(f"tensorboard is not installed (pip install tensorboard): curves are in {CURVE_NAME}")
        return None
    return SummaryWriter(str(run_dir), purge_step=global_step + 1 if global_step else None)


def _wandb(config: PPOConfig, run_dir: Path, settings: dict[str, Any]) -> Any:
    import wandb

    return wandb.init(
        project=config.wandb_project_name,
        entity=config.wandb_entity,
        group=config.wandb_group,
        name=run_dir.name,
        id="".join(letter if letter.isalnum() else "-" for letter in run_dir.name),
        resume="allow",
        config=settings,
        dir=str(run_dir),
    )


class RunLog:
    """Logs of one run; a resumed run continues them where its checkpoint was written."""

    def __init__(
        self,
        run_dir: Path,
        config: PPOConfig,
        settings: dict[str, Any],
        iteration: int,
        global_step: int,
    ) -> None:
        self._wandb = _wandb(config, run_dir, settings) if config.track else None
        self._tensorboard = _tensorboard(run_dir, global_step)
        if self._tensorboard is not None and global_step == 0:
            rows = "\n".join(f"|{name}|{value}|" for name, value in settings.items())
            self._tensorboard.add_text("hyperparameters", f"|param|value|\n|-|-|\n{rows}")
        self._curve = CurveFile(run_dir / CURVE_NAME, iteration)
        self._evaluations = CurveFile(run_dir / EVALUATIONS_NAME, iteration)
        self._bar = tqdm(
            total=config.num_iterations * config.batch_size,
            initial=global_step,
            unit="step",
            unit_scale=True,
            desc=config.env_id,
            mininterval=1.0,
        )
        self._shown: dict[str, str] = {}

    def _scalars(self, scalars: dict[str, float], global_step: int) -> None:
        if self._tensorboard is not None:
            for tag, value in scalars.items():
                self._tensorboard.add_scalar(tag, value, global_step)
        if self._wandb is not None:
            self._wandb.log(scalars, step=global_step)

    def iteration(self, iteration: int, global_step: int, scalars: dict[str, float]) -> None:
        """Log one rollout and update, and move the progress bar."""
        self._scalars(scalars, global_step)
        self._curve.append({"iteration": iteration, "step": global_step} | scalars)
        for tag, label in (("train/success_once", "success"), ("train/return", "return")):
            if tag in scalars:
                self._shown[label] = f"{scalars[tag]:.3g}"
        self._shown["SPS"] = f"{scalars['charts/SPS']:.0f}"
        self._bar.set_postfix(self._shown, refresh=False)
        self._bar.update(global_step - self._bar.n)

    def evaluation(self, iteration: int, global_step: int, summary: dict[str, Any]) -> None:
        """Log one evaluation; intervals go to the CSV file as two columns."""
        means = {name: value for name, value in summary.items() if isinstance(value, float)}
        self._scalars({f"eval/{name}": value for name, value in means.items()}, global_step)
        bounds = {
            f"{name}_{side}": value
            for name, pair in summary.items()
            if isinstance(pair, list)
            for side, value in zip(("low", "high"), pair, strict=True)
        }
        row = {"iteration": iteration, "step": global_step, "episodes": summary["episodes"]}
        self._evaluations.append(row | means | bounds)

    def close(self) -> None:
        """Flush everything."""
        self._bar.close()
        if self._tensorboard is not None:
            self._tensorboard.close()
        if self._wandb is not None:
            self._wandb.finish()
