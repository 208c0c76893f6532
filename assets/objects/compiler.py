"""Recipes turned into the facts that are shipped: `python -m ...assets.objects.compiler`.

The result, library.json, spares users the meshing: parts, mass properties and resting poses.
"""

from __future__ import annotations

import logging
import sys
from pathlib import Path

from maniskill_taskgrasp.assets.objects.library import model_from_json
from maniskill_taskgrasp.assets.objects.recipe import Recipe, load_recipes
from maniskill_taskgrasp.assets.objects.settle import settled_poses, steady_stands
from maniskill_taskgrasp.assets.objects.solid import Solid, assemble, mass_properties
from maniskill_taskgrasp.assets.objects.stable import candidate_poses
from maniskill_taskgrasp.assets.objects.store import (
    Json,
    part_to_json,
    pose_to_json,
    to_lines,
    write_atomically,
)
from maniskill_taskgrasp.knowledge import load_knowledge

logger = logging.getLogger(__name__)

LIBRARY = Path(__file__).parent / "library.json"


def stated_size(recipe: Recipe) -> tuple[float, float, float]:
    """(a, b, c) [m] of what people grasp: the data set's, with capped ones replaced."""
    a, b, c = load_knowledge().objects[recipe.name].dimensions_m
    return recipe.length or a, recipe.width or b, c


def shape(recipe: Recipe) -> Solid:
    """The recipe's object, assembled."""
    return assemble(recipe.maker(*stated_size(recipe)))


def compile_object(recipe: Recipe) -> Json:
    """JSON facts of one object; inertia is for 1 kg, so that mass stays a separate fact."""
    solid = shape(recipe)
    parts = [part for piece in solid.pieces for part in piece.parts]
    volume, com, inertia = mass_properties(solid)
    poses = candidate_poses(parts, com, inertia, solid.design_to_object)
    centre, grasped = solid.grasped_box
    return {
        "category": recipe.category,
        "material": recipe.material,
        "extents_m": solid.extents.round(6).tolist(),
        "grasped_center": (centre.round(6) + 0.0).tolist(),
        "grasped_extents_m": grasped.round(6).tolist(),
        "volume_m3": float(f"{volume:.6g}"),
        "com": (com.round(6) + 0.0).tolist(),
        "unit_inertia": (inertia.round(10) + 0.0).tolist(),
        "parts": [part_to_json(part) for part in parts],
        "resting_poses": [pose_to_json(pose) for pose in poses],
    }


def main() -> None:
    """Compile every recipe and write library.json."""
    logging.basicConfig(level=logging.INFO, stream=sys.stderr, format="%(message)s")
    objects = {name: compile_object(recipe) for name, recipe in load_recipes().items()}
    models = [model_from_json(name, data) for name, data in objects.items()]
    for model, poses in zip(models, settled_poses(models), strict=True):
        if not poses:
            raise RuntimeError(f"{model.name!r} rests in no pose that physics keeps")
        objects[model.name]["resting_poses"] = [pose_to_json(pose) for pose in poses]
    models = [model_from_json(name, data) for name, data in objects.items()]
    for model, stands in zip(models, steady_stands(models), strict=True):
        objects[model.name]["stands"] = list(stands)
    write_atomically(LIBRARY, to_lines(objects))
    logger.info("%d objects -> %s", len(objects), LIBRARY.name)


if __name__ == "__main__":
    main()
