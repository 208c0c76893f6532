"""What a mesh file's first lines promise: how many faces, and at least how many bytes."""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from pathlib import Path

STL_HEADER, STL_FACE = 84, 50  # [bytes] of a binary STL: header with the count, then each face.
PLY_ELEMENT = 4  # [bytes] least of a vertex or a face, as text or in binary.
LONGEST_HEADER = 65_536  # [bytes]


@dataclass(frozen=True)
class Promise:
    """What a header says; faces and vertices together cannot take fewer bytes."""

    faces: int
    least_bytes: int


def promise(path: Path) -> Promise | None:
    """The promise of an STL or PLY file; None where the format makes none up front."""
    with path.open("rb") as file:
        start = file.read(LONGEST_HEADER)
    if path.suffix.lower() == ".stl":
        return _stl(start)
    if path.suffix.lower() == ".ply":
        return _ply(start)
    return None


def _stl(start: bytes) -> Promise | None:
    """Of a binary file; a text begins with "solid" and comes to a facet or its end soon."""
    text = start.lstrip().lower()
    if text.startswith(b"solid") and (b"facet" in text or b"endsolid" in text):
        return None
    if len(start) < STL_HEADER:
        return Promise(0, STL_HEADER)
    (faces,) = struct.unpack_from("<I", start, STL_HEADER - 4)
    return Promise(faces, STL_HEADER + STL_FACE * faces)


def _ply(start: bytes) -> Promise | None:
    header, found, _ = start.partition(b"end_header")
    if not found:
        return None
    counts = {name: int(n) for name, n in re.findall(rb"element\s+(\w+)\s+(\d{1,18})", header)}
    elements = counts.get(b"vertex", 0) + counts.get(b"face", 0)
    return Promise(counts.get(b"face", 0), len(header) + PLY_ELEMENT * elements)
