"""Which objects there are, and how one is got by name or from a mesh file."""

from __future__ import annotations

import json
from functools import cache, partial
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.assets.objects.meshfile import SUFFIXES
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.assets.objects.recipe import FRICTION
from maniskill_taskgrasp.assets.objects.store import Json, part_from_json, pose_from_json
from maniskill_taskgrasp.assets.objects.userlib import cached_import, load_user_object, user_names
from maniskill_taskgrasp.errors import unknown_name
from maniskill_taskgrasp.knowledge import load_knowledge

if TYPE_CHECKING:
    import trimesh

SPLITS = ("train", "test")


@cache
def _catalogue() -> dict[str, Json]:
    folder = files("maniskill_taskgrasp.assets.objects")
    objects: dict[str, Json] = json.loads(folder.joinpath("library.json").read_text("utf-8"))
    return objects


@cache
def _split() -> dict[str, str]:
    folder = files("maniskill_taskgrasp.assets.objects")
    lists = json.loads(folder.joinpath("split.json").read_text("utf-8"))
    return {name: split for split in SPLITS for name in lists[split]}


def names(split: str | None = None) -> tuple[str, ...]:
    """Sorted names of objects.

    Args:
        split: "train" or "test"; None or "all" for both; "imported" for the user's own.

    Raises:
        InputError: no split has that name.
    """
    known = ("all", *SPLITS, "imported")
    if split not in (None, *known):
        raise unknown_name("split", split, known, "taskgrasp objects list --help")
    if split == "imported":
        return user_names()
    return tuple(n for n in sorted(_catalogue()) if split in (None, "all") or _split()[n] == split)


def load(name: str) -> ObjectModel:
    """The object of that name, or of the mesh file at that path.

    A catalogue name comes first, then the user's own objects, then files; a file is imported on
    the fly and kept in the cache.

    Raises:
        InputError: there is no such object or file, or the file does not do.
    """
    if name in _catalogue():
        return _load_catalogue(name)
    if name in user_names():
        return load_user_object(name)
    path = Path(name).expanduser()
    if path.suffix.lower() in SUFFIXES or len(path.parts) > 1:
        return cached_import(path)
    raise unknown_name("object", name, (*_catalogue(), *user_names()), "taskgrasp objects list")


@cache
def _load_catalogue(name: str) -> ObjectModel:
    return model_from_json(name, _catalogue()[name])


def model_from_json(name: str, data: Json) -> ObjectModel:
    """Catalogue object from its line of library.json."""
    affordance = load_knowledge().objects[name]
    return ObjectModel(
        name=name,
        extents_m=tuple(data["extents_m"]),
        mass_kg=affordance.mass_kg,
        com=np.array(data["com"]),
        inertia=np.array(data["unit_inertia"]) * affordance.mass_kg,
        friction=FRICTION[data["material"]],
        rigidity=affordance.rigidity,
        affordance=affordance,
        split=_split()[name],
        parts=tuple(part_from_json(part) for part in data["parts"]),
        resting_poses=tuple(pose_from_json(pose) for pose in data["resting_poses"]),
        grasped_center=tuple(data["grasped_center"]),
        grasped_extents_m=tuple(data["grasped_extents_m"]),
        stands=tuple(data.get("stands", ())),
        material=data["material"],
        category=data["category"],
        source="parametric model, dimensions and mass after the human grasping data",
        licence="Apache-2.0",
        volume_m3=data["volume_m3"],
        mesh=partial(_catalogue_mesh, name),
    )


@cache
def _catalogue_mesh(name: str) -> trimesh.Trimesh:
    from maniskill_taskgrasp.assets.objects.compiler import shape
    from maniskill_taskgrasp.assets.objects.recipe import load_recipes
    from maniskill_taskgrasp.assets.objects.solid import to_mesh

    return to_mesh(shape(load_recipes()[name]))
