"""Whether a verb is asked for, wished for, forbidden or only told about."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from maniskill_taskgrasp.language.text import OPENER
from maniskill_taskgrasp.language.words import word_set

if TYPE_CHECKING:
    from spacy.tokens import Token

Mood = Literal["request", "wish", "statement"]
"""A wish ("I need to tighten this") says what for; a statement asks for nothing."""

CARRIERS = word_set("carriers")
"""Verbs that hand their meaning to a verbal complement ("I want you to ...")."""
OBLIGATIONS = word_set("obligations")
MODALS = word_set("modals")
FORBIDDING = word_set("forbidding")
NEGATIONS = word_set("negations")
SELF = word_set("self")
ADDRESSEE = word_set("addressee")
SUBJECTS = word_set("subjects")
CHAIN = word_set("chain")
LONGEST_CHAIN = 6  # Steps up the tree; deeper nesting is no instruction.
SOMETHING = word_set("something")
SAYING = frozenset(["say", "tell", "mean"])
UNASKED_MARKS = word_set("unasked_marks")
"""Conjunctions whose clause is told, not asked: "till it shines"."""


def is_framed(verb: Token) -> bool:
    """Whether the verb is the imperative that got the opener."""
    opener = OPENER.split()
    words = [token.lower_ for token in verb.doc[: verb.i]]
    return words[:2] == opener and all(w in {"not", *opener} for w in words)


def carriers_of(verb: Token) -> list[Token]:
    """Verbs above this one that carry it: "I would like you to wipe" -> would, like."""
    chain: list[Token] = []
    token = verb
    for _ in range(LONGEST_CHAIN):
        if token.dep_ not in CHAIN or token.head is token:
            break
        head = token.head
        if token.dep_ == "acl" and head.dep_ == "dobj":
            token = head  # "I have a splinter to remove": carried by "have".
            continue
        if head.pos_ not in {"VERB", "AUX"}:
            break
        if token.dep_ == "conj" and head.lemma_ not in CARRIERS:
            token = head
            continue
        chain.append(head)
        token = head
    return chain


def subject_of(verb: Token) -> Token | None:
    """The verb's own subject, or that of the verb it is joined to or carried by."""
    token = verb
    for _ in range(LONGEST_CHAIN):
        for child in token.children:
            if child.dep_ in SUBJECTS and child.i < token.i:
                return child
        if token.dep_ not in CHAIN or token.head is token:
            return None
        token = token.head
    return None


def obligation(verb: Token) -> bool:
    """Whether a modal or a carrier makes the verb something to be done."""
    tokens = [verb, *carriers_of(verb)]
    heads = {t.lemma_.lower() for t in tokens[1:]} & OBLIGATIONS
    modal = any(c.lower_ in MODALS and c.dep_ == "aux" for t in tokens for c in t.children)
    going = any(t.lower_ == "going" for t in tokens)
    to_be = {c.lower_ for t in tokens for c in t.children if c.dep_ in {"aux", "auxpass"}}
    be_to = "to" in to_be and any(t.lemma_ == "be" for t in [*tokens[1:], *verb.lefts])
    return bool(heads) or modal or going or be_to


def is_passive(verb: Token) -> bool:
    """Whether the subject is what the verb is done to: "is opened", "needs opening"."""
    if any(child.dep_ in {"auxpass", "nsubjpass"} for child in verb.children):
        return True
    if verb.dep_ == "acomp":
        return True  # "Is to be unscrewed", parsed as an adjective.
    head = verb.head
    needs = head.lemma_ in {"need", "want", "require", "deserve"} and head is not verb
    gerund = verb.lower_.endswith("ing") and verb.dep_ in {"dobj", "xcomp", "ccomp"}
    got = head.lemma_ in {"get", "have"} and verb.dep_ in {"ccomp", "xcomp"} and verb.tag_ == "VBN"
    return (needs and gerund) or got


def is_undone(verb: Token) -> bool:
    """Whether the words complain that something is not done: "has not been rinsed yet"."""
    words = {child.lower_ for child in verb.children}
    lately = words & {"yet", "still", "been"}
    if "nobody" in words and any(c.lemma_ == "have" and c.dep_ == "aux" for c in verb.children):
        return True  # "Nobody has swept the floor".
    return is_passive(verb) and bool(words & NEGATIONS) and bool(lately)


def _is_told(verb: Token) -> bool:
    """Whether the verb stands in a clause that only describes."""
    marks = {c.lower_ for c in verb.children if c.dep_ in {"mark", "advmod"}}
    infinitive = any(c.lower_ == "to" for c in verb.children)
    if verb.dep_ == "relcl" and not infinitive:
        wanted = verb.head.lower_ in SOMETHING or is_passive(verb)
        return not (wanted and obligation(verb))  # "Something I can cut it with" says what for.
    first = verb.head if verb.dep_ == "conj" and verb.head.tag_ == "VBN" else verb
    perfect = any(c.lemma_ == "have" and c.dep_ == "aux" for c in first.children)
    if perfect and not marks & {"once", "after", "when"}:
        return True
    if "if" in marks:
        return verb.head.lemma_ not in CARRIERS
    return bool(marks & UNASKED_MARKS)


def mood_of(verb: Token) -> Mood:
    """Mood of a verb in its sentence."""
    if is_framed(verb) or is_undone(verb):
        return "request"
    if _is_told(verb):
        return "statement"
    subject = subject_of(verb)
    own = subject is not None and subject.head is verb
    if subject is None or (not own and verb.head.lemma_ in SAYING and verb.tag_ in {"VB", "VBP"}):
        return "request" if verb.tag_ not in {"VBD", "VBZ"} else "statement"
    word = subject.lower_
    if is_passive(verb):
        return "request" if obligation(verb) else "statement"
    if word in SELF:
        asks_you = any(t.lower_ == "you" for c in carriers_of(verb) for t in c.children)
        if asks_you:
            return "request"
        maybe = any(c.lower_ in {"might", "may"} for c in verb.children) and not is_inverted(verb)
        return "wish" if obligation(verb) and not maybe else "statement"
    if word in ADDRESSEE or word == "'s":
        past = verb.tag_ == "VBD" and word != "you"
        has = verb.lemma_ == "have"
        goes_on = verb.tag_ in {"VBG", "VBZ"} and word not in {"you", "'s"}  # "Someone's knocking".
        told = past or has or goes_on
        return "statement" if told and not obligation(verb) else "request"
    return "request" if obligation(verb) and verb.tag_ not in {"VBG", "VBZ"} else "statement"


def is_inverted(verb: Token) -> bool:
    """Whether a modal stands before the subject: "could you ...", not "you could ..."."""
    subject = subject_of(verb)
    modal = [c.i for c in verb.children if c.lower_ in MODALS and c.dep_ == "aux"]
    return subject is not None and bool(modal) and min(modal) < subject.i


def is_direct(verb: Token) -> bool:
    """Whether the verb is asked of the hearer: an imperative, "could you", "I'd like you to"."""
    if is_framed(verb):
        return True
    subject = subject_of(verb)
    asked_you = any(t.lower_ == "you" for c in carriers_of(verb) for t in c.children)
    if subject is None:
        return verb.dep_ == "ROOT" and verb.tag_ == "VB"
    return asked_you or (subject.lower_ in ADDRESSEE and is_inverted(verb))


def is_negated(verb: Token) -> bool:
    """Whether the verb, or a verb that carries it, is denied."""
    if is_undone(verb):
        return False
    chain = [verb, *carriers_of(verb)]
    if verb.dep_ == "conj" and any(c.lower_ in {"or", "nor"} for c in verb.head.children):
        chain.append(verb.head)
    for token in chain:
        if token.lemma_ in {"mind", "like"} and token is not verb:
            continue  # "You wouldn't mind opening it" asks for it.
        if any(c.lower_ in NEGATIONS and c.i < token.i for c in token.children):
            return True
    if any(token.lemma_.lower() in FORBIDDING for token in chain[1:]):
        return True
    head = verb.head
    if head.head.lemma_ in FORBIDDING and head.pos_ == "ADP":
        return all(c.lower_ != "what" for c in head.head.children)  # "What stops you from ...?"
    if verb.dep_ in {"pcomp", "pobj"} and head.pos_ in {"ADP", "SCONJ"}:
        lead = verb.doc[head.i - 1].lower_ if head.i else ""
        return head.lower_ == "without" or lead in {"instead", "rather"}
    before = [t.lower_ for t in verb.doc[max(0, verb.i - 3) : verb.i]]
    return before[-2:] in (["rather", "than"], ["instead", "of"]) or before[-1:] == ["without"]
