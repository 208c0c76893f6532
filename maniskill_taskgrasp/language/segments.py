"""Sentences -> segments of one request each, framed so that the parser reads imperatives right."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from maniskill_taskgrasp.language.lexicon import load_lexicon
from maniskill_taskgrasp.language.text import FILLERS, OPENER, strip_opener

CONNECTORS = frozenset(["and", "then", "but", "so", "or", "before", "after", "afterwards", "next"])
NEGATORS = ("do not ", "don't ", "never ", "not to ", "no need to ", "there's no need to ", "not ")
DETERMINERS = frozenset(
    ["the", "a", "an", "this", "that", "these", "those", "my", "your", "his", "her", "its", "our", "their", "some", "any", "it", "them", "him", "me", "us", "one", "two", "three", "each", "every", "all", "both", "another", "something", "everything"]
)
PARTICLES = frozenset(
    ["up", "down", "off", "on", "out", "in", "away", "over", "back", "aside", "apart", "together", "around", "open", "shut", "along"]
)
AFTER_VERB = (
    DETERMINERS | PARTICLES | frozenset(["with", "from", "into", "onto", "at", "to", "for", "using", "again"])
)
"""Words that follow a verb at the start of a new request."""
NEW_SUBJECT = re.compile(r",\s+(?=(?:i|i'm|i'll|i'd|we|we'll|you)\s)")

Order = Literal["after next", "as told"]


@dataclass(frozen=True)
class Segment:
    """One request or statement."""

    text: str
    """The words themselves, without what leads up to them."""
    framed: str
    """What the parser gets."""
    negated: bool
    order: Order = "as told"
    """"after next" where "before ..." puts it behind the segment that follows."""


def _is_request_start(words: list[str], at: int) -> bool:
    """Whether a base verb, with what may precede it, begins at word `at`."""
    verbs = load_lexicon().verbs
    while at < len(words) and words[at].strip(",") in FILLERS | CONNECTORS | {"please"}:
        at += 1
    if " ".join(words[at : at + 2]) in {"do not", "no need"}:
        at += 3 if words[at] == "no" else 2
    elif at < len(words) and words[at] in {"don't", "never", "not"}:
        at += 1
    if at >= len(words) or words[at].strip(",") not in verbs:
        return False
    following = words[at + 1].strip(",") if at + 1 < len(words) else ""
    return following in AFTER_VERB


def split_requests(sentence: str) -> list[str]:
    """Cut a sentence before each connector or comma that a new request follows."""
    parts = []
    for piece in NEW_SUBJECT.split(sentence):
        words = piece.split()
        start = 0
        for i in range(1, len(words)):
            boundary = words[i] in CONNECTORS or words[i - 1].endswith(",")
            inside = words[i - 1] in CONNECTORS and not words[i - 1].endswith(",")
            lone_verb = i - start < 2 and not words[i - 1].endswith(",")
            if boundary and not inside and not lone_verb and _is_request_start(words, i):
                parts.append(" ".join(words[start:i]))
                start = i
        parts.append(" ".join(words[start:]))
    return [part.strip(" ,") for part in parts if part.strip(" ,")]


def frame(part: str) -> Segment:
    """Put "you should (not)" before an imperative; leave anything else as it is."""
    order: Order = "as told"
    if part.startswith("before "):
        order = "after next"
    body = strip_opener(part)
    negated = False
    for negator in NEGATORS:
        if body.startswith(negator):
            body, negated = body[len(negator) :], True
            break
    body = strip_opener(body) if not negated else body
    first = body.partition(" ")[0].strip(",")
    pronoun_next = re.match(r"(do|have|will|would|can|could) (you|we|i)\b", body)
    if first in load_lexicon().verbs | IMPERATIVE_ONLY and not pronoun_next:
        framed = OPENER + ("not " if negated else "") + body
    elif negated:
        framed = "not " + body
    else:
        framed = body
    return Segment(part, framed, negated, order)


IMPERATIVE_ONLY = frozenset(["leave", "avoid", "stop", "quit", "refrain", "let", "go", "help", "touch", "cut", "need"])
"""Base verbs that start an imperative without naming an action of the data."""
