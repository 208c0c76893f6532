"""Makes a shipped policy of a run's checkpoint: what acting needs, without the optimiser.

python train/ship.py runs/noisy_1/final_ckpt.pt assets/checkpoints/policy_distance.pt
"""

from __future__ import annotations

from pathlib import Path

import tyro
from tyro.conf import Positional

from maniskill_taskgrasp.train.checkpoint import load_checkpoint, save_checkpoint

KEPT = ("agent", "normalizer", "config", "iteration", "global_step", "seconds")


def ship(checkpoint: Positional[Path], out: Positional[Path]) -> None:
    """Write the acting part of `checkpoint` to `out`.

    Raises:
        InputError: the file is no checkpoint.
    """
    content = load_checkpoint(checkpoint)
    content["config"].pop("runs_dir", None)  # Says where somebody's disk is, nothing else.
    save_checkpoint(out, {name: content[name] for name in KEPT if name in content})
    print(f"{out}: {out.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    tyro.cli(ship)
