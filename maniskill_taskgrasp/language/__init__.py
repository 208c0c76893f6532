"""English instructions -> (action, object); spaCy and the encoder load at the first `parse`."""

from __future__ import annotations

from typing import Literal

from maniskill_taskgrasp.language.instruction import Instruction, Rejected

__all__ = ["Instruction", "Rejected", "parse"]


def parse(
    text: str, object_override: str | None = None, matcher: Literal["own", "paper"] = "own"
) -> Instruction | Rejected:
    """Understand one instruction, or say why not.

    Args:
        text: what a person typed.
        object_override: name of the object where the user gave it (a library name or a mesh).
        matcher: "own" front end, or the "paper" recipe for comparison.
    """
    if matcher == "paper":
        from maniskill_taskgrasp.language.paper import parse_as_paper

        return parse_as_paper(text, object_override)
    from maniskill_taskgrasp.language.understand import understand

    return understand(text, object_override)
