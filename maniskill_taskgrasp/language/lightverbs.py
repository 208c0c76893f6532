"""Verbs that leave their meaning to a noun: "give it a wipe", "the rod needs a clean"."""

from __future__ import annotations

from typing import TYPE_CHECKING

from maniskill_taskgrasp.language.lexicon import LIGHT_VERBS, load_lexicon
from maniskill_taskgrasp.language.moods import SELF, subject_of
from maniskill_taskgrasp.language.verbs import base_of
from maniskill_taskgrasp.language.words import word_set

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

RECEIVERS = word_set("receivers")
PERSONAL = SELF | RECEIVERS | frozenset(["you", "he", "she", "they", "who"])
INDEFINITE = word_set("indefinite")
NEEDING = word_set("needing")
"""Verbs by which a thing asks for treatment: "the rod needs a wipe"."""


def _is_listed(light: str, noun: str, base: str) -> bool:
    """Whether the lexicon means something else by verb and noun: "take a reading" measures."""
    phrases = load_lexicon().phrases
    pair = {p.action for p in phrases.get(light, ()) if noun in p.nouns}
    alone = {p.action for p in phrases.get(base, ()) if p.specificity == 1}
    return bool(pair) and not pair & alone


def light_noun(doc: Doc, verb: int, high: int) -> int | None:
    """Token of the noun that carries the meaning of a light verb, None where it has its own.

    A noun that may be an object ("a brush") is meant as its verb only where something else is
    treated with it ("give the floor a brush"), never where a person receives it.
    """
    receiver = verb + 1 < high and doc[verb + 1].lower_ in RECEIVERS
    named = {i for m in doc._.mentions for i in range(m.start, m.end)}
    direct = verb + 1 < high and doc[verb + 1].lower_ in INDEFINITE
    giving = doc[verb].lemma_ in {"give", "do"} and not receiver and not direct
    light = doc[verb].lemma_
    doing = light in {"do", "perform", "take", "make"}
    for at in range(verb + 1, high):
        token = doc[at]
        if token.dep_ == "prep" and token.lower_ not in {"of"}:
            return None
        base = base_of(token.lower_)
        if token.pos_ not in {"NOUN", "VERB"} or base is None or base in LIGHT_VERBS:
            continue
        if _is_listed(light, token.lower_, base):
            return None
        between = doc[verb + 1 : at]
        articles = [t.lower_ for t in between if t.pos_ in {"DET", "PRON"}]
        indefinite = bool(articles) and articles[-1] in INDEFINITE
        if at in named:
            if giving and indefinite:
                return at
            continue
        bare = not any(t.pos_ == "DET" for t in between) and token.dep_ == "dobj"
        deverbal = doing and token.lower_.endswith(("ing", "ment", "ion"))
        if deverbal or indefinite or bare:
            return at
    return None


def needed_noun(token: Token) -> int | None:
    """Token of the treatment that a thing needs: "needs a wipe", "could do with a clean"."""
    if token.lemma_ not in NEEDING:
        return None
    subject = subject_of(token)
    if subject is None or subject.lower_ in PERSONAL:
        return None
    if token.i + 1 < len(token.doc) and token.nbor().lower_.endswith("ing"):
        return token.i + 1 if base_of(token.nbor().lower_) else None
    for child in token.subtree:
        treated = child.dep_ in {"dobj", "pobj"} and child.i > token.i
        article = [c.lower_ for c in child.children if c.dep_ == "det"]
        if treated and article[:1] in (["a"], ["an"], ["some"]) and base_of(child.lower_):
            return child.i
    return None
