"""Situations that ask for an action without naming it: "the door squeaks", "my hands are cold".

`situations.json` is own work from everyday life: what people say, the action that would help and
the object that it takes. The head learns them, so that other words for them are understood too.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files


@dataclass(frozen=True)
class Situation:
    """Words for a situation, and what helps."""

    said: str
    action: str
    object: str
    """What the hand holds."""


@cache
def load_situations() -> tuple[Situation, ...]:
    """All situations, in the order of the file."""
    text = files("maniskill_taskgrasp.language").joinpath("situations.json").read_text("utf-8")
    return tuple(
        Situation(said, group["action"], group["object"])
        for group in json.loads(text)
        for said in group["said"].split("; ")
    )
