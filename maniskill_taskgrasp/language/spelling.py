"""Slips of the keyboard: unknown words become the nearest word of the lexicon, and a note says so."""

from __future__ import annotations

import re
from functools import cache

from maniskill_taskgrasp.language.encoder import EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.guard import ENGLISH_WORDS
from maniskill_taskgrasp.language.lexicon import load_lexicon
from maniskill_taskgrasp.language.verbs import base_forms

COMMON_WORDS = 16000  # Entries of the encoder's vocabulary that count as common English.
LONG_WORD = 6  # From this length on two slips are forgiven, before it one.
SHORTEST = 3  # Shorter words are left as they are.
EXTRA_WORDS = frozenset(
    ["please", "could", "would", "should", "with", "using", "from", "some", "this", "that", "something", "need", "want", "table", "floor", "wall", "nail", "bolt", "screw", "hands", "hand", "water", "kitchen", "window", "door", "then", "after", "before", "first", "again", "and", "the", "you", "your", "little", "very", "don't", "not", "just", "only", "because"]
)


def slip_distance(a: str, b: str, most: int) -> int:
    """Edits between two words: insert, delete, replace, swap of neighbours (optimal alignment).

    Args:
        a: first word.
        b: second word.
        most: larger distances are reported as `most + 1`.
    """
    if abs(len(a) - len(b)) > most:
        return most + 1
    before, row = [], list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        older, before, row = before, row, [i] + [0] * len(b)
        for j, y in enumerate(b, 1):
            row[j] = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (x != y))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                row[j] = min(row[j], older[j - 2] + 1)
        if min(row) > most:
            return most + 1
    return row[-1]


@cache
def domain_words() -> frozenset[str]:
    """Words that instructions are made of: names, verbs in all forms, function words."""
    pieces = {p for w in load_lexicon().words() for p in re.split(r"[^a-z]+", w)}
    words = pieces | set(base_forms()) | ENGLISH_WORDS | EXTRA_WORDS
    plurals = {w + "s" for w in pieces if len(w) > SHORTEST}
    return frozenset(w for w in words | plurals if len(w) > 1)


@cache
def known_words() -> frozenset[str]:
    """Words that need no correction; without the encoder's vocabulary only the domain's."""
    try:
        return domain_words() | load_encoder().common_words(COMMON_WORDS)
    except EncoderMissingError:
        return domain_words()


@cache
def _by_length() -> dict[int, tuple[str, ...]]:
    lengths: dict[int, list[str]] = {}
    for word in sorted(domain_words()):
        lengths.setdefault(len(word), []).append(word)
    return {n: tuple(words) for n, words in lengths.items()}


def nearest_word(word: str) -> str | None:
    """The domain word within the forgiven number of slips, None where there is none.

    Of several, the one with the same first letter and the nearest length is taken.
    """
    most = 2 if len(word) >= LONG_WORD else 1
    best: tuple[int, bool, int, str] | None = None
    for length in range(len(word) - most, len(word) + most + 1):
        for candidate in _by_length().get(length, ()):
            distance = slip_distance(word, candidate, most)
            if distance <= most:
                same_letters = sorted(word) == sorted(candidate)
                rank = distance - 0.5 * same_letters
                key = (rank, word[0] != candidate[0], abs(len(word) - length), candidate)
                best = min(best, key) if best else key
    return best[-1] if best else None


def _two_words(word: str) -> str | None:
    """A verb and a function word typed without the space ("turnthe")."""
    for cut in range(SHORTEST, len(word) - 1):
        left, right = word[:cut], word[cut:]
        if left in base_forms() and right in {"the", "it", "this", "that", "a", "my", "up", "down"}:
            return f"{left} {right}"
    return None


def correct(text: str) -> tuple[str, tuple[str, ...]]:
    """Text with slips corrected, and one note for each correction."""
    notes = []
    words = []
    for piece in text.split():
        core = piece.strip(".,!?;:'-")
        fixed = None
        if core.isalpha() and len(core) >= SHORTEST and core not in known_words():
            fixed = nearest_word(core) or _two_words(core)
        if fixed:
            notes.append(f"read {core!r} as {fixed!r}")
            piece = piece.replace(core, fixed)
        words.append(piece)
    return " ".join(words), tuple(notes)
