"""Lists of English words that the front end's rules speak of, kept as data in `words.json`."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files


@cache
def _load() -> dict[str, str | dict[str, str]]:
    text = files("maniskill_taskgrasp.language").joinpath("words.json").read_text("utf-8")
    return json.loads(text)


def word_list(name: str) -> tuple[str, ...]:
    """A list in its order; its entries are parted by semicolons."""
    value = _load()[name]
    assert isinstance(value, str)
    return tuple(value.split("; "))


def word_set(name: str) -> frozenset[str]:
    """A list without order."""
    return frozenset(word_list(name))


def word_map(name: str) -> dict[str, str]:
    """A table of words."""
    value = _load()[name]
    assert isinstance(value, dict)
    return value
