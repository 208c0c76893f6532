"""spaCy component `taskgrasp_objects`: where a text names objects of the data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from maniskill_taskgrasp.language.lexicon import SYNONYM_SCORE, load_lexicon
from maniskill_taskgrasp.language.model import import_spacy
from maniskill_taskgrasp.language.words import word_set

import_spacy()
from spacy.language import Language  # noqa: E402
from spacy.tokens import Doc  # noqa: E402

if TYPE_CHECKING:
    from spacy.tokens import Token

POSSESSIVE = word_set("possessive")
OWN_HAND = (("left hand", SYNONYM_SCORE),)
"""What "hand" alone names; "your hands" are no object to grasp."""
BEFORE_NOUN = word_set("possessive") | frozenset(["the", "a", "an", "that", "this"])
LONGEST_NAME = 5  # Words of the longest name.


@dataclass(frozen=True)
class Mention:
    """Words that name one or several objects."""

    start: int
    """First token."""
    end: int
    """Token behind the last."""
    head: int
    """Token by which the words hang in the sentence."""
    objects: tuple[tuple[str, float], ...]
    """Objects that the words may name, with scores, best first."""
    words: str


def _forms(token: Token) -> tuple[str, ...]:
    lower = token.lower_
    forms = [lower, token.lemma_.lower()]
    if lower.endswith("s") and len(lower) > 3:
        forms.append(lower[:-1])
    return tuple(dict.fromkeys(forms))


def _lookup(tokens: list[Token]) -> tuple[tuple[str, float], ...]:
    """Objects named by exactly these tokens, plural or not."""
    names = load_lexicon().names
    lead = " ".join(token.lower_ for token in tokens[:-1])
    for form in _forms(tokens[-1]):
        text = f"{lead} {form}".strip()
        joined = lead + form if len(tokens) == 2 else text  # "Screw driver".
        for variant in (text, text.replace(" - ", "-"), text.replace(" - ", " "), joined):
            if variant in names:
                return names[variant]
    return ()


def find_mentions(doc: Doc) -> tuple[Mention, ...]:
    """Longest names first from the left, skipping words that are used as verbs."""
    found = []
    at = 0
    while at < len(doc):
        for length in range(min(LONGEST_NAME + 4, len(doc) - at), 0, -1):
            tokens = list(doc[at : at + length])
            objects = _lookup(tokens)
            own_body = at > 0 and doc[at - 1].lower_ in POSSESSIVE and objects[:1] == OWN_HAND
            if objects and not own_body and not (length == 1 and is_used_as_verb(tokens[0])):
                span = doc[at : at + length]
                found.append(Mention(at, at + length, span.root.i, objects, span.text))
                at += length
                break
        else:
            at += 1
    return tuple(_join_contents(doc, found))


def _join_contents(doc: Doc, mentions: list[Mention]) -> list[Mention]:
    """Make one mention of a container and its contents: "bottle of laundry detergent"."""
    joined: list[Mention] = []
    for mention in mentions:
        before = joined[-1] if joined else None
        (name, _), *_rest = mention.objects
        if before and doc[before.end : mention.start].text == "of" and name.endswith(before.words):
            span = doc[before.start : mention.end]
            joined[-1] = Mention(before.start, mention.end, before.head, mention.objects, span.text)
        else:
            joined.append(mention)
    return joined


def is_used_as_verb(token: Token) -> bool:
    """Whether a word that may be an object ("hammer", "iron") is the verb here."""
    if token.i and token.nbor(-1).lower_ in BEFORE_NOUN:
        return False  # "Slide that wrench over", parsed as a verb.
    return token.pos_ in {"VERB", "AUX"} and token.dep_ not in {"compound", "pobj", "dobj"}


def _taskgrasp_objects(doc: Doc) -> Doc:
    """Fill `doc._.mentions`."""
    doc._.mentions = find_mentions(doc)
    return doc


@Language.factory(
    "taskgrasp_objects",
    requires=["token.lemma", "token.tag", "token.dep"],
    assigns=["doc._.mentions"],
)
def make_taskgrasp_objects(nlp: Language, name: str) -> object:
    """The component; it has no settings."""
    return _taskgrasp_objects


if not Doc.has_extension("mentions"):
    Doc.set_extension("mentions", default=())
