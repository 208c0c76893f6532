"""Sentence vectors of the known names, made once and shipped, so training needs no encoder."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

import numpy as np

from maniskill_taskgrasp.knowledge import load_knowledge

FILE = "name_vectors.npz"


@cache
def name_vectors() -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """(object name -> (384,), action name -> (384,)) from the assets, half precision.

    `train/name_vectors.py` makes the file, in the order of `load_knowledge()`.
    """
    knowledge = load_knowledge()
    path = files("maniskill_taskgrasp.assets").joinpath(FILE)
    with path.open("rb") as file, np.load(file) as arrays:
        objects, actions = arrays["objects"], arrays["actions"]
    return (
        dict(zip(knowledge.objects, objects, strict=True)),
        dict(zip(knowledge.actions, actions, strict=True)),
    )
