"""Slips of the keyboard: unknown words become the nearest word of the lexicon, with a note."""

from __future__ import annotations

import re
from functools import cache

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.encoder import EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.guard import ENGLISH_WORDS
from maniskill_taskgrasp.language.lexicon import TRANSFER_VERBS, load_lexicon
from maniskill_taskgrasp.language.situations import load_situations
from maniskill_taskgrasp.language.verbs import base_forms
from maniskill_taskgrasp.language.words import word_set

LONG_WORD = 8  # From this length on two slips are forgiven, before it one.
MEDIUM_WORD = 6  # Shorter words are corrected to likely words only.
LIKELY_SLIP = 0.65  # Cost (`_cost`) of one slip in a likely word, or of a swap in any.
VERB_FIRST = 0.1  # What it costs less that the first word is a verb.
COMMON = 8000  # Entries of the encoder's vocabulary, most frequent first, that count as common.
SHORTEST = 3  # Shorter words are left as they are.
MAX_UNKNOWN = 6  # More unknown words than this are no slips; it also bounds the time.
EXTRA_WORDS = word_set("extra_words")
FUSED = frozenset(["the", "it", "this", "that", "my", "up", "down", "with", "off", "out", "on"])
"""Words that are often typed without the space before them."""


def slip_distance(a: str, b: str, most: int) -> int:
    """Edits between two words: insert, delete, replace, swap of neighbours (optimal alignment).

    Args:
        a: first word.
        b: second word.
        most: larger distances are reported as `most + 1`.
    """
    if abs(len(a) - len(b)) > most:
        return most + 1
    older: list[int] = []
    before: list[int] = []
    row = list(range(len(b) + 1))
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
def likely_words() -> frozenset[str]:
    """Words that a slip most likely meant: names of objects, typical verbs, function words."""
    names = {p for name in load_knowledge().objects for p in re.split(r"[^a-z]+", name.lower())}
    first = {p.verb for phrases in load_lexicon().phrases.values() for p in phrases if p.rank < 5}
    return frozenset(names | first | TRANSFER_VERBS | ENGLISH_WORDS | EXTRA_WORDS)


@cache
def domain_words() -> frozenset[str]:
    """Words that instructions are made of: names, verbs in all forms, function words."""
    pieces = {p for w in load_lexicon().words() for p in re.split(r"[^a-z]+", w)}
    plurals = {w + "s" for w in pieces if len(w) > SHORTEST}
    words = pieces | plurals | set(base_forms()) | likely_words()
    return frozenset(w for w in words if len(w) > 1)


@cache
def known_words() -> frozenset[str]:
    """Words that need no correction; without the encoder's vocabulary only ours."""
    told = {w.strip(",'") for s in load_situations() for w in s.said.split()}
    try:
        return domain_words() | told | load_encoder().words()
    except EncoderMissingError:
        return domain_words() | told


@cache
def common_words() -> frozenset[str]:
    """English words so common that they are meant as they stand."""
    try:
        return load_encoder().words(most=COMMON)
    except EncoderMissingError:
        return domain_words()


def _letters(word: str) -> int:
    """The set of a word's letters as bits."""
    bits = 0
    for letter in word:
        bits |= 1 << (ord(letter) & 31)
    return bits


@cache
def _by_length() -> dict[int, tuple[tuple[str, int], ...]]:
    lengths: dict[int, list[tuple[str, int]]] = {}
    for word in sorted(domain_words()):
        lengths.setdefault(len(word), []).append((word, _letters(word)))
    return {n: tuple(words) for n, words in lengths.items()}


SOUNDS = (
    ("ph", "f"), ("wr", "r"), ("kn", "n"), ("gh", ""), ("ck", "k"), ("qu", "kw"), ("x", "ks"),
    ("dg", "g"), ("c", "k"), ("z", "s"), ("y", "i"),
)  # fmt: skip
"""Spellings that sound alike, as they are replaced one after the other."""
MOST_BY_SOUND = 3  # Slips that a likely word which sounds right may have; others one less.


def sound(word: str) -> str:
    """Roughly how a word sounds: "plyers" like "pliers", "vaccume" like "vacuum"."""
    for spelling, heard in SOUNDS:
        word = word.replace(spelling, heard)
    vowels = re.sub(r"(?<=.)[aeiou]+", "a", re.sub(r"(?<=..)e$", "", word))
    return re.sub(r"(.)\1+", r"\1", vowels)


@cache
def _by_sound() -> dict[str, tuple[str, ...]]:
    sounds: dict[str, list[str]] = {}
    for word in sorted(domain_words()):
        if len(word) > SHORTEST:
            sounds.setdefault(sound(word), []).append(word)
    return {heard: tuple(words) for heard, words in sounds.items()}


def _sounding(word: str) -> str | None:
    """The domain word that sounds like what was typed."""
    alike = [
        (slip_distance(word, other, MOST_BY_SOUND) + (other not in likely_words()), other)
        for other in _by_sound().get(sound(word), ())
    ]
    return min(alike)[1] if alike and min(alike)[0] <= MOST_BY_SOUND else None


def _cost(word: str, candidate: str, distance: int) -> float:
    """How unlikely a slip is: swaps and doubled letters happen, other first letters hardly."""
    swapped = sorted(word) == sorted(candidate)
    doubled = re.sub(r"(.)\1", r"\1", word) == re.sub(r"(.)\1", r"\1", candidate)
    likely = candidate in likely_words()
    silent = candidate in {"w" + word, "k" + word}
    other_first = word[0] != candidate[0] and not silent
    return distance - 0.5 * (swapped or doubled) - 0.4 * likely + 0.6 * other_first


def nearest_word(word: str, *, verb: bool = False) -> str | None:
    """The domain word that a slip most likely meant, None where there is none.

    Long words may have two slips where a likely word is meant; other words have one at most.

    Args:
        word: what was typed.
        verb: it stands where a request starts, so that a verb is meant rather than a noun.
    """
    verbs = load_lexicon().verbs if verb else frozenset()
    most = 2 if len(word) >= LONG_WORD else 1
    letters = _letters(word)
    best: tuple[float, int, str] | None = None
    for length in range(len(word) - most, len(word) + most + 1):
        for candidate, others in _by_length().get(length, ()):
            if (letters ^ others).bit_count() > 2 * most:
                continue  # Each edit adds and drops one letter of the set at most.
            distance = slip_distance(word, candidate, most)
            far = distance == most == 2 and candidate not in likely_words()
            if distance <= most and not far:
                cost = _cost(word, candidate, distance) - VERB_FIRST * (candidate in verbs)
                key = (cost, -length, candidate)
                best = min(best, key) if best else key
    limit = most if len(word) >= MEDIUM_WORD else LIKELY_SLIP
    return best[-1] if best is not None and best[0] <= limit else None


def _two_words(word: str) -> str | None:
    """A verb and a short word typed without the space ("turnthe")."""
    for cut in range(SHORTEST, len(word) - 1):
        left, right = word[:cut], word[cut:]
        if left in base_forms() and right in FUSED:
            return f"{left} {right}"
    return None


def correct(text: str) -> tuple[str, tuple[str, ...]]:
    """Text with slips corrected, and one note for each correction."""
    notes: list[str] = []
    words: list[str] = []
    for piece in text.split():
        core = piece.strip(".,!?;:'-")
        unknown = core.isascii() and core.isalpha() and core not in known_words()
        if unknown and len(core) >= SHORTEST and len(notes) < MAX_UNKNOWN:
            near = _two_words(core) or nearest_word(core, verb=not words)
            fixed = near or _sounding(core)
            if fixed:
                notes.append(f"read {core!r} as {fixed!r}")
                piece = piece.replace(core, fixed)
        words.append(piece)
    return " ".join(words), tuple(notes)


def correct_verb(text: str, position: int) -> tuple[str, tuple[str, ...]]:
    """Text whose word at a position, though English, is read as the verb it misses by one slip."""
    words = text.split()
    core = words[position].strip(".,!?;:'-")
    slipped = len(core) >= SHORTEST and core not in base_forms()
    fixed = nearest_word(core) if slipped else None
    if fixed is None or fixed not in load_lexicon().verbs or fixed not in likely_words():
        return text, ()
    words[position] = words[position].replace(core, fixed)
    return " ".join(words), (f"read {core!r} as {fixed!r}",)


def respell_name(words: str) -> str | None:
    """The object name that words miss by one slip in one of them ("power chord"), if any.

    A single word must be no common noun, or an unfinished name ("draw" for "drawer").
    """
    parts = words.split()
    for name in load_lexicon().names:
        others = name.split()
        if len(others) != len(parts):
            continue
        wrong = [(a, b) for a, b in zip(parts, others, strict=True) if a != b]
        if len(wrong) == 1 and len(wrong[0][0]) > SHORTEST:
            slip, meant = wrong[0]
            longer = meant.startswith(slip) and len(meant) <= len(slip) + 2
            unfinished = longer and meant in likely_words()
            near = slip[0] == meant[0] and slip_distance(slip, meant, 1) == 1
            known = slip in common_words() or slip in domain_words()
            common = len(parts) == 1 and known
            verb = slip in base_forms()
            if (near and not common) or (unfinished and (verb or not common)):
                return name
    return None
