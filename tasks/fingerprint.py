"""What a simulated result depends on, as one short hash: code, grasps and objects."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.resources import files
from pathlib import Path

CODE = ("maniskill_taskgrasp.tasks", "maniskill_taskgrasp.agents", "maniskill_taskgrasp.assets")
DATA = ("pregrasps.json", "objects/library.json")  # In assets.


@cache
def code_fingerprint() -> str:
    """12 hex digits of all code and data that decide how a grasp turns out in simulation."""
    digest = hashlib.sha256()
    for package in CODE:
        root = Path(str(files(package)))
        for path in sorted(root.rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    assets = Path(str(files("maniskill_taskgrasp.assets")))
    for name in DATA:
        if (assets / name).is_file():
            digest.update((assets / name).read_bytes())
    return digest.hexdigest()[:12]
