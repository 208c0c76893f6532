"""Where a user's own objects and files that can be made again are kept."""

from __future__ import annotations

import os
import tempfile
from functools import cache
from pathlib import Path

HOME_VARIABLE = "TASKGRASP_HOME"


def home_folder() -> Path:
    """`$TASKGRASP_HOME`, else the user's data folder after the XDG rules; may not exist yet."""
    if os.environ.get(HOME_VARIABLE):
        return Path(os.environ[HOME_VARIABLE]).expanduser()
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data) / "maniskill_taskgrasp"


def user_objects_folder() -> Path:
    """Folder of imported objects; may not exist yet."""
    return home_folder() / "objects"


@cache
def cache_folder() -> Path:
    """Writable folder for files that can be made again; a temporary one if home is read-only."""
    folder = home_folder() / "cache"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return Path(tempfile.mkdtemp(prefix="maniskill_taskgrasp_"))
