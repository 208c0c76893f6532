"""What the command line shows of the library, as JSON-able dictionaries."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.errors import InputError, echo

LISTED = (*library.SPLITS, "imported")


def list_objects(split: str | None = None) -> list[dict[str, Any]]:
    """One row an object, by name.

    Raises:
        InputError: no split has that name.
    """
    if split is not None and split not in LISTED:
        raise InputError(f"split must be one of {', '.join(LISTED)}, got {echo(split)}")
    return [describe(library.load(name)) for name in library.names(split)]


def describe(model: ObjectModel) -> dict[str, Any]:
    """The object's row: name, size, mass, parts, mesh and split."""
    return {
        "name": model.name,
        "dimensions_m": [round(extent, 4) for extent in model.extents_m],
        "mass_kg": round(model.mass_kg, 4),
        "parts": len(model.parts),
        "watertight": model.watertight,
        "split": model.split,
    }


def show_object(name: str, out: Path | None = None) -> dict[str, Any]:
    """The object's row with its poses, and a picture of it where `out` says.

    Raises:
        InputError: no object has that name, or it cannot be drawn on this machine.
    """
    model = library.load(name)
    row = describe(model)
    row["resting_poses"] = [pose.name for pose in model.resting_poses]
    if out is not None:
        from maniskill_taskgrasp.assets.objects.render import contact_sheet

        contact_sheet([model], out, columns=1)
        row["picture"] = str(out)
    return row
