"""Whether a verb is asked for, wished for, forbidden or only told about."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from maniskill_taskgrasp.language.text import OPENER

if TYPE_CHECKING:
    from spacy.tokens import Token

Mood = Literal["request", "wish", "statement"]
"""A wish ("I need to tighten this") says what for; a statement asks for nothing."""

CARRIERS = frozenset(
    ["need", "want", "like", "would", "mind", "think", "ask", "wonder", "appreciate", "suppose", "mean", "ought", "hope", "wish", "expect", "plan", "intend", "try", "help", "let", "go", "be", "feel", "start", "begin", "continue", "require", "deserve", "seem", "proceed", "love", "prefer", "remember", "forget", "manage", "have", "keep", "get", "tell", "please", "require", "know", "see", "say", "suggest", "request", "order", "demand"]
)
"""Verbs that hand their meaning to a verbal complement ("I want you to ...")."""
OBLIGATIONS = frozenset(
    ["need", "want", "have", "ought", "suppose", "mean", "require", "deserve", "must", "should", "shall", "can", "could", "will", "would", "'ll", "'d", "may", "might", "get"]
)
FORBIDDING = frozenset(["avoid", "stop", "refrain", "quit", "cease", "skip", "forbid", "hate"])
NEGATIONS = frozenset(["not", "n't", "never", "no", "nor", "neither", "without", "cannot"])
SELF = frozenset(["i", "we"])
ADDRESSEE = frozenset(["you", "robot", "who", "someone", "somebody", "anybody", "anyone", "everyone"])
SUBJECTS = frozenset(["nsubj", "nsubjpass", "csubj", "expl"])
CHAIN = frozenset(["xcomp", "ccomp", "conj", "pcomp", "advcl", "acl", "dobj", "dep"])


def is_framed(verb: Token) -> bool:
    """Whether the verb is the imperative that got the opener."""
    opener = OPENER.split()
    words = [token.lower_ for token in verb.doc[: verb.i]]
    return words[:2] == opener and all(w in {"not", *opener} for w in words)


def carriers_of(verb: Token) -> list[Token]:
    """Verbs above this one that carry it: "I would like you to wipe" -> would, like."""
    chain = []
    token = verb
    while token.dep_ in CHAIN and token.head is not token and len(chain) < 6:
        head = token.head
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
    for _ in range(6):
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
    lemmas = {t.lemma_.lower() for t in tokens[1:]} | {
        c.lower_ for t in tokens for c in t.children if c.dep_ in {"aux", "auxpass"}
    }
    going = any(t.lower_ == "going" for t in tokens)
    be_to = any(t.lemma_ == "be" for t in tokens[1:]) and any(
        c.lower_ == "to" for c in verb.children
    )
    return bool(lemmas & OBLIGATIONS) or going or be_to


def is_passive(verb: Token) -> bool:
    """Whether the subject is what the verb is done to: "is opened", "needs opening"."""
    if any(child.dep_ in {"auxpass", "nsubjpass"} for child in verb.children):
        return True
    head = verb.head
    needs = head.lemma_ in {"need", "want", "require", "deserve"} and head is not verb
    gerund = verb.lower_.endswith("ing") and verb.dep_ in {"dobj", "xcomp", "ccomp"}
    got = head.lemma_ in {"get", "have"} and verb.dep_ in {"ccomp", "xcomp"} and verb.tag_ == "VBN"
    return (needs and gerund) or got


def mood_of(verb: Token) -> Mood:
    """Mood of a verb in its sentence."""
    if is_framed(verb):
        return "request"
    subject = subject_of(verb)
    if subject is None:
        return "request" if verb.tag_ not in {"VBD", "VBZ"} else "statement"
    word = subject.lower_
    if is_passive(verb):
        return "request" if obligation(verb) else "statement"
    if word in SELF:
        asks_you = any(t.lower_ == "you" for c in carriers_of(verb) for t in c.children)
        if asks_you:
            return "request"
        return "wish" if obligation(verb) else "statement"
    if word in ADDRESSEE or (word in {"'s", "it"} and carriers_of(verb)):
        past = verb.tag_ == "VBD" and not obligation(verb)
        return "statement" if past and word != "you" else "request"
    return "request" if obligation(verb) and verb.tag_ not in {"VBG", "VBZ"} else "statement"


def is_negated(verb: Token) -> bool:
    """Whether the verb, or a verb that carries it, is denied."""
    chain = [verb, *carriers_of(verb)]
    if verb.dep_ == "conj" and any(c.lower_ == "or" for c in verb.head.children):
        chain.append(verb.head)
    for token in chain:
        if any(c.lower_ in NEGATIONS and c.i < token.i for c in token.children):
            return True
    if any(token.lemma_.lower() in FORBIDDING for token in chain[1:]):
        return True
    head = verb.head
    if verb.dep_ in {"pcomp", "pobj"} and head.pos_ in {"ADP", "SCONJ"}:
        before = verb.doc[head.i - 1].lower_ if head.i else ""
        return head.lower_ == "without" or before in {"instead", "rather"}
    before = [t.lower_ for t in verb.doc[max(0, verb.i - 3) : verb.i]]
    return before[-2:] in (["rather", "than"], ["instead", "of"]) or before[-1:] == ["without"]
