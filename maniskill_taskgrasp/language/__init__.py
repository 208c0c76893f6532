"""English instructions -> (action, object); spaCy and the encoder load at the first `parse`."""

from __future__ import annotations

from maniskill_taskgrasp.language.instruction import Instruction, Rejected

__all__ = ["Instruction", "Rejected", "parse"]


def parse(text: str, object_override: str | None = None) -> Instruction | Rejected:
    """Understand one instruction, or say why not.

    Args:
        text: what a person typed.
        object_override: name of the object where the user gave it (a library name or a mesh).
    """
    from maniskill_taskgrasp.language.understand import understand

    return understand(text, object_override)
