"""Requests whose grammar says nothing but whose meaning is plain, read by the trained head.

"Isn't it time somebody took out the trash?", "the lid off, quick", "it's dark in here": no verb
asks for anything, so the rules find no task. The head weighs the whole request against small talk
instead; how sure it must be was learned (`train/language.py`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.language.actions import (
    HAND_OVER,
    LONGEST_SAID,
    NO_ACTION,
    load_head,
    matching_phrases,
)
from maniskill_taskgrasp.language.clauses import Clause, clause_without_verb
from maniskill_taskgrasp.language.encoder import EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.lexicon import SYNONYM_SCORE
from maniskill_taskgrasp.language.moods import CARRIERS
from maniskill_taskgrasp.language.plan import Task, Told, ruled_out
from maniskill_taskgrasp.language.roles import Role
from maniskill_taskgrasp.language.segments import PARTICLES
from maniskill_taskgrasp.language.text import URGENT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from spacy.tokens import Doc

    from maniskill_taskgrasp.language.actions import Head
    from maniskill_taskgrasp.language.mentions import Mention
    from maniskill_taskgrasp.language.segments import Segment

LIKE_A_SITUATION = 0.7  # Cosine with a situation below which a name alone is asked for itself.
MEANT = 3  # Classes, the likeliest, that a text may mean.
CLAUSE_SHARE = 0.25  # Probability of a verb's actions from which its clause is what is asked for.


@dataclass(frozen=True)
class Meaning:
    """What a whole request means, grammar aside."""

    probabilities: dict[str, float]
    """Class of the head -> probability."""
    likeness: float
    """Cosine with the most similar known situation (`situations.json`)."""

    @property
    def action(self) -> str:
        """The likeliest of the 74 actions."""
        actions = (n for n in self.probabilities if n not in {HAND_OVER, NO_ACTION})
        return max(actions, key=self.probabilities.__getitem__)

    @property
    def hands_over(self) -> bool:
        """Whether it asks for an object rather than a use."""
        return self.probabilities[HAND_OVER] > self.probabilities[self.action]


def meanings(texts: list[str]) -> list[Meaning]:
    """The meaning of each text; empty without the encoder."""
    head = load_head()
    try:
        vectors = load_encoder().encode(texts)
    except EncoderMissingError:
        return []
    return meanings_of(vectors, head)


def meanings_of(vectors: np.ndarray, head: Head) -> list[Meaning]:
    """Meanings of (n, d) sentence vectors."""
    likeness = (vectors @ head.situation_vectors.T).max(axis=1, initial=-1.0)
    return [
        Meaning(dict(zip(head.classes, row.tolist(), strict=True)), float(most))
        for row, most in zip(np.exp(head.log_probabilities(vectors)), likeness, strict=True)
    ]


def features(
    meaning: Meaning, segment: Segment, doc: Doc, mentions: tuple[Mention, ...]
) -> list[float]:
    """What speaks for a request and against one, for the learned decision."""
    silent = meaning.probabilities[NO_ACTION]
    best = max(meaning.probabilities[meaning.action], meaning.probabilities[HAND_OVER])
    verbs = [token for token in doc if token.pos_ in {"VERB", "AUX"}]
    known = any(matching_phrases(c) for c in doc._.clauses)
    return [
        float(np.log(silent + 1e-4)),
        float(np.log(best + 1e-4)),
        meaning.likeness,
        float(bool(mentions)),
        float(segment.asking),
        float(any(token.tag_ == "VBD" for token in verbs)),
        float(known),
        float(any(c.negated for c in doc._.clauses)),
        float(not verbs),
        float(np.log(meaning.probabilities[HAND_OVER] + 1e-4)),
    ]


HYPOTHETICAL = frozenset(["if", "rather", "suppose", "supposing", "time", "wish", "would"])
"""Words after which English puts what is wished for into the past: "it's time you washed it"."""


def _tells(meaning: Meaning, doc: Doc) -> bool:
    """Whether a text only tells that the action was done: "we folded the towels yesterday".

    Another verb in the past tells of trouble: "the cat knocked the pot over".
    """
    already = any(token.lower_ == "already" for token in doc)
    tags = {"VBD", "VBN"} if already else {"VBD"}
    past = {t.i for t in doc if t.tag_ in tags and t.pos_ == "VERB"}
    likely = set(sorted(meaning.probabilities, key=meaning.probabilities.__getitem__)[-MEANT:])
    done = any(c.at in past and likely & set(matching_phrases(c)) for c in doc._.clauses)
    wished = any(token.lower_ in HYPOTHETICAL for token in doc)
    return done and not wished


def _forbids(segment: Segment, doc: Doc) -> bool:
    """Whether a segment only says what is not to be done."""
    return segment.negated or any(c.negated and c.mood == "request" for c in doc._.clauses)


def _asked_clause(doc: Doc, meaning: Meaning) -> Clause | None:
    """The clause whose verb means what the whole request means, whatever its mood."""
    best: tuple[float, Clause] | None = None
    for clause in doc._.clauses:
        found = matching_phrases(clause)
        share = sum(meaning.probabilities[action] for action in found)
        if share >= CLAUSE_SHARE and (best is None or share > best[0]):
            best = share, clause
    return replace(best[1], negated=False) if best is not None else None


def is_request(given: list[float]) -> bool:
    """The learned decision on `features`."""
    weights = load_head().decision
    return bool(weights[:-1] @ np.array(given) + weights[-1] > 0)


def _meant_mention(segment: Segment, doc: Doc, mentions: tuple[Mention, ...]) -> Role | None:
    """The object that a request for an object names: not the one that is taken back."""
    meant = [m for m in mentions if not ruled_out(segment, doc, m)]
    if not meant:
        return None
    taken_back = {"no", "sorry", "rather", "mean"} & {
        t.lower_ for t in doc[meant[0].end : meant[-1].start]
    }
    mention = meant[-1] if taken_back else meant[0]
    return Role("target", mention.words, mention.start, mention)


def _only_names(doc: Doc, meaning: Meaning) -> bool:
    """Whether a request says nothing but what it is for: "not the hammer, the pliers please"."""
    moves = any(token.lower_ in PARTICLES for token in doc)  # "The lid off, quick".
    does = any(t.pos_ == "VERB" and t.lemma_ not in CARRIERS | {"do"} for t in doc)
    return not moves and not does and meaning.likeness < LIKE_A_SITUATION


def _asks_at_all(segment: Segment, doc: Doc) -> bool:
    """Whether a request for an object is more than its name: "a red cup" asks for nothing."""
    polite = URGENT & {word.strip(",.!?") for word in segment.text.split()}
    return bool(polite) or any(token.pos_ in {"VERB", "AUX"} for token in doc)


def tasks_by_meaning(segments: list[Segment], docs: list[Doc]) -> Iterator[Task]:
    """What the segments ask for by meaning alone.

    Args:
        segments: as the rules read them, without finding a request.
        docs: their parses.
    """
    earlier: list[Mention] = []
    speaking = False
    for segment, doc, meaning in zip(
        segments, docs, meanings([s.text[:LONGEST_SAID] for s in segments]), strict=False
    ):
        mentions = tuple(m for m in doc._.mentions if m.objects[0][1] >= SYNONYM_SCORE)
        before = tuple(earlier)
        earlier += mentions
        asked = is_request(features(meaning, segment, doc, mentions))
        speaking = segment.speaking or (speaking and segment.text.startswith("and "))
        idle = speaking or _forbids(segment, doc) or _tells(meaning, doc)
        if idle or not asked:
            continue
        whole = clause_without_verb(doc, mentions, segment.text)
        clause = _asked_clause(doc, meaning)
        if meaning.hands_over or (clause is None and _only_names(doc, meaning)):
            held = _meant_mention(segment, doc, mentions)
            if held is not None and _asks_at_all(segment, doc):
                transfer = Told(replace(whole, transfer=True), before, (), segment.text)
                yield Task(None, held, transfer, meant=True)
            continue
        yield Task(Told(clause or whole, before, (), segment.text), meant=True)
