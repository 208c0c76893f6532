"""What a checkpoint file holds, and how it is written whole, read safely and resumed exactly."""

from __future__ import annotations

import os
import pickle
import random
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import torch

from maniskill_taskgrasp.errors import InputError, echo

FORMAT = "maniskill-taskgrasp policy 1"
FINAL_NAME = "final_ckpt.pt"
NAME_PATTERN = re.compile(r"ckpt_(\d+)\.pt")
WEIGHT_NAMES = ("actor_mean.0.weight", "actor_mean.6.weight", "actor_logstd", "critic.0.weight")


def rng_state() -> dict[str, Any]:
    """State of the global generators of torch, CUDA, numpy and python, as tensors and numbers."""
    numpy_state: Any = np.random.get_state(legacy=True)  # noqa: NPY002
    _, keys, position, has_gauss, gauss = numpy_state
    version, words, next_gauss = random.getstate()
    return {
        "torch": torch.get_rng_state(),
        "cuda": torch.cuda.get_rng_state_all() if torch.cuda.is_available() else [],
        "numpy": [torch.from_numpy(keys.astype(np.int64)), position, has_gauss, gauss],
        "python": [version, torch.tensor(words), next_gauss],
    }


def set_rng_state(state: dict[str, Any]) -> None:
    """Put the global generators into a state that `rng_state` gave."""
    torch.set_rng_state(state["torch"])
    if state["cuda"]:
        torch.cuda.set_rng_state_all(state["cuda"])
    keys, position, has_gauss, gauss = state["numpy"]
    numpy_state = ("MT19937", keys.numpy().astype(np.uint32), position, has_gauss, gauss)
    np.random.set_state(numpy_state)  # noqa: NPY002
    version, words, next_gauss = state["python"]
    random.setstate((version, tuple(words.tolist()), next_gauss))


@contextmanager
def preserved_rng() -> Iterator[None]:
    """Leave the global generators as they were, whatever runs inside."""
    state = rng_state()
    try:
        yield
    finally:
        set_rng_state(state)


def save_checkpoint(path: Path, content: dict[str, Any]) -> None:
    """Write a checkpoint so that a reader sees the old file or the new one, never a part."""
    temporary = path.with_name(path.name + ".tmp")
    with temporary.open("wb") as file:
        torch.save({"format": FORMAT} | content, file)
        file.flush()
        os.fsync(file.fileno())
    temporary.replace(path)


def load_checkpoint(path: str | Path) -> dict[str, Any]:
    """Read a policy file of ours, or ManiSkill's bare weights; runs no code from it.

    Returns:
        The checkpoint; from bare weights only the keys `agent` and `config` (empty).

    Raises:
        InputError: there is no such file, or it is no intact policy.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"no policy file {echo(path)}: give a .pt file that train/ppo.py wrote")
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
    except (pickle.UnpicklingError, RuntimeError, EOFError, ValueError, KeyError, OSError) as error:
        raise InputError(
            f"{echo(path)} is damaged or no policy file: give a .pt file that train/ppo.py wrote"
        ) from error
    if isinstance(content, dict) and "actor_logstd" in content:
        content = {"agent": content, "config": {}}
    weights = content.get("agent") if isinstance(content, dict) else None
    if not isinstance(weights, dict) or not all(
        isinstance(weights.get(name), torch.Tensor) for name in WEIGHT_NAMES
    ):
        raise InputError(
            f"{echo(path)} holds no policy of ManiSkill's shape (critic.N, actor_mean.N, "
            "actor_logstd): give a .pt file that train/ppo.py wrote"
        )
    if not all(bool(torch.isfinite(weight).all()) for weight in weights.values()):
        raise InputError(f"{echo(path)} holds weights that are not finite: its training diverged")
    return content


def find_run(resume: str, runs_dir: str) -> Path:
    """The checkpoint to go on from.

    Args:
        resume: a checkpoint, a run's folder, or its name in `runs_dir`.

    Raises:
        InputError: nothing to resume is there.
    """
    for path in (Path(resume), Path(runs_dir) / resume):
        if path.is_file():
            return path
        if path.is_dir():
            return latest_checkpoint(path)
    raise InputError(f"--resume {echo(resume)}: no such run in {echo(runs_dir)}, and no such file")


def checkpoint_name(iteration: int) -> str:
    """File name of the checkpoint after an iteration."""
    return f"ckpt_{iteration}.pt"


def latest_checkpoint(run_dir: Path) -> Path:
    """The run's final checkpoint, or else the one with the highest iteration."""
    if (run_dir / FINAL_NAME).is_file():
        return run_dir / FINAL_NAME
    numbered = [
        (int(match[1]), path)
        for path in run_dir.iterdir()
        if (match := NAME_PATTERN.fullmatch(path.name))
    ]
    if not numbered:
        raise InputError(f"--resume {echo(run_dir)}: the run has no checkpoint yet, start it again")
    return max(numbered)[1]
