"""Sentence vectors of the 286 object and 74 action names, for training the selector.

python train/name_vectors.py --out name_vectors.npz    # write them with the installed encoder
python train/name_vectors.py                           # compare the shipped ones with it
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.language.encoder import load_encoder
from maniskill_taskgrasp.selection.names import name_vectors
from maniskill_taskgrasp.train.script import run_script


@dataclass(frozen=True, kw_only=True)
class NameVectorsConfig:
    """Write or compare the name vectors."""

    out: Path | None = None
    """Where to write them; None compares the shipped ones."""


def main(config: NameVectorsConfig) -> None:
    encoder = load_encoder()
    parts = zip(("objects", "actions"), name_vectors(), strict=True)
    found = {kind: (encoder.encode(list(known)), known) for kind, known in parts}
    if config.out is not None:
        partial = config.out.with_name(config.out.name + ".partial.npz")
        objects, actions = (found[kind][0].astype(np.float16) for kind in ("objects", "actions"))
        np.savez_compressed(partial, objects=objects, actions=actions)
        partial.replace(config.out)
        return
    for kind, (vectors, known) in found.items():
        cosines = (vectors * np.stack(list(known.values())).astype(float)).sum(1)
        print(f"{kind}: cosine with the shipped vectors at least {cosines.min():.5f}")


if __name__ == "__main__":
    run_script(main, NameVectorsConfig)
