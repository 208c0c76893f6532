"""Train the grasp-topology selector on the authors' CSV, and ship it.

python train/selector.py --dataset task-object_grasp_dataset.csv
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import torch
import tyro

from maniskill_taskgrasp.selection.checkpoint import (
    FORMAT,
    pack_ensemble,
    pack_projection,
    save_checkpoint,
)
from maniskill_taskgrasp.selection.dataset import load_table
from maniskill_taskgrasp.selection.evidence import condense, count_pairs
from maniskill_taskgrasp.selection.fit import EnsembleConfig, fit_ensemble
from maniskill_taskgrasp.selection.names import default_encoder

CHECKPOINTS = Path(__file__).resolve().parent.parent / "assets" / "checkpoints"


@dataclass(frozen=True, kw_only=True)
class SelectorConfig:
    """Train the grasp-topology selector."""

    dataset: Path
    """The authors' CSV (`taskgrasp data fetch` gets it)."""
    out: Path = CHECKPOINTS / "selector.pt"
    """Where to write the checkpoint."""
    shrink: float = 3.0
    """Rows that the network's opinion is worth beside human evidence of the same pair."""
    network: EnsembleConfig = field(default_factory=EnsembleConfig)


def main(config: SelectorConfig) -> None:
    torch.set_num_threads(1)
    table = load_table(config.dataset).without_platform()
    encoder = default_encoder()
    evidence = condense(table, encoder)
    ensemble = fit_ensemble(evidence.features, evidence.counts, encoder.blocks, config.network)
    pairs = count_pairs(table)
    save_checkpoint(
        config.out,
        {
            "format": FORMAT,
            "config": asdict(config.network),
            "measured": {},
            "objects": pack_projection(encoder.objects),
            "actions": pack_projection(encoder.actions),
            "ensemble": pack_ensemble(ensemble),
            "pairs": [list(pair) for pair in pairs],
            "counts": torch.from_numpy(np.stack(list(pairs.values()))).short(),
            "shrink": config.shrink,
        },
    )
    print(f"trained on {len(table)} rows, {len(pairs)} pairs; wrote {config.out.name}")


if __name__ == "__main__":
    main(tyro.cli(SelectorConfig))
