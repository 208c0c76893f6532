"""How this folder's scripts start: flags from a dataclass; bad input is one line, exit code 2."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import tyro

from maniskill_taskgrasp.errors import InputError


def run_script(main: Callable[[Any], object], config: type, description: str | None = None) -> None:
    """Read the flags of `config` and run `main` with them.

    Args:
        config: a dataclass; its fields are the flags.
        description: what --help says first; the dataclass's docstring where it is left out.
    """
    try:
        main(tyro.cli(config, description=description))
    except InputError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        sys.exit(2)
    except OSError as error:
        print(f"{error.strerror or error}: {error.filename!r}", file=sys.stderr)
        sys.exit(2)
