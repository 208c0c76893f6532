"""Text that is refused before any parsing: empty, too long, another language, no words at all."""

from __future__ import annotations

import unicodedata

from maniskill_taskgrasp.errors import echo
from maniskill_taskgrasp.language.instruction import Rejected
from maniskill_taskgrasp.language.text import MAX_CHARACTERS
from maniskill_taskgrasp.language.verbs import base_of
from maniskill_taskgrasp.language.words import word_set

TRY = "try 'tighten the bolt with the wrench' or 'hand me the mug'"

FOREIGN_WORDS = word_set("foreign_words")
ENGLISH_WORDS = word_set("english_words")
FOREIGN_SHARE = 0.2  # Share of words that must be another language's function words.


def letters_are_foreign(text: str) -> bool:
    """Whether most letters belong to another script than the Latin one."""
    letters = [c for c in text if c.isalpha()]
    foreign = sum(not unicodedata.name(c, "").startswith("LATIN") for c in letters)
    return foreign > 0.3 * len(letters)


def is_other_language(words: list[str]) -> bool:
    """Whether the function words of a Latin-script text are not English."""
    pieces = [p for w in words for p in w.replace("-", " ").strip(".,!?;:¿¡").split()]
    foreign = [p for p in pieces if p in FOREIGN_WORDS]
    accents = [p for p in pieces if any(ord(c) > 127 and c.isalpha() for c in p)]
    english = [p for p in pieces if p in ENGLISH_WORDS or base_of(p)]
    strange = len({*foreign, *accents})
    return strange > 0 and strange >= FOREIGN_SHARE * len(pieces) and strange > len(english)


def refuse(text: str, cleaned: str) -> Rejected | None:
    """The rejection of a text that needs no parsing, None where it may be an instruction.

    Args:
        text: as typed.
        cleaned: the same after `text.clean`.
    """
    if not text.strip():
        return Rejected(text, f"the text is empty: {TRY}", "empty")
    if len(text) > MAX_CHARACTERS:
        reason = (
            f"{len(text)} characters came: at most {MAX_CHARACTERS} are read, one task at a time"
        )
        return Rejected(text[:MAX_CHARACTERS], reason, "too_long")
    if letters_are_foreign(cleaned) or is_other_language(cleaned.split()):
        reason = f"{echo(text)} seems to be another language: say it in English, {TRY}"
        return Rejected(text, reason, "other_language")
    if not any(c.isalpha() for c in cleaned):
        return Rejected(text, f"{echo(text)} has no words: {TRY}", "off_topic")
    return None
