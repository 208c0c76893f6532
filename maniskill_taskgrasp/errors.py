"""The one exception a user's bad input raises, and the suggestion it carries."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MAX_ECHO = 60  # Characters of the user's own text that a message repeats.


class InputError(ValueError):
    """Bad input from a person; its text is one line that says what came and what would do."""


def echo(value: object) -> str:
    """The user's value, quoted on one line and shortened, fit for an error message."""
    text = str(value)
    shortened = text if len(text) <= MAX_ECHO else text[: MAX_ECHO - 1] + "…"
    return repr(shortened)


def unknown_name(
    kind: str, value: object, known: Iterable[str], more: str | None = None
) -> InputError:
    """Error for a name that is not in a list, with the closest names that are.

    Args:
        kind: what was named, such as "object".
        value: what came.
        known: the names that would do.
        more: where the whole list can be seen, such as "taskgrasp objects list"; a short list is
            given in the message itself.
    """
    names = list(known)
    close = difflib.get_close_matches(str(value).lower(), names, n=3, cutoff=0.6)
    hint = f"{more} shows all" if more else f"one of {', '.join(names)} would do"
    if close:
        hint = f"did you mean {', '.join(map(repr, close))}? ({hint})"
    return InputError(f"unknown {kind} {echo(value)}: {hint}")
