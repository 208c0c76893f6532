"""Whole text -> Instruction or Rejected."""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import TYPE_CHECKING

from maniskill_taskgrasp.errors import echo
from maniskill_taskgrasp.knowledge import PARAMETERS, load_knowledge
from maniskill_taskgrasp.language.instruction import Instruction, Rejected
from maniskill_taskgrasp.language.model import load_model

if TYPE_CHECKING:
    from spacy.tokens import Doc

MAX_CHARACTERS = 500
TRANSFER_VERBS = frozenset({"hand", "pass", "bring", "give", "grab", "fetch", "get"})


def most_frequent_parameters(action: str) -> dict[str, str]:
    """The value of each task parameter that people's rows show most often for an action."""
    statistics = load_knowledge().actions[action].parameters
    return {name: max(statistics[name], key=statistics[name].__getitem__) for name in PARAMETERS}


@cache
def _actions_by_lemma() -> dict[str, str]:
    nlp = load_model()
    return {nlp(f"he is {name}")[2].lemma_: name for name in load_knowledge().actions}


def _find_object(doc: Doc) -> str | None:
    names = load_knowledge().objects
    lemmas = " ".join(token.lemma_.lower() for token in doc)
    found = [name for name in names if f" {name} " in f" {lemmas} "]
    return max(found, key=len) if found else None


def understand(text: str, object_override: str | None = None) -> Instruction | Rejected:
    """See `maniskill_taskgrasp.language.parse`."""
    if not text.strip():
        return Rejected(text, "the text is empty: type what to do with which object", "empty")
    if len(text) > MAX_CHARACTERS:
        reason = f"{len(text)} characters came: at most {MAX_CHARACTERS} would do"
        return Rejected(text[:MAX_CHARACTERS], reason, "too_long")
    doc = load_model()(text)
    verbs = [token.lemma_.lower() for token in doc]
    actions = Counter(_actions_by_lemma()[v] for v in verbs if v in _actions_by_lemma())
    transfer = not actions and any(v in TRANSFER_VERBS for v in verbs)
    if not actions and not transfer:
        reason = f"no action in {echo(text)}: say what to do, such as 'tighten it with the wrench'"
        return Rejected(text, reason, "no_action")
    name = _find_object(doc)
    if name is None and object_override is None:
        reason = f"no object in {echo(text)}: name one (taskgrasp objects list)"
        return Rejected(text, reason, "no_object")
    action = next(iter(actions), None)
    note = "a transfer names no use: the object's usual actions decide"
    return Instruction(
        text=text,
        action=action,
        action_score=1.0 if action else 0.0,
        actions_top3=((action, 1.0),) if action else (),
        transfer=transfer,
        object=None if object_override else name,
        object_score=1.0,
        parameters=most_frequent_parameters(action) if action else {},
        notes=(note,) if transfer else (),
    )
