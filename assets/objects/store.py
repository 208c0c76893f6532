"""Objects as plain JSON values and back, and files that are never seen half written."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from maniskill_taskgrasp.assets.objects.model import Part, RestingPose

Json = dict[str, Any]
MICRON = 6  # Decimals kept of lengths in metres.


def part_to_json(part: Part) -> Json:
    """The part with lengths rounded to a micrometre."""
    data: Json = {"kind": part.kind, "position": _rounded(part.position)}
    if part.quat_wxyz != (1.0, 0.0, 0.0, 0.0):
        data["quat_wxyz"] = _rounded(part.quat_wxyz, 8)
    if part.vertices is not None:
        data["vertices"] = _rounded(part.vertices)
    else:
        data["size"] = _rounded(part.size)
    return data


def part_from_json(data: Json) -> Part:
    """Inverse of `part_to_json`."""
    vertices = data.get("vertices")
    return Part(
        kind=data["kind"],
        position=tuple(data["position"]),
        quat_wxyz=tuple(data.get("quat_wxyz", (1.0, 0.0, 0.0, 0.0))),
        size=tuple(data.get("size", ())),
        vertices=None if vertices is None else np.array(vertices),
    )


def pose_to_json(pose: RestingPose) -> Json:
    return {
        "name": pose.name,
        "quat_wxyz": _rounded(pose.quat_wxyz, 8),
        "height": round(pose.height, MICRON),
        "probability": round(pose.probability, 4),
    }


def pose_from_json(data: Json) -> RestingPose:
    return RestingPose(**{**data, "quat_wxyz": tuple(data["quat_wxyz"])})


def _rounded(values: Any, decimals: int = MICRON) -> Any:
    return (np.asarray(values, dtype=float).round(decimals) + 0.0).tolist()


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that a reader sees the old one or the whole new one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(temporary).chmod(0o644)  # mkstemp's own mode hides the file from other users.
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def to_lines(objects: dict[str, Json]) -> bytes:
    """JSON document with one object a line, so that a change of one is a change of one line."""
    lines = [
        f"{json.dumps(name)}: {json.dumps(data, separators=(',', ':'), ensure_ascii=False)}"
        for name, data in objects.items()
    ]
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()
