"""The paper's recipe, for comparison: root verb and its object, each by cosine of spaCy's vectors.

The paper names spaCy but neither the model nor a threshold; here it is the small English model,
whose tokens have context tensors instead of word vectors. It never refuses a text with a verb.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.errors import echo
from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.actions import most_frequent_parameters
from maniskill_taskgrasp.language.guard import refuse
from maniskill_taskgrasp.language.instruction import Instruction, Rejected
from maniskill_taskgrasp.language.model import load_model
from maniskill_taskgrasp.language.text import clean

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

SHOWN = 3  # Names that an answer lists.
OBJECT_ROLES = ("dobj", "pobj", "nsubjpass", "nsubj", "ROOT")
"""Grammatical roles that may name the object, likeliest first."""


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / max(float(np.linalg.norm(vector)), 1e-9)


@cache
def _name_vectors(kind: str) -> tuple[tuple[str, ...], np.ndarray]:
    """Names of actions or objects with (n, d) unit vectors: means over their tokens."""
    knowledge = load_knowledge()
    names = tuple(knowledge.actions if kind == "actions" else knowledge.objects)
    docs = load_model().pipe(names)
    return names, np.array([_unit(doc.tensor.mean(0)) for doc in docs])


def _nearest(token: Token, kind: str) -> list[tuple[str, float]]:
    names, vectors = _name_vectors(kind)
    cosines = vectors @ _unit(token.doc.tensor[token.i])
    return [(names[i], float(cosines[i])) for i in np.argsort(-cosines)[:SHOWN]]


def _root_verb(doc: Doc) -> Token | None:
    return next((token for token in doc if token.dep_ == "ROOT"), None)


def _object_noun(doc: Doc) -> Token | None:
    nouns = [t for t in doc if t.pos_ in {"NOUN", "PROPN"} and t.dep_ in OBJECT_ROLES]
    return min(nouns, key=lambda t: OBJECT_ROLES.index(t.dep_), default=None)


def parse_as_paper(text: str, object_override: str | None = None) -> Instruction | Rejected:
    """See `maniskill_taskgrasp.language.parse`, with the paper's recipe."""
    cleaned = clean(text)
    refused = refuse(text, cleaned)
    if refused is not None:
        return refused
    doc = load_model()(cleaned)
    verb, noun = _root_verb(doc), _object_noun(doc)
    if verb is None:
        return Rejected(text, f"no verb in {echo(text)}", "no_action")
    if noun is None and object_override is None:
        return Rejected(text, f"no noun in {echo(text)}", "no_object")
    actions = _nearest(verb, "actions")
    objects = _nearest(noun, "objects") if noun is not None and object_override is None else []
    name, score = objects[0] if objects else (None, 1.0)
    return Instruction(
        text=text,
        action=actions[0][0],
        action_score=max(0.0, actions[0][1]),
        actions_top3=tuple(actions),
        transfer=False,
        object=name,
        object_score=max(0.0, score),
        object_candidates=tuple(objects[1:]),
        parameters=most_frequent_parameters(actions[0][0]),
        notes=("the paper's recipe: root verb and object noun by cosine of spaCy vectors",),
    )
