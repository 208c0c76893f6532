"""Where the authors' CSV comes from and how we know that it is theirs."""

from __future__ import annotations

import shutil
import urllib.request
from pathlib import Path
from urllib.error import URLError

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.selection.dataset import SHA256, load_table, sha256_of

FILE_NAME = "task-object_grasp_dataset.csv"
URL = f"https://raw.githubusercontent.com/hhelium/MagicHand_Env/HEAD/{FILE_NAME}"
"""The file in its authors' public repository, which states no licence: so we do not ship it."""
TIMEOUT_S = 30.0


def default_path() -> Path:
    """Where a fetched data set is kept."""
    return Path.home() / ".cache" / "taskgrasp" / FILE_NAME


def check(path: str | Path | None = None) -> dict[str, object]:
    """Validate a local copy.

    Args:
        path: the CSV; the fetched one by default.

    Returns:
        {"path", "sha256", "rows"}.

    Raises:
        InputError: missing, unreadable, or not the authors' file bit for bit.
    """
    path = Path(path) if path is not None else default_path()
    table = load_table(path)
    digest = sha256_of(path)
    if digest != SHA256:
        raise InputError(
            f"{path.name!r} has sha256 {digest[:12]}..., the authors' file {SHA256[:12]}...; "
            "`taskgrasp data fetch` gets the original"
        )
    return {"path": str(path), "sha256": digest, "rows": len(table)}


def fetch(source: str | Path | None = None, target: str | Path | None = None) -> dict[str, object]:
    """Get the authors' CSV, check it, and keep it; nothing is kept that does not pass.

    Args:
        source: a local copy; without it the file is downloaded from its repository.
        target: where to keep it; `default_path()` by default.

    Returns:
        {"path", "sha256", "rows"} of the kept copy.

    Raises:
        InputError: no network, no such file, no room to write, or not the authors' file.
    """
    target = Path(target) if target is not None else default_path()
    if source is not None:
        check(source)
    partial = target.with_name(target.name + ".partial")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if source is None:
            partial.write_bytes(_download())
        else:
            shutil.copyfile(source, partial)
        found = check(partial)
        partial.replace(target)
    except OSError as error:
        raise InputError(f"cannot write {str(target)!r}: {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)
    return {**found, "path": str(target)}


def _download() -> bytes:
    try:
        with urllib.request.urlopen(URL, timeout=TIMEOUT_S) as answer:
            return bytes(answer.read())
    except (URLError, TimeoutError, ValueError) as error:
        reason = " ".join(str(getattr(error, "reason", error)).split())
    raise InputError(
        f"cannot download {FILE_NAME} from github.com/hhelium/MagicHand_Env ({reason}): "
        "get it by hand and use `taskgrasp data fetch --from FILE`"
    )
