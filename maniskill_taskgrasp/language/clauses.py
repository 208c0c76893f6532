"""spaCy component `taskgrasp_clauses`: what each verb of a sentence asks for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from maniskill_taskgrasp.language.lexicon import (
    LIGHT_VERBS,
    TRANSFER_VERBS,
    load_lexicon,
    matches,
)
from maniskill_taskgrasp.language.lightverbs import (
    INDEFINITE,
    NEEDING,
    PERSONAL,
    RECEIVERS,
    light_noun,
    needed_noun,
)
from maniskill_taskgrasp.language.mentions import BEFORE_NOUN
from maniskill_taskgrasp.language.model import import_spacy
from maniskill_taskgrasp.language.moods import (
    CARRIERS,
    SELF,
    Mood,
    is_direct,
    is_framed,
    is_inverted,
    is_negated,
    is_passive,
    mood_of,
    obligation,
    subject_of,
)
from maniskill_taskgrasp.language.roles import Role, find_roles
from maniskill_taskgrasp.language.verbs import base_of
from maniskill_taskgrasp.language.words import word_map, word_set

import_spacy()
from spacy.language import Language  # noqa: E402
from spacy.tokens import Doc  # noqa: E402

if TYPE_CHECKING:
    from spacy.tokens import Token

    from maniskill_taskgrasp.language.mentions import Mention

NEEDY = word_set("needy")
"""Carriers that ask for a transfer when a noun follows: "I need the pliers"."""
WISHED = frozenset(["have", "like", "love"])
"""Those that ask only after "would" or the like."""
PREVERBAL = word_set("preverbal")
RECEIVED_ONLY = word_set("received_only")
"""Verbs that are transfers only with a receiver or a direction ("slide me the cup")."""
SEARCHING = frozenset(["find", "locate"])
RESULTS = word_map("results")
"""States that a thing is brought into, with their actions: "push it shut"."""


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
    result: str | None = None
    """State that the thing is to be in afterwards: "open", "tight"."""
    earlier: bool = False
    """It is to be done before the clause it hangs on: "after washing ..."."""
    direct: bool = False
    """It is asked of the hearer, not told as a need: "could you open it?"."""

    def role(self, kind: str) -> Role | None:
        """First role of a kind, one that names an object before one that does not."""
        found = [r for r in self.roles if r.kind == kind]
        named = [r for r in found if r.mention is not None]
        if len(named) > 1 and named[1].part_of and named[0].certainty < named[1].certainty:
            return named[1]  # "The page of the book" is the book.
        return next(iter(named or found), None)


def _verb_tokens(doc: Doc) -> list[tuple[Token, str]]:
    """Tokens that act as verbs, with base forms; "using" before a noun is a preposition."""
    found = []
    in_name = {i for m in doc._.mentions if m.end - m.start > 1 for i in range(m.start, m.end)}
    for token in doc:
        if _is_nominal(token):
            continue
        framed = is_framed(token) and token.lower_ not in {"you", "should", "not"} and token.i < 4
        if not framed and (token.i in in_name or token.dep_ in {"amod", "compound"}):
            continue
        if token.lower_ == "using" and len(doc) > 3 and token.i > 0:
            continue
        if not framed and token.lower_ in RESULTS and doc[token.i - 1].pos_ in {"NOUN", "PROPN"}:
            continue  # "Ease the drawer shut" has one verb.
        base = base_of(token.lower_) or base_of(token.lemma_.lower())
        main_auxiliary = token.pos_ == "AUX" and token.dep_ not in {"aux", "auxpass"}
        verbal = token.pos_ == "VERB" or (main_auxiliary and token.lemma_ != "be")
        gerund = token.lower_.endswith("ing") and base is not None and _is_gerund(token)
        participle = token.dep_ == "acomp" and base is not None and token.lower_ != base
        if framed or verbal or gerund or (participle and token.lower_.endswith(("ed", "en"))):
            found.append((token, base or token.lemma_.lower()))
    return found


def _is_nominal(token: Token) -> bool:
    """Whether a word parsed as a verb is the noun of an article: "a quarter turn"."""
    named = any(m.start <= token.i < m.end for m in token.doc._.mentions)
    if named and token.i and token.nbor(-1).lower_ in BEFORE_NOUN:
        return True
    before = [t.lower_ for t in token.doc[max(0, token.i - 2) : token.i]]
    return token.dep_ == "dobj" and token.tag_ == "VB" and bool({"a", "an"} & set(before))


def _is_gerund(token: Token) -> bool:
    return token.pos_ in {"NOUN", "VERB"} and (
        token.head.lemma_ in {"need", "want", "require", "deserve", "mind", "avoid", "stop"}
        or token.dep_ in {"pcomp", "ROOT"}
    )


def _start(token: Token, floor: int) -> int:
    """Where the clause of a verb begins: its subject, auxiliaries and marks belong to it."""
    lefts = [c.left_edge.i for c in token.lefts if c.dep_ in PREVERBAL and c.left_edge.i >= floor]
    return min([token.i, *lefts])


def _is_transfer(doc: Doc, token: Token, base: str, clause: Clause) -> bool:
    """Whether the verb asks for the object itself, and no phrase gives it another meaning."""
    verb = token.i
    if base in NEEDY and clause.result is not None:
        return False  # "It's the door I want closed".
    if base in NEEDY and base not in TRANSFER_VERBS:
        subject = subject_of(token)
        nouns = any(t.pos_ in {"NOUN", "PROPN"} for t in doc[:verb])
        person = subject.lower_ in PERSONAL if subject is not None else not nouns
        wanted = clause.role("target") is not None and person
        plain = base not in WISHED or obligation(token) or doc[verb - 1].lower_ == "me"
        return wanted and plain
    if base not in TRANSFER_VERBS | {"throw"}:
        return False
    if base in SEARCHING and clause.mood == "wish":
        return False  # "I still have to find the box" asks nobody for it.
    subject = subject_of(token)
    if base == "get" and subject is not None and subject.lower_ in SELF and is_inverted(token):
        return True  # "Could I get another towel?"
    receiver = verb + 1 < len(doc) and doc[verb + 1].lower_ in RECEIVERS
    receiver = receiver or any(t.lower_ in RECEIVERS and t.dep_ == "pobj" for t in doc[verb:])
    named = {w for m in doc._.mentions for w in m.words.split()}
    for phrase in load_lexicon().phrases.get(base, ()):
        meant = phrase.specificity > 1 and matches(phrase, clause.words, frozenset(clause.words))
        meant = meant and not phrase.nouns.union(phrase.words) & {"to", *RECEIVERS}
        if meant and phrase.words and doc[min(verb + 1, len(doc) - 1)].lower_ == "them":
            return False  # "Throw them away": what is thrown, not who gets it.
        if meant and not (receiver and (not phrase.nouns or phrase.nouns & named)):
            return False
    directed = receiver or bool({"me", "us", "here", "over"} & set(clause.words))
    return directed or base not in RECEIVED_ONLY or base in {"pass", "hand", "give"}


def build_clauses(doc: Doc) -> tuple[Clause, ...]:
    """Clauses of a parsed segment, in the order told; "after ..." goes before what it hangs on."""
    verbs = _verb_tokens(doc)
    starts = []
    floor = 0
    for token, _ in verbs:
        starts.append(_start(token, floor))
        floor = token.i + 1
    clauses: list[Clause] = []
    needed = -1
    for k, (token, base) in enumerate(verbs):
        if token.i == needed:
            continue  # "Needs folding" is one clause.
        needed = needed_noun(token) or -1
        behind = k + 1 + (k + 1 < len(verbs) and verbs[k + 1][0].i == needed)
        high = starts[behind] if behind < len(verbs) else len(doc)
        clause = _build(doc, token, base, max(high, token.i + 1))
        if clause is not None:
            clauses.append(clause)
    clauses = _share_roles(doc, clauses)
    return tuple(sorted(clauses, key=lambda c: not c.earlier))


def _share_roles(doc: Doc, clauses: list[Clause]) -> list[Clause]:
    """Give a clause what its neighbours say for it too.

    "Check whether the battery works" checks the battery; "wash and dry the plate" washes the
    plate; "polish it till it shines with the cloth" polishes with the cloth.
    """
    shared = list(clauses)
    for k in range(len(clauses) - 1):
        this, following = shared[k], clauses[k + 1]
        between = [m for m in doc._.mentions if this.at < m.start < following.at]
        if not this.roles and following.mood == "statement" and between:
            told = Role("target", between[0].words, between[0].start, between[0])
            this = shared[k] = replace(this, roles=(told,), text=f"{this.text} {told.text}")
        joined = this.at + 1 < len(doc) and doc[this.at + 1].lower_ in {"and", "or", ","}
        if not this.roles and joined:
            text = f"{this.text.rstrip(' ,')} {following.text.partition(' ')[2]}"
            text = text.replace(" and ", " ").replace(" or ", " ")
            shared[k] = replace(this, roles=following.roles, text=text)
        tool = following.role("instrument")
        if following.mood == "statement" and tool is not None and this.role("instrument") is None:
            shared[k] = replace(shared[k], roles=(*shared[k].roles, tool))
    return shared


def _has_complement(token: Token) -> bool:
    """Whether another verb completes this one."""
    for child in token.children:
        if child.dep_ in {"xcomp", "ccomp"} and child.pos_ in {"VERB", "NOUN"}:
            return True
        if child.dep_ == "dobj" and child.lower_.endswith("ing") and base_of(child.lower_):
            return True
    return False


def _treated(token: Token) -> list[Token]:
    """Tokens of what a passive verb acts on: its subject, or the object of "have it washed"."""
    for verb in (token, token.head, token.head.head):
        for child in verb.children:
            before = child.i < token.i
            if before and verb.dep_ == "relcl" and child.lower_ in {"that", "which"}:
                return [t for t in verb.head.subtree if t.i < child.i]
            if before and (child.dep_ in {"nsubj", "nsubjpass"} or child.dep_ == "dobj"):
                return list(child.subtree) if child.i != token.i else []
    return []


def _acted_on(token: Token) -> list[Token]:
    """Tokens before the verb that it acts on: passive subjects, "the screw must come out"."""
    if is_passive(token):
        treated = [t for t in _treated(token) if t.i < token.i]
        if token.dep_ != "relcl":
            return treated
    if token.dep_ in {"acl", "relcl"} and token.head.pos_ in {"NOUN", "PROPN"}:
        return [t for t in token.head.subtree if t.i < token.i and t.dep_ not in {"aux", "nsubj"}]
    subject = subject_of(token)
    if subject is not None and subject.pos_ in {"NOUN", "PROPN"} and subject.i < token.i:
        asked = obligation(token) or token.lemma_ in NEEDING
        return list(subject.subtree) if asked else []
    return []


def _build(doc: Doc, token: Token, base: str, high: int) -> Clause | None:
    """The clause of one verb, None where it only carries another."""
    needed = needed_noun(token)
    if needed is not None:
        told = _acted_on(token)
        low = min((t.i for t in told), default=token.i)
        clause = _finish(doc, token, base_of(doc[needed].lower_) or base, needed, low, high, told)
        return replace(clause, mood="request", purpose=False)
    if token.lemma_ in CARRIERS and not is_framed(token) and _has_complement(token):
        return None
    if token.lemma_ in {"get", "have"} and any(
        c.dep_ in {"ccomp", "xcomp"} and c.tag_ == "VBN" for c in token.children
    ):
        return None  # "Get this spill cleaned up" asks for the cleaning.
    if base in LIGHT_VERBS:
        noun = light_noun(doc, token.i, high)
        if noun is not None:
            told = [t for t in doc[token.i + 1 : noun] if t.lower_ not in INDEFINITE]
            meant = base_of(doc[noun].lower_) or base
            return _finish(doc, token, meant, noun, token.i, high, told)
    told = _acted_on(token)
    low = min([t.i for t in told], default=token.i)
    clause = _finish(doc, token, base, token.i, low, high, told)
    if not _is_transfer(doc, token, base, clause):
        return clause
    asks = clause.mood == "statement" and base in NEEDY - WISHED
    return replace(clause, transfer=True, mood="request" if asks else clause.mood)


def _finish(
    doc: Doc, token: Token, base: str, verb: int, low: int, high: int, told: list[Token]
) -> Clause:
    """Put a clause together.

    Args:
        doc: parsed segment.
        token: verb that the grammar hangs on.
        base: base form that names the action.
        verb: token that names the action: `token`, or the noun of a light verb.
        low: first token of the clause.
        high: token behind its last.
        told: tokens before `verb` that it acts on, for the text.
    """
    mentions = tuple(m for m in doc._.mentions if not m.start <= verb < m.end)
    words = tuple(
        word
        for t in doc[token.i + 1 : high]
        if t.i != verb and not _leads_place(t, verb)
        for word in (t.lower_, t.lemma_)
    )
    hangs = token.dep_ in {"advcl", "relcl", "acl", "pcomp"} or any(
        c.lower_ in {"to", "so"} and c.dep_ in {"aux", "mark"} for c in token.children
    )
    after = token.head if token.dep_ == "pcomp" else None
    marked = {c.lower_ for c in token.children if c.dep_ in {"mark", "advmod"}}
    earlier = (after is not None and after.lower_ == "after") or bool(marked & {"after", "once"})
    text = " ".join([base, *(t.text for t in told), *(t.text for t in doc[verb + 1 : high])])
    return Clause(
        verb=base,
        words=words,
        roles=find_roles(doc, mentions, verb, low, high),
        mood=mood_of(token),
        negated=is_negated(token),
        transfer=False,
        purpose=hangs and not is_framed(token) and not earlier,
        text=text.strip(" ,"),
        at=token.i,
        result=_result(doc, token.i, high),
        earlier=earlier,
        direct=is_direct(token),
    )


def clause_without_verb(doc: Doc, mentions: tuple[Mention, ...], text: str) -> Clause:
    """A whole segment as one request, for when no verb of it asks for anything."""
    words = tuple(word for t in doc for word in (t.lower_, t.lemma_))
    roles = find_roles(doc, mentions, -1, 0, len(doc))
    return Clause(
        verb="",
        words=words,
        roles=tuple(r for r in roles if r.mention is not None),
        mood="request",
        negated=False,
        transfer=False,
        purpose=False,
        text=text,
        at=-1,
    )


def _result(doc: Doc, verb: int, high: int) -> str | None:
    """The state that a clause ends in; an adjective before its noun ("a loose screw") is none."""
    states = [t.lower_ for t in doc[verb + 1 : high] if t.lower_ in RESULTS and t.dep_ != "amod"]
    return states[0] if states else None


def _leads_place(token: Token, verb: int) -> bool:
    """Whether "on" or "in" leads a place ("hang it on the hook") and is no part of the verb."""
    if token.lower_ not in {"on", "in"} or token.i == verb + 1 or token.dep_ != "prep":
        return False
    return any(child.dep_ == "pobj" for child in token.children)


def _taskgrasp_clauses(doc: Doc) -> Doc:
    """Fill `doc._.clauses`."""
    doc._.clauses = build_clauses(doc)
    return doc


@Language.factory(
    "taskgrasp_clauses",
    requires=["token.tag", "token.dep", "token.lemma", "doc._.mentions"],
    assigns=["doc._.clauses"],
)
def make_taskgrasp_clauses(nlp: Language, name: str) -> object:
    """The component; it has no settings."""
    return _taskgrasp_clauses


if not Doc.has_extension("clauses"):
    Doc.set_extension("clauses", default=())
