"""The user's own objects: one JSON file and one mesh each, below `$TASKGRASP_HOME`."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.assets.objects.folders import cache_folder, user_objects_folder
from maniskill_taskgrasp.assets.objects.meshfile import check_file
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.assets.objects.store import (
    Json,
    part_from_json,
    part_to_json,
    pose_from_json,
    pose_to_json,
    write_atomically,
)
from maniskill_taskgrasp.errors import InputError, echo
from maniskill_taskgrasp.knowledge import Affordance

if TYPE_CHECKING:
    import trimesh

MESH_SUFFIX = ".ply"


def user_names() -> tuple[str, ...]:
    """Names of the imported objects, sorted."""
    folder = user_objects_folder()
    return tuple(sorted(p.stem for p in folder.glob("*.json"))) if folder.is_dir() else ()


def load_user_object(name: str) -> ObjectModel:
    """Imported object of that name.

    Raises:
        InputError: its file is damaged.
    """
    return read_object(user_objects_folder() / f"{name}.json")


def save_user_object(model: ObjectModel, notes: tuple[str, ...] = ()) -> Path:
    """Store an imported object; the JSON file is written last, so a broken run leaves no object."""
    return write_object(model, notes, user_objects_folder() / f"{model.name}.json")


def cached_import(path: Path, units: str | None = None, mass: float | None = None) -> ObjectModel:
    """Object of a mesh file, made once and kept in the cache folder under the file's fingerprint.

    Raises:
        InputError: the file does not do.
    """
    from maniskill_taskgrasp.assets.objects.importer import fingerprint, import_file

    check_file(path)
    stored = cache_folder() / "imports" / f"{fingerprint(path, units, mass)}.json"
    if not stored.exists():
        model, notes = import_file(path, units, mass)
        write_object(model, notes, stored)
    return read_object(stored)


def write_object(model: ObjectModel, notes: tuple[str, ...], path: Path) -> Path:
    """Store an object as JSON beside its mesh."""
    content: bytes = model.visual().export(file_type=MESH_SUFFIX[1:])  # type: ignore[assignment]
    write_atomically(path.with_suffix(MESH_SUFFIX), content)
    text = json.dumps(object_to_json(model, notes), ensure_ascii=False)
    write_atomically(path, text.encode())
    return path


def read_object(path: Path) -> ObjectModel:
    """Object stored by `write_object`.

    Raises:
        InputError: the file is damaged.
    """
    try:
        data = json.loads(path.read_text("utf-8"))
        return object_from_json(data, path.with_suffix(MESH_SUFFIX))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"imported object {echo(path)} is damaged ({type(error).__name__}): import it again"
        ) from None


def object_to_json(model: ObjectModel, notes: tuple[str, ...]) -> Json:
    """Everything but the mesh as JSON values."""
    plain = ("name", "mass_kg", "friction", "rigidity", "split", "material", "category")
    return {
        **{key: getattr(model, key) for key in (*plain, "source", "licence", "watertight")},
        "extents_m": list(model.extents_m),
        "grasped_center": list(model.grasped_center),
        "grasped_extents_m": list(model.grasped_extents_m),
        "com": model.com.tolist(),
        "inertia": model.inertia.tolist(),
        "volume_m3": model.volume_m3,
        "affordance": {**asdict(model.affordance), "name": model.name},
        "stands": list(model.stands),
        "parts": [part_to_json(part) for part in model.parts],
        "resting_poses": [pose_to_json(pose) for pose in model.resting_poses],
        "notes": list(notes),
    }


def object_from_json(data: Json, mesh_file: Path) -> ObjectModel:
    """Inverse of `object_to_json`, with the mesh read from a file when it is first needed."""
    facts = {key: value for key, value in data.items() if key != "notes"}
    affordance = data["affordance"]
    triples = ("extents_m", "grasped_center", "grasped_extents_m")
    facts.update(
        {name: tuple(data[name]) for name in triples},
        com=np.array(data["com"]),
        inertia=np.array(data["inertia"]),
        affordance=Affordance(**{**affordance, "dimensions_m": tuple(affordance["dimensions_m"])}),
        stands=tuple(data["stands"]),
        parts=tuple(part_from_json(part) for part in data["parts"]),
        resting_poses=tuple(pose_from_json(pose) for pose in data["resting_poses"]),
        mesh=partial(_read_mesh, mesh_file),
    )
    return ObjectModel(**facts)


def _read_mesh(path: Path) -> trimesh.Trimesh:
    import trimesh

    try:
        return trimesh.load_mesh(path)
    except (OSError, ValueError) as error:
        raise InputError(f"mesh {echo(path)} is gone or damaged: import it again") from error
