"""The models of Debian's sweethome3d-furniture that a hand can take, at their stated true sizes.

A catalogue is a zip archive (.sh3f) of OBJ files, y up, and a properties file that states each
model's width (x), depth (z) and height (y) in cm, its author, and the licence of them all.
"""

from __future__ import annotations

import re
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.assets.objects.importer import Origin, object_from_mesh
from maniskill_taskgrasp.assets.objects.meshfile import RawMesh, read_surface
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.errors import InputError, echo

SUFFIX = ".sh3f"
PROPERTIES = "PluginFurnitureCatalog.properties"
MAX_LENGTH = 0.40  # [m] of what a hand can lift off a table,
MIN_THIN, MAX_THIN = 0.001, 0.12  # [m] and its thinnest extent, a mug's handle included.


@dataclass(frozen=True)
class CatalogueEntry:
    """One model of a catalogue."""

    name: str
    model: str
    """Path of the OBJ file in the archive."""
    size_m: tuple[float, float, float]
    """Width, height, depth: the model's x, y, z."""
    rotation: tuple[float, ...]
    """Nine numbers, row by row, that turn the file's axes before the size applies."""
    author: str
    licence: str


def graspable_entries(archive: Path) -> list[CatalogueEntry]:
    """Entries of a catalogue that are movable and of a size for the hand.

    Raises:
        InputError: not a Sweet Home 3D catalogue.
    """
    try:
        with zipfile.ZipFile(archive) as zipped:
            text = zipped.read(PROPERTIES).decode("latin-1")
    except (OSError, zipfile.BadZipFile, KeyError):
        raise InputError(f"{echo(archive)} is not a Sweet Home 3D furniture catalogue") from None
    return [
        entry
        for entry in _entries(parse_properties(text))
        if max(entry.size_m) <= MAX_LENGTH and MIN_THIN <= min(entry.size_m) <= MAX_THIN
    ]


def parse_properties(text: str) -> dict[str, str]:
    """Key and value of every line of a Java properties file; escapes resolved."""
    values = {}
    for line in re.sub(r"\\\r?\n\s*", "", text).splitlines():
        key, separator, value = line.strip().partition("=")
        if separator and not key.startswith(("#", "!")):
            escaped = re.sub(r"\\u([0-9a-fA-F]{4})", lambda m: chr(int(m[1], 16)), value)
            values[key.strip()] = re.sub(r"\\(.)", r"\1", escaped).strip()
    return values


def _entries(values: dict[str, str]) -> Iterator[CatalogueEntry]:
    numbers = [key.partition("#")[2] for key in values if key.startswith("model#")]
    for n in numbers:
        if values.get(f"movable#{n}") != "true" or values.get(f"doorOrWindow#{n}") == "true":
            continue
        try:
            width, depth, height = (
                float(values[f"{key}#{n}"]) / 100 for key in ("width", "depth", "height")
            )
            rotation = values.get(f"modelRotation#{n}", "1 0 0 0 1 0 0 0 1")
            yield CatalogueEntry(
                name=re.sub(r"[^0-9a-z-]+", " ", values[f"name#{n}"].lower()).strip(),
                model=values[f"model#{n}"].lstrip("/"),
                size_m=(width, height, depth),
                rotation=tuple(float(v) for v in rotation.split()),
                author=values.get(f"creator#{n}", "not stated"),
                licence=values.get(f"license#{n}", values.get("license", "not stated")),
            )
        except (KeyError, ValueError):
            continue  # An entry without a size or a name cannot be of use.


def import_entry(archive: Path, entry: CatalogueEntry) -> tuple[ObjectModel, tuple[str, ...]]:
    """The entry's model as an object of its stated size.

    Raises:
        InputError: its mesh does not do.
    """
    with zipfile.ZipFile(archive) as zipped, tempfile.TemporaryDirectory() as folder:
        inside = str(Path(entry.model).parent) + "/"
        for name in zipped.namelist():
            # Only plain files of the model's own folder: no way out of the temporary one.
            if name.startswith(inside) and ".." not in name and not name.endswith("/"):
                zipped.extract(name, folder)
        mesh = read_surface(Path(folder) / entry.model)
    turn = np.eye(4)
    turn[:3, :3] = np.array(entry.rotation).reshape(3, 3)
    mesh.apply_transform(turn)
    mesh.apply_scale(np.array(entry.size_m) / mesh.extents)
    origin = Origin(
        source=f"{archive.name}: {entry.model}, by {entry.author}",
        licence=entry.licence,
        up=(0.0, 1.0, 0.0),
    )
    note = "size as the catalogue states it"
    return object_from_mesh(RawMesh(mesh, "m", note), entry.name, None, origin)
