"""What the front end answers: an instruction understood, or a rejection with its reason."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

RejectionKind = Literal[
    "empty",
    "off_topic",
    "other_language",
    "no_action",
    "no_object",
    "contradictory",
    "too_long",
]


@dataclass(frozen=True)
class Instruction:
    """One task, told in words: what to do and what the hand holds while doing it."""

    text: str
    """The words this instruction was read from."""
    action: str | None
    """One of the 74 actions; None for a transfer without a purpose ("hand me the mug")."""
    action_score: float
    """Probability of `action` in [0, 1]; 0 where there is none."""
    actions_top3: tuple[tuple[str, float], ...]
    """The three likeliest actions with their probabilities, best first."""
    transfer: bool
    """The words ask for a transfer ("hand me", "pass", "bring", "grab"), which names no use."""
    object: str | None
    """One of the 286 objects; None where the user's own mesh is the object."""
    object_score: float
    """How surely the words name `object`, in [0, 1]; 1 is the exact name."""
    object_candidates: tuple[tuple[str, float], ...] = ()
    """Objects that would also fit, with their scores, best first."""
    parameters: dict[str, str] = field(default_factory=dict)
    """Task parameter (`knowledge.PARAMETERS`) -> most frequent value for `action`."""
    rest: tuple[Instruction | Rejected, ...] = ()
    """Later tasks of a sequence, in order."""
    notes: tuple[str, ...] = ()
    """Remarks for people: what was assumed and what could not be used."""


@dataclass(frozen=True)
class Rejected:
    """No answer, and why."""

    text: str
    reason: str
    """One line: what came and what would do."""
    kind: RejectionKind
