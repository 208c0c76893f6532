"""Which part the nouns of a clause play: what is held, what is worked on, where it happens."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from maniskill_taskgrasp.language.words import word_set

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

    from maniskill_taskgrasp.language.mentions import Mention

RoleKind = Literal["target", "instrument", "source", "place"]

INSTRUMENT_WORDS = word_set("instrument_words")
SOURCE_WORDS = word_set("source_words")
PLACE_WORDS = word_set("place_words")
PRONOUNS = word_set("pronouns")
SOMETHING = word_set("something")
RULING_OUT = frozenset(["anything", "everything", "something", "all"])
"""Words before "but the towel"."""
TOKENS_IN_PHRASE = word_set("tokens_in_phrase")


@dataclass(frozen=True)
class Role:
    """One noun or pronoun and its part."""

    kind: RoleKind
    text: str
    at: int
    """Token where its noun starts."""
    mention: Mention | None = None
    """The object it names; None for a pronoun or a noun that the lexicon does not know."""
    pronoun: bool = False
    part_of: bool = False
    """It stands behind "of"."""

    @property
    def certainty(self) -> float:
        """How surely its words name an object; 0 where they name none."""
        return self.mention.objects[0][1] if self.mention is not None else 0.0


def governor(doc: Doc, start: int, low: int) -> str | None:
    """The preposition (or "using") that leads a noun phrase, None for a bare one."""
    for at in range(start - 1, low, -1):
        token = doc[at]
        if token.lower_ in INSTRUMENT_WORDS | SOURCE_WORDS | PLACE_WORDS:
            return None if token.dep_ == "prt" else token.lower_
        if token.lower_ in {"of", "'s"}:
            continue
        before_noun = token.dep_ in {
            "amod",
            "compound",
            "poss",
            "det",
            "nmod",
            "nummod",
            "npadvmod",
        }
        if before_noun or token.pos_ in {"DET", "ADJ", "NUM", "ADV"}:
            continue
        if token.lower_ in PRONOUNS or (at + 1 < start and doc[at + 1].lower_ == "of"):
            continue
        return None
    return None


def is_denied(doc: Doc, start: int) -> bool:
    """Whether a noun is named only to rule it out: "but not with the sponge"."""
    at = start - 1
    while at >= 0 and (doc[at].pos_ in {"DET", "ADJ", "PRON"} or doc[at].lower_ == "with"):
        at -= 1
    if at > 0 and doc[at].lower_ in {"but", "except"} and doc[at - 1].lower_ in RULING_OUT:
        return True
    return 0 < at < start - 1 and doc[at].lower_ == "not" and doc[at - 1].pos_ != "AUX"


def _kind_of(word: str | None) -> RoleKind:
    """The part that a preposition gives its noun."""
    if word in INSTRUMENT_WORDS:
        return "instrument"
    if word in SOURCE_WORDS:
        return "source"
    return "place" if word in PLACE_WORDS else "target"


def _phrase(token: Token) -> str:
    """The noun with what stands before it, without article."""
    words = [t.text for t in token.lefts if t.dep_ in {"amod", "compound", "nmod"}]
    return " ".join([*words, token.text])


def find_roles(
    doc: Doc, mentions: tuple[Mention, ...], verb: int, low: int, high: int
) -> tuple[Role, ...]:
    """Roles of all nouns and pronouns in the tokens [low, high) but the verb.

    A noun right behind the verb's preposition ("put on the goggles", "look at the coin") is the
    target where the clause has no other.
    """
    named = {i: m for m in mentions for i in range(m.start, m.end)}
    roles: list[Role] = []
    at = low
    while at < high:
        token = doc[at]
        mention = named.get(at)
        stop = verb if at > verb else low - 1
        if mention is not None and not mention.start <= verb < mention.end:
            kind = _kind_of(governor(doc, mention.start, stop)) if at > verb else "target"
            of = any(t.lower_ == "of" for t in doc[max(0, mention.start - 2) : mention.start])
            if not is_denied(doc, mention.start):
                roles.append(Role(kind, mention.words, mention.start, mention, part_of=of))
            at = mention.end
            continue
        if at != verb and token.lower_ in PRONOUNS and token.dep_ not in {"det", "mark", "expl"}:
            kind = _kind_of(governor(doc, at, stop)) if at > verb else "target"
            roles.append(Role(kind, token.lower_, at, pronoun=True))
        elif at != verb and _is_noun(token):
            kind = _kind_of(governor(doc, at, stop)) if at > verb else "target"
            roles.append(Role(kind, _phrase(token), at))
        at += 1
    if not any(r.kind == "target" for r in roles):
        roles = [_promoted(r, doc, verb) for r in roles]
    return tuple(roles)


def _is_noun(token: Token) -> bool:
    head_noun = token.pos_ in {"NOUN", "PROPN"} and token.dep_ not in {
        "compound",
        "nmod",
        "npadvmod",
    }
    return (head_noun or token.lower_ in SOMETHING) and token.is_alpha


def _promoted(role: Role, doc: Doc, verb: int) -> Role:
    beside_verb = role.kind == "place" and doc[min(verb + 1, len(doc) - 1)].lower_ in PLACE_WORDS
    between = [t for t in doc[verb + 2 : role.at] if t.pos_ not in TOKENS_IN_PHRASE | {"PRON"}]
    return replace(role, kind="target") if beside_verb and not between else role
