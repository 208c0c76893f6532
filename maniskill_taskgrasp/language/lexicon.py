"""What people call the 74 actions and the 286 objects: phrases and synonyms written for this job.

`lexicon.json` is own work from everyday English, not from any instruction of the evaluation set.
A phrase is "verb word word|noun,noun": the words must follow the verb, and one noun, where any is
given, must stand in the clause.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from maniskill_taskgrasp.knowledge import load_knowledge

TOOL_ACTIONS = frozenset(
    ["aiming", "applying", "blowing", "brushing", "calling", "cleaning", "cranking", "drilling", "drying", "hammering", "loosening", "measuring", "mopping", "oiling", "pounding", "sanding", "sawing", "screwing", "scrubbing", "spraying", "starting car", "talking on phone", "texting", "tightening", "unlocking", "unscrewing", "vacuuming", "washing", "wiping", "writing"]
)
"""Actions that people do with a tool, so that the thing acted on need not be what is held."""

TRANSFER_VERBS = frozenset(
    ["hand", "pass", "bring", "give", "grab", "fetch", "get", "lend", "toss", "reach", "fling", "slide", "shoot", "borrow"]
)
"""Verbs that ask for an object without naming a use; some need a receiver (`clauses`)."""

WEAK_TRANSFER_VERBS = frozenset(["take", "use", "grab", "get", "fetch", "bring", "pick", "have", "employ", "utilize"])
"""Verbs that only prepare the next task when one follows: "take the pen and write"."""

LIGHT_VERBS = frozenset(["give", "take", "have", "do", "make", "perform", "get", "need", "want", "carry"])
"""Verbs that leave the meaning to their noun: "give it a wipe"."""

NOMINALS = {
    "measurement": "measure",
    "inspection": "inspect",
    "examination": "examine",
    "adjustment": "adjust",
    "arrangement": "arrange",
    "removal": "remove",
    "replacement": "replace",
    "wash-up": "wash",
    "grip": "hold",
    "grasp": "hold",
    "conversation": "talk",
    "phonecall": "call",
    "reading": "read",
    "tidy": "tidy",
    "bite": "bite",
    "laundry": "launder",
}
"""Nouns that name a verb's doing without its form."""

SYNONYM_SCORE = 0.9
"""How surely a synonym names its object; the exact name has 1."""


@dataclass(frozen=True)
class Phrase:
    """One way to name an action."""

    action: str
    verb: str
    words: tuple[str, ...]
    """Words that follow the verb, in order: particles ("down") or nouns ("hold")."""
    nouns: frozenset[str]
    """One of these must be in the clause; none is asked for where empty."""
    rank: int
    """Position in the action's list; the first are the most typical."""

    @property
    def specificity(self) -> int:
        return 1 + len(self.words) + bool(self.nouns)

    @property
    def text(self) -> str:
        return " ".join((self.verb, *self.words))


@dataclass(frozen=True)
class Lexicon:
    """Phrases by verb and objects by name."""

    phrases: dict[str, tuple[Phrase, ...]]
    """Base form of the verb -> phrases."""
    names: dict[str, tuple[tuple[str, float], ...]]
    """Name or synonym in lower case -> objects it names, each with its score."""

    @property
    def verbs(self) -> frozenset[str]:
        return frozenset(self.phrases) | TRANSFER_VERBS

    def words(self) -> frozenset[str]:
        """Every single word of the phrases and names: what a slip is corrected towards."""
        words = {w for name in self.names for w in name.split()}
        for phrases in self.phrases.values():
            for phrase in phrases:
                words |= {phrase.verb, *phrase.words}
        return frozenset(words | TRANSFER_VERBS)


def parse_phrase(action: str, text: str, rank: int) -> Phrase:
    """Read one phrase of the file: "make|call,phone call"."""
    head, _, nouns = text.partition("|")
    verb, *words = head.split()
    return Phrase(action, verb, tuple(words), frozenset(filter(None, nouns.split(","))), rank)


@cache
def load_lexicon() -> Lexicon:
    """The lexicon, with every action's and object's own name in it."""
    text = files("maniskill_taskgrasp.language").joinpath("lexicon.json").read_text("utf-8")
    data = json.loads(text)
    phrases: dict[str, list[Phrase]] = {}
    for action, texts in data["actions"].items():
        for rank, phrase_text in enumerate(texts):
            phrase = parse_phrase(action, phrase_text, rank)
            phrases.setdefault(phrase.verb, []).append(phrase)
    names: dict[str, list[tuple[str, float]]] = {}
    for name in load_knowledge().objects:
        names.setdefault(name.lower(), []).append((name, 1.0))
    for name, synonyms in data["objects"].items():
        for synonym in synonyms:
            names.setdefault(synonym, []).append((name, SYNONYM_SCORE))
    return Lexicon(
        phrases={verb: tuple(found) for verb, found in phrases.items()},
        names={name: tuple(found) for name, found in names.items()},
    )
