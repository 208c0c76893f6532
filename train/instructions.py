"""Whole instructions filled by code: a phrase of the lexicon in one of many frames of talking.

Each frame (`frames.txt`) is a way in which people talk: orders, favours, needs, passives, tools
handed over for a purpose, sequences, chatter around the request; asking for an object itself;
what is said around a situation; talk that asks for nothing. Slots:

{imp}   "tighten the bolt with the wrench"      {ger}   "tightening the bolt with the wrench"
{np}    "the bolt"                              {done}  "tightened with the wrench"
{doing} "tightening with the wrench"            {held}  "wrench"
{it}    "tighten it with the wrench"            {other} another imperative
{bare}  "tighten the bolt"                      {baring} "tightening the bolt"
{past}  "tightened the bolt with the wrench"    {doneall} the same as a participle
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.lexicon import TOOL_ACTIONS, Phrase, load_lexicon
from maniskill_taskgrasp.language.objects import HAND_TOOLS, PHONING, used_for
from maniskill_taskgrasp.language.verbs import DOUBLING, IRREGULAR
from maniskill_taskgrasp.language.words import word_list

PEOPLE = word_list("people")
"""Whom people phone."""
TARGETS = word_list("targets")
"""Things that tools are used on; the table's own objects are what is held."""
USUAL_TOOL = 0.7  # Share of sentences whose object people really used for the action.
SYNONYM = 0.4  # Share of objects that are called by another name.
TERSE = 0.08  # Share of requests without articles, as notes and learners of English have them.


@cache
def frames(kind: str) -> tuple[str, ...]:
    """Frames of a kind: "requests", "transfers", "situations", "idle" or (no slots) "chatter"."""
    sections: dict[str, list[str]] = {}
    for line in Path(__file__).with_name("frames.txt").read_text("utf-8").splitlines():
        if line.startswith("["):
            lines = sections.setdefault(line.strip("[]"), [])
        else:
            lines.append(line)
    return tuple(sections[kind])


OFF_TOPIC_VERBS = word_list("off_topic_verbs")
OFF_TOPIC_NOUNS = word_list("off_topic_nouns")


@dataclass(frozen=True)
class Words:
    """One request in pieces."""

    verb: str
    rest: str
    """What follows the verb but its object: particle or noun."""
    np: str
    tool: str
    """"with the wrench", empty where none is named."""
    held: str
    split: bool
    """The object stands between verb and particle."""

    def told(self, verb: str, *, np: str | None = None, tool: bool = True) -> str:
        """The request with a form of its verb."""
        np = self.np if np is None else np
        inner = (np, self.rest) if self.split else (self.rest, np)
        return " ".join(filter(None, (verb, *inner, self.tool if tool else "")))


def gerund(verb: str) -> str:
    """The -ing form."""
    if verb.endswith("ie"):
        return verb[:-2] + "ying"
    if verb.endswith("e") and not verb.endswith(("ee", "oe", "ye")):
        return verb[:-1] + "ing"
    return (verb + verb[-1] if _doubles(verb) else verb) + "ing"


def participle(verb: str) -> str:
    """The past participle."""
    if verb in IRREGULAR:
        return IRREGULAR[verb].split()[-1]
    if verb.endswith("e"):
        return verb + "d"
    if verb.endswith("y") and verb[-2:-1] not in "aeiou":
        return verb[:-1] + "ied"
    return (verb + verb[-1] if _doubles(verb) else verb) + "ed"


def past(verb: str) -> str:
    """The past tense."""
    return IRREGULAR[verb].split()[0] if verb in IRREGULAR else participle(verb)


def _doubles(verb: str) -> bool:
    vowels = sum(c in "aeiou" for c in verb)
    short = len(verb) > 2 and vowels == 1 and verb[-2] in "aeiou"
    return short and verb[-1] in DOUBLING


def _call(name: str, rng: random.Random) -> str:
    """An object by its name or by one of its synonyms."""
    others = [n for n, found in load_lexicon().names.items() if found[0][0] == name and n != name]
    return rng.choice(others) if others and rng.random() < SYNONYM else name


def choose_words(phrase: Phrase, rng: random.Random) -> Words:
    """Fill a phrase of the lexicon with things."""
    used = [name for name, _ in used_for(phrase.action)] or [*HAND_TOOLS]
    usual = rng.random() < USUAL_TOOL
    held = _call(rng.choice(used if usual else sorted(load_knowledge().objects)), rng)
    target = rng.choice(PEOPLE if phrase.action in PHONING else TARGETS)
    article = rng.choice(["the", "the", "the", "this", "that", "my", "a", "those", "your"])
    noun = rng.choice(sorted(phrase.nouns)) if phrase.nouns else ""
    rest = " ".join(phrase.words)
    split = bool(rest) and rng.random() < 0.5
    if phrase.action in TOOL_ACTIONS:
        tool = f"with {rng.choice(['the', 'a', 'this', 'my'])} {held}" if rng.random() < 0.4 else ""
        np = f"{article} {noun or (target if rng.random() < 0.8 else held)}"
        return Words(phrase.verb, rest, np, tool, held, split)
    np = f"{article} {noun or held}"
    where = f"{rng.choice(['on', 'from', 'near', 'in'])} the {target}"
    return Words(phrase.verb, rest, np, where if rng.random() < 0.2 else "", held, split)


def fill_frame(phrase: Phrase, other: Phrase, rng: random.Random, frame: str | None = None) -> str:
    """One whole instruction that asks for a phrase's action.

    Args:
        phrase: what is asked for.
        other: what a sequence asks for afterwards, or what is forbidden.
        rng: source of the choices.
        frame: one of those of "requests"; drawn where None.
    """
    words, more = choose_words(phrase, rng), choose_words(other, rng)
    frame = rng.choice(frames("requests")) if frame is None else frame
    text = _filled(frame, words, more)
    if rng.random() < TERSE:
        text = " ".join(w for w in text.split() if w not in {"the", "a", "an", "my", "this"})
    return text


def _filled(frame: str, words: Words, more: Words) -> str:
    doing, done = gerund(words.verb), participle(words.verb)
    return frame.format(
        imp=words.told(words.verb),
        ger=words.told(doing),
        past=words.told(past(words.verb)),
        bare=words.told(words.verb, tool=False),
        baring=words.told(doing, tool=False),
        it=words.told(words.verb, np="it"),
        doing=words.told(doing, np=""),
        done=words.told(done, np=""),
        doneall=words.told(done),
        np=words.np,
        held=words.held,
        name=words.held,
        other=more.told(more.verb, tool=False),
        otherger=more.told(gerund(more.verb), tool=False),
    )


def fill_idle_frame(phrase: Phrase, rng: random.Random) -> str:
    """One text that asks for nothing, with the words of a phrase that would.

    Args:
        phrase: what it speaks of.
        rng: source of the choices.
    """
    words = choose_words(phrase, rng)
    frame = rng.choice(frames("idle")).replace("{verb}", rng.choice(OFF_TOPIC_VERBS))
    return _filled(frame.replace("{topic}", rng.choice(OFF_TOPIC_NOUNS)), words, words)


def fill_transfer(rng: random.Random) -> str:
    """One request for an object itself."""
    names = sorted(load_knowledge().objects)
    held, other = (_call(rng.choice(names), rng) for _ in range(2))
    return rng.choice(frames("transfers")).format(
        held=held, other=other, place=rng.choice(["table", "shelf", "bench", "floor", "drawer"])
    )


def fill_situation(said: str, rng: random.Random) -> str:
    """One way of telling a situation that asks for an action without naming it."""
    return rng.choice(frames("situations")).format(said=said)
