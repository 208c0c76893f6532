"""PPO on any ManiSkill task: what the command line asks for becomes a run folder and a policy.

python train/ppo.py --env-id TaskGrasp-v0 --total-timesteps 50000
python train/ppo.py --preset paper --topology "precision pad abd 2-3"
python train/ppo.py --resume RUN
torchrun --nproc-per-node 2 train/ppo.py --env-id TaskGrasp-v0
"""

from __future__ import annotations

import os
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import torch
import tyro

from maniskill_taskgrasp.errors import InputError, echo
from maniskill_taskgrasp.train.checkpoint import (
    FINAL_NAME,
    checkpoint_name,
    find_run,
    load_checkpoint,
)
from maniskill_taskgrasp.train.distributed import Processes, join_processes
from maniskill_taskgrasp.train.policy import check_shapes, interface_kwargs
from maniskill_taskgrasp.train.policy_eval import Evaluation
from maniskill_taskgrasp.train.ppo_config import TASK_GRASP, PPOConfig, check_config, default_config
from maniskill_taskgrasp.train.run_log import note, write_json
from maniskill_taskgrasp.train.trainer import EnvFactories, Trainer

RESULT_NAME = "result.json"
# A resumed run may change these; anything else would make it another run.
RESUMABLE = {
    "resume",
    "runs_dir",
    "total_timesteps",
    "track",
    "wandb_project_name",
    "wandb_entity",
    "wandb_group",
    "capture_video",
}


@dataclass(frozen=True)
class TrainResult:
    """What a run left behind."""

    run_dir: Path
    evaluation: Evaluation


def stored_config(checkpoint: dict[str, Any]) -> PPOConfig:
    """The configuration a checkpoint was trained with.

    Raises:
        InputError: the file holds weights only, or was written by another version.
    """
    if "optimizer" not in checkpoint:
        raise InputError(
            "--resume needs a checkpoint of train/ppo.py; give weights by --checkpoint"
        )
    values: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in checkpoint["config"].items()
    }
    try:
        return PPOConfig(**values)
    except TypeError as error:
        raise InputError(
            f"the checkpoint is of another version of train/ppo.py: {error}"
        ) from error


def parse_config(arguments: list[str]) -> PPOConfig:
    """Flags over what they start from: a resumed run's own, a preset's, or the task's defaults."""
    has_cuda = torch.cuda.is_available()
    start = default_config(TASK_GRASP, None, has_cuda)
    first = tyro.cli(PPOConfig, description=__doc__, args=arguments, default=start)
    if first.resume is not None:
        stored = stored_config(load_checkpoint(find_run(first.resume, first.runs_dir)))
        config = tyro.cli(PPOConfig, args=arguments, default=stored)
        before, after = asdict(stored), asdict(config)
        changed = [name for name in after if before[name] != after[name] and name not in RESUMABLE]
        if changed:
            flags = ", ".join("--" + name.replace("_", "-") for name in changed)
            raise InputError(
                f"--resume goes on with the run's own settings, not with another {flags}: "
                "start a new run from its weights with --checkpoint"
            )
        return config
    default = default_config(first.env_id, first.preset, has_cuda and first.cuda)
    if first.checkpoint is not None:
        default = replace(default, **interface_kwargs(load_checkpoint(first.checkpoint)))
    return tyro.cli(PPOConfig, args=arguments, default=default)


def run_folder(config: PPOConfig, checkpoint_path: Path | None) -> Path:
    """The run's folder: the resumed one's, or a name for a new one.

    Raises:
        InputError: the name given by --exp-name is taken.
    """
    if checkpoint_path is not None:
        return checkpoint_path.parent
    task = config.env_id.rpartition(":")[2]
    name = config.exp_name or f"{task}__ppo__{config.seed}__{int(time.time())}"
    folder = Path(config.runs_dir) / name
    if folder.exists():
        raise InputError(
            f"{echo(folder)} exists: choose another --exp-name, or go on with --resume {name}"
        )
    return folder


def train(config: PPOConfig, factories: EnvFactories | None = None) -> TrainResult:
    """Train, resume or evaluate as configured; one call per process of torchrun.

    Raises:
        InputError: the configuration cannot run; says what would do.
    """
    use_cuda = config.cuda and torch.cuda.is_available()
    check_config(config, int(os.environ.get("WORLD_SIZE", "1")))
    torch.set_num_threads(config.torch_threads)
    torch.backends.cudnn.deterministic = config.torch_deterministic
    checkpoint_path = find_run(config.resume, config.runs_dir) if config.resume else None
    processes = join_processes(use_cuda)
    try:
        run_dir = processes.gather(run_folder(config, checkpoint_path))[0]
        device = torch.device("cuda", processes.local_rank) if use_cuda else torch.device("cpu")
        trainer = Trainer(config, processes, factories or EnvFactories(), run_dir, device)
        try:
            evaluation = _run(trainer, checkpoint_path)
        finally:
            trainer.close()
    finally:
        processes.close()
    return TrainResult(run_dir, evaluation)


def _run(trainer: Trainer, checkpoint_path: Path | None) -> Evaluation:
    config, run_dir = trainer.config, trainer.run_dir
    if checkpoint_path is not None:
        _take_up(trainer, checkpoint_path)
    elif config.checkpoint is not None:
        checkpoint = load_checkpoint(config.checkpoint)
        check_shapes(checkpoint, config.checkpoint, trainer.agent)
        trainer.load_weights(checkpoint)
    main = trainer.processes.is_main
    if main:
        run_dir.mkdir(parents=True, exist_ok=True)
        write_json(run_dir / "config.json", asdict(config))
    if config.evaluate:
        evaluation = trainer.evaluate()
        if main:
            note(evaluation.headline())
            if config.capture_video:
                trainer.film("evaluation", trajectory=True)
    else:
        evaluation = trainer.run()
    if main:
        result = {
            "evaluation": evaluation.summary(),
            "global_step": trainer.global_step,
            "seconds": round(trainer.seconds, 1),
            "processes": trainer.processes.world_size,
            "torch": torch.__version__,
            "config": asdict(config),
        }
        write_json(run_dir / RESULT_NAME, result)
        note(f"results in {run_dir}")
    return evaluation


def _take_up(trainer: Trainer, path: Path) -> None:
    checkpoint = load_checkpoint(path)
    processes: Processes = trainer.processes
    if len(checkpoint["rng"]) != processes.world_size:
        raise InputError(
            f"the run used {len(checkpoint['rng'])} processes, not {processes.world_size}: "
            f"resume it with torchrun --nproc-per-node {len(checkpoint['rng'])}"
        )
    trainer.resume(checkpoint)
    final = path.parent / FINAL_NAME
    unfinished = trainer.iteration < trainer.config.num_iterations
    if processes.is_main and path == final and unfinished:
        # A longer budget than before: what was the end is a checkpoint on the way.
        final.replace(path.parent / checkpoint_name(trainer.iteration))


def main() -> None:
    """Entry point of the script; a user's mistake is one line and exit code 2."""
    is_main = os.environ.get("RANK", "0") == "0"
    try:
        train(parse_config(sys.argv[1:]))
    except InputError as error:
        if is_main:
            print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        if is_main:
            print("stopped: go on with --resume RUN", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
