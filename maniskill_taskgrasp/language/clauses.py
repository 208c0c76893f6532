"""spaCy component `taskgrasp_clauses`: what each verb of a sentence asks for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from maniskill_taskgrasp.language.lexicon import LIGHT_VERBS, TRANSFER_VERBS
from maniskill_taskgrasp.language.mentions import Mention
from maniskill_taskgrasp.language.model import import_spacy
from maniskill_taskgrasp.language.moods import (
    CARRIERS,
    Mood,
    is_framed,
    is_negated,
    is_passive,
    mood_of,
)
from maniskill_taskgrasp.language.roles import Role, find_roles
from maniskill_taskgrasp.language.verbs import base_of

import_spacy()
from spacy.language import Language  # noqa: E402
from spacy.tokens import Doc  # noqa: E402

if TYPE_CHECKING:
    from spacy.tokens import Token

RECEIVERS = frozenset(["me", "us", "him", "her", "them"])
NEEDY = frozenset(["need", "want", "like", "have", "borrow"])
"""Carriers that ask for a transfer when a noun follows: "I need the pliers"."""
PREVERBAL = frozenset(["aux", "auxpass", "neg", "nsubj", "nsubjpass", "mark", "expl", "cc", "preconj"])
INDEFINITE = frozenset(["a", "an", "another", "some", "one"])
RECEIVED_ONLY = frozenset(["toss", "reach", "fling", "slide", "shoot", "pass", "give", "hand", "throw"])
"""Verbs that are transfers only with a receiver or a direction ("slide me the cup")."""


@dataclass(frozen=True)
class Clause:
    """One verb with its parts."""

    verb: str
    """Base form; the noun's verb where the verb is light ("give it a wipe" -> wipe)."""
    words: tuple[str, ...]
    """Lower-case words and lemmas behind the verb, in order, for phrases such as "put away"."""
    roles: tuple[Role, ...]
    mood: Mood
    negated: bool
    transfer: bool
    """The verb asks for an object without naming a use."""
    purpose: bool
    """It hangs on another verb: "so I can ...", "to ...", "for ...ing"."""
    text: str
    """The clause as a short imperative, for the sentence encoder."""
    at: int
    """Token of the verb."""

    def role(self, kind: str) -> Role | None:
        """First role of a kind."""
        return next((r for r in self.roles if r.kind == kind), None)


def _verb_tokens(doc: Doc) -> list[tuple[Token, str]]:
    """Tokens that act as verbs, with base forms; "using" before a noun is a preposition."""
    found = []
    for token in doc:
        framed = is_framed(token)
        base = base_of(token.lower_) or base_of(token.lemma_.lower())
        verbal = token.pos_ == "VERB" or (
            token.pos_ == "AUX" and token.dep_ not in {"aux", "auxpass"} and token.lemma_ != "be"
        )
        gerund = token.lower_.endswith("ing") and base is not None and _is_gerund(token)
        if token.lower_ == "using" and len(doc) > 3 and token.i > 0:
            continue
        if token.dep_ in {"amod", "compound"} and not framed:
            continue
        if (framed and token.lower_ not in {"you", "should", "not"} and token.i < 4) or verbal or gerund:
            found.append((token, base or token.lemma_.lower()))
    return found


def _is_gerund(token: Token) -> bool:
    return token.pos_ in {"NOUN", "VERB"} and (
        token.head.lemma_ in {"need", "want", "require", "deserve", "mind", "avoid", "stop"}
        or token.dep_ in {"pcomp", "ROOT"}
    )


def _start(token: Token, floor: int) -> int:
    """Where the clause of a verb begins: its subject, auxiliaries and marks belong to it."""
    lefts = [c.left_edge.i for c in token.lefts if c.dep_ in PREVERBAL and c.left_edge.i >= floor]
    return min([token.i, *lefts])


def _light_noun(doc: Doc, verb: int, high: int, mentions: tuple[Mention, ...]) -> int | None:
    """Token of the noun that carries the meaning of a light verb, None where it has its own."""
    receiver = verb + 1 < high and doc[verb + 1].lower_ in RECEIVERS
    named = {i for m in mentions for i in range(m.start, m.end)}
    for at in range(verb + 1, high):
        token = doc[at]
        if token.dep_ == "prep" and token.lower_ not in {"of"}:
            return None
        base = base_of(token.lower_)
        verbal_noun = (
            token.pos_ in {"NOUN", "VERB"} and base is not None and base not in LIGHT_VERBS
        )
        if not verbal_noun or (receiver and at in named):
            continue
        articles = [t.lower_ for t in doc[verb + 1 : at] if t.pos_ in {"DET", "PRON"}]
        indefinite = bool(articles) and articles[-1] in INDEFINITE
        bare = not any(t.pos_ == "DET" for t in doc[verb + 1 : at]) and at not in named
        doing = doc[verb].lemma_ in {"do", "perform", "take", "make"} and (
            token.lower_.endswith(("ing", "ment", "ion"))
        )
        if doing or indefinite or (bare and token.dep_ == "dobj"):
            return at
    return None


def _is_transfer(
    doc: Doc, verb: int, base: str, words: tuple[str, ...], roles: tuple[Role, ...]
) -> bool:
    if base in NEEDY and base not in TRANSFER_VERBS:
        return any(r.kind == "target" for r in roles)
    if base == "let":
        return words[:2] == ("me", "have")
    if base not in TRANSFER_VERBS | {"throw"}:
        return False
    receiver = bool(set(words[:1]) & RECEIVERS) or {"me", "us", "here", "over"} & set(words)
    if base in RECEIVED_ONLY:
        return bool(receiver) or base in {"pass", "hand", "give"}
    return True


def _clause_text(doc: Doc, base: str, verb: int, high: int, subject: list[Token]) -> str:
    rest = [t.text for t in doc[verb + 1 : high] if t.lower_ not in {"please"}]
    told = [t.text for t in subject]
    return " ".join([base, *told, *rest]).strip(" ,")


def build_clauses(doc: Doc) -> tuple[Clause, ...]:
    """Clauses of a parsed segment, in the order told."""
    verbs = _verb_tokens(doc)
    starts = []
    floor = 0
    for token, _ in verbs:
        starts.append(_start(token, floor))
        floor = token.i + 1
    clauses = []
    for k, (token, base) in enumerate(verbs):
        high = starts[k + 1] if k + 1 < len(verbs) else len(doc)
        clause = _build(doc, token, base, max(high, token.i + 1))
        if clause is not None:
            clauses.append(clause)
    return tuple(clauses)


def _has_complement(token: Token) -> bool:
    """Whether another verb completes this one."""
    return any(
        c.dep_ in {"xcomp", "ccomp"} and (c.pos_ in {"VERB", "NOUN"}) for c in token.children
    ) or any(
        c.dep_ == "dobj" and c.lower_.endswith("ing") and base_of(c.lower_) for c in token.children
    )


def _passive_subject(token: Token) -> list[Token]:
    """Tokens of the subject that a passive verb acts on."""
    for verb in (token, token.head, token.head.head):
        for child in verb.lefts:
            if child.dep_ in {"nsubj", "nsubjpass"}:
                return list(child.subtree)
    return []


def _build(doc: Doc, token: Token, base: str, high: int) -> Clause | None:
    mentions = doc._.mentions
    framed = is_framed(token)
    if token.lemma_ in CARRIERS and not framed and _has_complement(token):
        return None
    low, subject = token.i, []
    if is_passive(token):
        subject = _passive_subject(token) or []
        low = min([t.i for t in subject], default=low)
    verb = token.i
    if base in LIGHT_VERBS:
        noun = _light_noun(doc, verb, high, mentions)
        if noun is not None:
            return _finish(doc, token, base_of(doc[noun].lower_) or base, noun, verb, high, [])
    return _finish(doc, token, base, verb, low, high, subject)


def _finish(
    doc: Doc, token: Token, base: str, verb: int, low: int, high: int, subject: list[Token]
) -> Clause:
    """Put a clause together.

    Args:
        doc: parsed segment.
        token: verb that the grammar hangs on.
        base: base form that names the action.
        verb: token that names the action: `token`, or the noun of a light verb.
        low: first token of the clause.
        high: token behind its last.
        subject: what a passive verb acts on.
    """
    mentions = tuple(m for m in doc._.mentions if not m.start <= verb < m.end)
    roles = find_roles(doc, mentions, token.i if verb == token.i else verb, low, high)
    words = tuple(w for t in doc[token.i + 1 : high] if t.i != verb for w in (t.lower_, t.lemma_))
    purpose = token.dep_ in {"advcl", "relcl", "acl", "pcomp"} or any(
        c.lower_ in {"to", "so"} and c.dep_ in {"aux", "mark"} for c in token.children
    )
    told = subject if verb == token.i else [t for t in doc[token.i + 1 : verb] if t.i != verb]
    return Clause(
        verb=base,
        words=words,
        roles=roles,
        mood=mood_of(token),
        negated=is_negated(token),
        transfer=_is_transfer(doc, token.i, base, words, roles) and verb == token.i,
        purpose=purpose and not is_framed(token),
        text=_clause_text(doc, base, verb, high, told),
        at=token.i,
    )


def _taskgrasp_clauses(doc: Doc) -> Doc:
    """Fill `doc._.clauses`."""
    doc._.clauses = build_clauses(doc)
    return doc


@Language.factory(
    "taskgrasp_clauses",
    requires=["token.pos", "token.dep", "token.lemma", "token.tag", "doc._.mentions"],
    assigns=["doc._.clauses"],
)
def make_taskgrasp_clauses(nlp: Language, name: str) -> object:
    """The component; it has no settings."""
    return _taskgrasp_clauses


if not Doc.has_extension("clauses"):
    Doc.set_extension("clauses", default=())
