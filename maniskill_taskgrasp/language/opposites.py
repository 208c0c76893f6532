"""Requests that undo themselves: "turn it without turning it", "push and pull it at once"."""

from __future__ import annotations

from typing import TYPE_CHECKING

from maniskill_taskgrasp.language.words import word_set

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

OPPOSITES = frozenset(
    frozenset(pair.split())
    for pair in (
        "open close",
        "open shut",
        "open closed",
        "opened closed",
        "tighten loosen",
        "push pull",
        "lift lower",
        "raise lower",
        "lock unlock",
        "fold unfold",
        "plug unplug",
        "screw unscrew",
        "fill empty",
    )
)
AT_ONCE = ("at the same time", "simultaneously", "at the same moment")
STAYING = frozenset(["stay", "remain", "keep", "leave"])
DENYING = frozenset(["without", "not", "never", "no", "n't"])
TOUCHING = frozenset(["touch", "hold", "grasp", "grip"])
PARTICLES = frozenset(["in", "on", "off", "up", "down", "out", "again", "."])
PRONOUNS = word_set("pronouns")


def undone(docs: list[Doc], asked: frozenset[str]) -> str | None:
    """What a text both asks for and rules out, if anything.

    Args:
        docs: the text's segments in their order.
        asked: verbs (lemmas) that are asked for.
    """
    tokens = [token for doc in docs for token in doc]
    text = " ".join(token.lower_ for token in tokens)
    words = {token.lower_ for token in tokens} | {token.lemma_.lower() for token in tokens}
    for pair in OPPOSITES:
        both = pair <= words and bool(pair & asked)
        kept = "but" in words and bool(STAYING & words)
        if both and (kept or any(mark in text for mark in AT_ONCE)):
            return " and ".join(sorted(pair))
    for at, token in enumerate(tokens):
        verb = _denied(tokens, at)
        if verb in asked or (verb in TOUCHING and asked):
            return token.lower_
    return None


def _denied(tokens: list[Token], at: int) -> str:
    """Lemma of a verb that is denied of "it" and nothing more; "" for any other token."""
    ahead = [token.lower_ for token in tokens[max(0, at - 2) : at] if token.lower_ != "ever"]
    after = [token.lower_ for token in tokens[at + 1 : at + 4]]
    if not ahead or ahead[-1] not in DENYING or not after or after[0] not in PRONOUNS:
        return ""
    return tokens[at].lemma_.lower() if PARTICLES.issuperset(after[1:]) else ""
