"""Sentences -> segments of one request each, framed so that the parser reads imperatives right."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from maniskill_taskgrasp.language.lexicon import load_lexicon
from maniskill_taskgrasp.language.text import FILLERS, OPENER, strip_opener
from maniskill_taskgrasp.language.words import word_list, word_map, word_set

CONNECTORS = word_set("connectors")
NEGATORS = tuple(f"{words.strip()} " for words in word_list("negators"))
DETERMINERS = word_set("determiners")
PARTICLES = word_set("particles")
AFTER_VERB = DETERMINERS | PARTICLES | word_set("after_verb")
"""Words that follow a verb at the start of a new request."""
IMPERATIVE_ONLY = word_set("imperative_only")
"""Base verbs that start an imperative without naming an action of the data."""
LEADING_TOOL = re.compile(r"(?:with|using|via|by|in|on|at|from)\s[^,]+?,\s*(?=\w)")
"""A phrase before the imperative that belongs behind it: "with the ruler, measure it"."""
ASKING = re.compile(
    r"(?:what|who|whose|when|where|why|how|which)\s(?:is|are|was|were|do|does|did|has|have|haven't|"
    r"will|would|can|many|much|old|long|far|tall|thick|wide|often)\b"
    r"|do you (?:have|know|like|love|believe|own|prefer|enjoy|remember|feel|hate|speak|live|work)\b"
    r"|(?:having|being)\s"
)
"""Questions for an answer in words, and participles: they ask for nothing to be done."""
BEHIND_UNKNOWN = word_set("behind_unknown")
"""Words that show the unknown word before them to be a verb: "shave with", "plate the"."""
FUNCTION_WORDS = word_set("english_words") | CONNECTORS | FILLERS
RETRACTING = re.compile(
    r"(?:(?:no(?! need)|nope|wait|sorry|(?:or )?rather|scratch that|actually,? just|"
    r"on second thought),?\s+)+"
)
"""What a speaker says before a request that takes the place of the one before it."""
NEW_SUBJECT = re.compile(
    r",\s+(?=(?:i|i'm|i'll|i'd|we|we'll|you|(?:can|could|would|will) you|is there|where is)\s)"
)

STATES = word_map("states")
"""What is wrong with a thing, and what people want done about it: "the hinge squeaks"."""
IN_STATE = re.compile(
    r"(?P<thing>(?:the|my|your|this|that|these|those|our|his|her|all|both)\s(?:[\w'-]+\s){1,4}?)"
    r"(?:(?:is|are|looks?|feels?|got|gets?|keeps?|seems?)\s)?"
    r"(?:(?:so|very|all|really|quite|pretty|still|too|completely|again)\s)*"
    rf"(?P<state>{'|'.join(sorted(map(re.escape, STATES), key=len, reverse=True))})(?: again)?"
)
TELLING_WORDS = frozenset(
    ["i", "he", "she", "they", "we", "it", "who", "the", "a", "an", "my", "of", "to"]
)
"""Words after which a base form tells rather than asks ("they open the door")."""
SPEAKING = word_set("speaking")
"""Imperatives that are no task for the hand, whatever follows: "remind me to call"."""
SUBJECT_WORDS = word_set("subject_words")
"""Words that start a clause of another kind: subjects, question words, auxiliaries."""

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
    inner: str | None = None
    """The framed imperative somewhere inside, for when nothing else is understood."""
    asking: bool = False
    """It asks for nothing to be done: a question for an answer in words, or taken back."""
    speaking: bool = False
    """It asks for something that no hand does: "order me a burger"."""


def _is_request_start(words: list[str], at: int) -> bool:
    """Whether a base verb, with what may precede it, begins at word `at`."""
    verbs = load_lexicon().verbs
    retracting = RETRACTING.match(" ".join([*words[at:], ""]))
    at += len(retracting.group().split()) if retracting else 0
    while at < len(words) and words[at].strip(",") in FILLERS | CONNECTORS | {"please"}:
        at += 1
    if " ".join(words[at : at + 2]) in {"do not", "no need"}:
        at += 3 if words[at] == "no" else 2
    elif at < len(words) and words[at] in {"don't", "never", "not"}:
        at += 1
    if at >= len(words) or words[at].strip(",") not in verbs:
        return False
    following = words[at + 1].strip(",") if at + 1 < len(words) else ""
    names = load_lexicon().names
    named = following in names and words[at].strip(",") not in names
    return following in AFTER_VERB or named


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
            choice = words[i] in {"or", "nor"}
            lead = LEADING_TOOL.match(" ".join([*words[start:i], "x"]))
            retraction = RETRACTING.fullmatch(" ".join([*words[start:i], ""]))
            joined = inside or lone_verb or choice or lead or retraction
            if boundary and not joined and _is_request_start(words, i):
                parts.append(" ".join(words[start:i]))
                start = i
        parts.append(" ".join(words[start:]))
    return [part.strip(" ,") for part in parts if part.strip(" ,")]


def _starts_request(body: str) -> bool:
    """Whether the first word is an imperative; an unknown word before an article may be one."""
    first = body.partition(" ")[0].strip(",")
    asks_person = re.match(r"(do|have|will|would|can|could) (you|we|i)\b", body)
    if first in load_lexicon().verbs | IMPERATIVE_ONLY:
        return not asks_person
    second = body.partition(" ")[2].partition(" ")[0]
    grammar = first in FUNCTION_WORDS | SUBJECT_WORDS or not first.replace("-", "").isalpha()
    noun_or_grammar = grammar or first in load_lexicon().names
    return second in BEHIND_UNKNOWN and not noun_or_grammar


def _move_lead_behind(body: str) -> str:
    """The imperative first where a phrase stands before it, with or without its comma."""
    lead = LEADING_TOOL.match(body)
    if lead and _starts_request(strip_opener(body[lead.end() :])):
        return f"{strip_opener(body[lead.end() :])} {lead.group().strip(' ,')}"
    if body.partition(" ")[0] in {"with", "using", "by"}:
        words = body.split()
        for at in range(2, len(words)):
            if _is_request_start(words, at):
                return " ".join([*words[at:], *words[:at]])
    return body


def _inner_request(body: str) -> str | None:
    """An imperative inside a segment that does not start with one: "task three open the door"."""
    words = body.split()
    for at in range(1, len(words)):
        told = words[at - 1] in TELLING_WORDS | DETERMINERS
        denied = any(w in {"not", "never"} or w.endswith("n't") for w in words[:at])
        starts = words[at] in load_lexicon().verbs and _is_request_start(words, at)
        if starts and not told and not denied:
            return OPENER + " ".join(words[at:])
    return None


NAMED_FIRST = re.compile(
    r"(?:a|an|the|my|your|that|some) (?P<name>(?:[\w-]+ ){0,3}?[\w-]+),? "
    r"(?:so |to (?!the|my|your|a\b)|for [\w-]+ing)"
)
"""A thing and what for, without a verb before it: "a cloth, so I can ..."."""


def _give(body: str) -> str:
    """A thing asked for by its name and purpose as the transfer that it is."""
    named = NAMED_FIRST.match(body)
    return f"give me {body}" if named and named["name"] in load_lexicon().names else body


def strip_retraction(part: str) -> tuple[str, bool]:
    """A request without "no, wait" before it, and whether that was there."""
    said = RETRACTING.match(part)
    if said is None or not _is_request_start(part.split(), 0):
        return part, False
    return part[said.end() :], True


def frame(part: str) -> Segment:
    """Put "you should (not)" before an imperative; leave anything else as it is."""
    order: Order = "after next" if part.startswith("before ") else "as told"
    body = strip_opener(re.sub(r"\bplease\b,?\s*", "", part))
    negated = False
    for negator in NEGATORS:
        if body.startswith(negator):
            body, negated = body[len(negator) :], True
            break
    body = body if negated else _give(_move_lead_behind(strip_opener(body)))
    inner = None if negated or ASKING.match(body) else _inner_request(body)
    if _starts_request(body):
        framed = OPENER + ("not " if negated else "") + body
    else:
        framed = "not " + body if negated else body
    first = body.partition(" ")[0]
    asking = first in SPEAKING or bool(ASKING.match(body))
    speaking = first in SPEAKING and first != "forget"  # "Forget the mop, take the vacuum".
    return Segment(part, framed, negated, order, inner, asking, speaking)


SOILED = re.compile(
    r"there (?:is|are) (?:\w+ ){1,3}?(?:all over|all across|everywhere on|on) (?P<thing>[\w' -]+)"
)
"""What lies where it should not: "there is dust on the shelf"."""
SOILS = word_set("soils")


def request_of_state(sentence: str) -> str | None:
    """What a complaint asks for: "the hinge squeaks" -> "oil the hinge"."""
    sentence = sentence.replace("'s ", " is ")
    soiled = SOILED.fullmatch(sentence)
    if soiled and SOILS & set(sentence.split()):
        return f"clean {soiled['thing']}"
    told = IN_STATE.fullmatch(sentence)
    return f"{STATES[told['state']]} {told['thing'].strip()}" if told else None
