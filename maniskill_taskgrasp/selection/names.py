"""Sentence vectors of the known names, made once and shipped, so training needs no encoder."""

from __future__ import annotations

from importlib.resources import files

import numpy as np

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.selection.features import FeatureEncoder, NameProjection

OBJECT_NAME_WIDTH = 48
ACTION_NAME_WIDTH = 32
"""Directions kept of the 384: facts measured with these in the first baselines."""


def name_vectors() -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """(object name -> (384,), action name -> (384,)) from `assets/name_vectors.npz`."""
    path = files("maniskill_taskgrasp.assets").joinpath("name_vectors.npz")
    knowledge = load_knowledge()
    with path.open("rb") as file, np.load(file) as arrays:
        objects, actions = arrays["objects"], arrays["actions"]
    return (
        dict(zip(knowledge.objects, objects, strict=True)),
        dict(zip(knowledge.actions, actions, strict=True)),
    )


def default_encoder() -> FeatureEncoder:
    """The feature encoder over all known names."""
    objects, actions = name_vectors()
    return FeatureEncoder(
        objects=NameProjection.fit(objects, OBJECT_NAME_WIDTH),
        actions=NameProjection.fit(actions, ACTION_NAME_WIDTH),
    )
