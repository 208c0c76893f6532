"""How often constant closing lifts eight primitives at friction 1: what fast physics must not cost.

python train/scripted.py
python train/scripted.py --search 1 --json
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

from maniskill_taskgrasp.assets.objects.folders import HOME_VARIABLE, cache_folder
from maniskill_taskgrasp.train.script import run_script

FRICTION = 1.0
DENSITY = 500.0  # [kg/m^3] 31 to 250 g: within what the pad topologies carry (grasping facts, 4).
CYLINDERS = ((0.0225, 0.16), (0.035, 0.14), (0.045, 0.14), (0.06, 0.12))
"""[m] diameter and length."""
BOXES = ((0.03, 0.04, 0.10), (0.04, 0.05, 0.10))
"""[m]"""
BALLS = (0.05, 0.065)
"""[m] diameter."""
TOPOLOGIES = (
    "Power palm abd 2-5",
    "Power pad abd 2-4",
    "Precision pad abd 2-3",
    "Precision pad abd 2-5",
)


@dataclass(frozen=True, kw_only=True)
class ScriptedConfig:
    """Measure how often constant closing lifts eight primitives at friction 1."""

    episodes: int = 20
    """Episodes for each pair of a primitive and one of four topologies."""
    search: int = 0
    """Generations of a grasp search on each primitive; 0 uses the stored grasps alone."""
    seed: int = 2026
    """Of noise (5 mm) and searches."""
    json: bool = False
    """Print one JSON document on stdout, and nothing else there."""


def run(config: ScriptedConfig) -> dict[str, Any]:
    """Measure in a temporary library of nothing but the primitives.

    Returns:
        What `taskgrasp evaluate --json` prints.

    Raises:
        InputError: no episodes, or a negative setting.
    """
    from maniskill_taskgrasp.train.evaluate import evaluate
    from maniskill_taskgrasp.train.evaluation_config import EvaluateConfig

    evaluation = EvaluateConfig(
        objects=("imported",),
        topologies=TOPOLOGIES,
        episodes=config.episodes,
        search=config.search,
        seed=config.seed,
    )
    with _library_of_primitives():
        return evaluate(evaluation)


@contextmanager
def _library_of_primitives() -> Iterator[None]:
    from maniskill_taskgrasp.assets.objects.importer import Origin, object_from_mesh
    from maniskill_taskgrasp.assets.objects.meshfile import RawMesh
    from maniskill_taskgrasp.assets.objects.userlib import save_user_object

    before = os.environ.get(HOME_VARIABLE)
    with tempfile.TemporaryDirectory() as home:
        os.environ[HOME_VARIABLE] = home
        cache_folder.cache_clear()
        try:
            for name, mesh in _meshes():
                raw = RawMesh(mesh, "m", "made in metres")
                model, _ = object_from_mesh(raw, name, DENSITY * mesh.volume, Origin("primitive"))
                save_user_object(replace(model, friction=FRICTION))
            yield
        finally:
            cache_folder.cache_clear()
            os.environ.pop(HOME_VARIABLE)
            if before is not None:
                os.environ[HOME_VARIABLE] = before


def _meshes() -> Iterator[tuple[str, Any]]:
    from trimesh import creation

    for diameter, length in CYLINDERS:
        name = f"cylinder {1000 * diameter:g} x {1000 * length:g}"
        yield name, creation.cylinder(diameter / 2, length, sections=48)
    for sides in BOXES:
        yield "box " + " x ".join(f"{1000 * side:g}" for side in sides), creation.box(sides)
    for diameter in BALLS:
        yield f"ball {1000 * diameter:g}", creation.icosphere(3, diameter / 2)


def main(config: ScriptedConfig) -> None:
    from maniskill_taskgrasp.train.tables import table_lines

    document = run(config)
    print(json.dumps(document) if config.json else "\n".join(table_lines(document)))


if __name__ == "__main__":
    run_script(main, ScriptedConfig, __doc__)
