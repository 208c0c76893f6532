"""What `taskgrasp objects` does, as functions of plain values that return JSON-able ones."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from maniskill_taskgrasp.assets.objects.importer import import_file, mesh_files, plain_name
from maniskill_taskgrasp.assets.objects.library import load, names
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.assets.objects.presentation import present
from maniskill_taskgrasp.assets.objects.store import Json
from maniskill_taskgrasp.assets.objects.sweethome import SUFFIX, graspable_entries, import_entry
from maniskill_taskgrasp.assets.objects.userlib import save_user_object
from maniskill_taskgrasp.errors import InputError, echo

Importer = Callable[[], tuple[ObjectModel, tuple[str, ...]]]
Job = tuple[str, str, Importer]  # Where from, object name, how.


def summary(model: ObjectModel) -> Json:
    """The facts of one object that lists show."""
    return {
        "name": model.name,
        "dimensions_m": [round(float(e), 4) for e in model.extents_m],
        "mass_kg": round(model.mass_kg, 4),
        "parts": len(model.parts),
        "watertight": model.watertight,
        "split": model.split,
        "category": model.category,
        "material": model.material,
        "rigidity": model.rigidity,
        "shape": model.affordance.shape,
    }


def list_objects(split: str | None = None) -> list[Json]:
    """Summaries of the catalogue and the user's own objects, or of one split.

    Raises:
        InputError: no split has that name.
    """
    chosen = names(split) if split else (*names(), *names("imported"))
    return [summary(load(name)) for name in chosen]


def show_object(name: str, out: str | Path | None = None) -> Json:
    """Everything known of an object; a picture too if `out` is a file name.

    Raises:
        InputError: no such object, or pictures cannot be made here.
    """
    model = load(name)
    shown = present(model)
    facts = {
        **summary(model),
        "friction": model.friction,
        "com_m": [round(float(v), 5) for v in model.com],
        "volume_m3": model.volume_m3,
        "grasped_extents_m": [round(float(v), 4) for v in model.grasped_extents_m],
        "roundness": model.affordance.roundness,
        "resting_poses": [
            {"name": p.name, "height_m": p.height, "probability": round(p.probability, 3)}
            for p in model.resting_poses
        ],
        "stands": list(model.stands),
        "presentation": shown.kind,
        "presentation_reason": shown.reason,
        "source": model.source,
        "licence": model.licence,
        "picture": None,
    }
    if out is not None:
        from maniskill_taskgrasp.assets.objects.render import object_card

        object_card(model, Path(out))
        facts["picture"] = str(out)
    return facts


def import_objects(
    path: str | Path,
    units: str | None = None,
    mass: float | None = None,
    progress: bool = True,
) -> list[Json]:
    """Import a mesh file, a folder of them, or Sweet Home 3D catalogues, into the user's library.

    Args:
        units: "m", "cm" or "mm" of the files; None infers them.
        mass: [kg] of each object; None guesses from the volume.
        progress: show a bar for more than one on a terminal.

    Returns:
        A summary and the notes of each imported object; of a file in a folder that does not do,
        its name and the reason under "error".

    Raises:
        InputError: the path does not exist, holds nothing to import or nothing that does, or is a
            file that does not do.
    """
    from tqdm import tqdm

    source = Path(path).expanduser()
    if source.is_file() and source.suffix.lower() != SUFFIX:
        job = partial(import_file, source, units, mass)
        return [_import(plain_name(source), job)]
    jobs = _jobs(source, units, mass)
    if not jobs:
        raise InputError(f"{echo(path)} holds no mesh files")
    # None: no bar where stderr is no terminal, where it would stand beside the one error line.
    bar = tqdm(jobs, desc="importing", unit="mesh", leave=False, disable=None if progress else True)
    results = [_attempt(label, name, job) for label, name, job in bar]
    if all("error" in result for result in results):
        reason = results[0]["error"]
        raise InputError(f"none of the {len(results)} meshes in {echo(path)} does: first, {reason}")
    return results


def _jobs(source: Path, units: str | None, mass: float | None) -> list[Job]:
    """What is to be imported, under names that differ."""
    if not source.exists():
        raise InputError(f"no file or folder {echo(source.name)} in {echo(source.parent)}")
    jobs: list[Job] = []
    for archive in sorted(source.rglob(f"*{SUFFIX}")) if source.is_dir() else [source]:
        for entry in graspable_entries(archive):
            label = f"{archive.name}: {entry.name}"
            jobs.append((label, entry.name, partial(import_entry, archive, entry)))
    for file in mesh_files(source) if source.is_dir() else ():
        name = plain_name(file)
        jobs.append((str(file), name, partial(import_file, file, units, mass, name)))
    seen: Counter[str] = Counter()
    unique = []
    for label, name, job in jobs:
        seen[name] += 1
        unique.append((label, name if seen[name] == 1 else f"{name} {seen[name]}", job))
    return unique


def _attempt(label: str, name: str, job: Importer) -> Json:
    try:
        return _import(name, job)
    except InputError as error:
        return {"file": label, "error": str(error)}


def _import(name: str, job: Importer) -> Json:
    """Run an import and store its object under a name that no catalogue object has."""
    model, notes = job()
    if name in names():
        name = f"{name} imported"
    model = replace(model, name=name, affordance=replace(model.affordance, name=name))
    if name in names("imported"):
        notes = (*notes, f"replaces the object {echo(name)} imported before")
    save_user_object(model, notes)
    return {**summary(model), "notes": list(notes), "licence": model.licence}
