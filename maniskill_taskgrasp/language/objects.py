"""Which object of the data the hand is to hold for a task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.actions import load_head
from maniskill_taskgrasp.language.encoder import EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.lexicon import TOOL_ACTIONS, load_lexicon

if TYPE_CHECKING:
    from maniskill_taskgrasp.language.mentions import Mention
    from maniskill_taskgrasp.language.plan import Task
    from maniskill_taskgrasp.language.roles import Role

NEAREST_MINIMUM = 0.62  # Cosine below which a name is not the object that was meant.
CANDIDATES = 5  # Alternatives that an answer lists.
CONTENT_ACTIONS = frozenset(["pouring", "drinking", "squeezing", "spraying", "eating"])
"""Actions whose target is what comes out; the hand holds the container."""
PLACING_ACTIONS = frozenset(
    ["putting", "setting", "arranging", "moving", "hanging", "disposing", "shifting", "replacing", "carrying"]
)
"""Actions whose place is where the object goes, never what is held."""
WORK_ACTIONS = frozenset(
    ["measuring", "mopping", "vacuuming", "sanding", "sawing", "drilling", "hammering", "pounding", "spraying", "aiming", "writing", "oiling", "blowing", "brushing", "unlocking", "starting car", "texting", "calling", "applying"]
)
"""Tool actions whose target is what is worked on, unless people held that very object."""
FIXTURES = frozenset(
    ["table", "counter surface", "furniture", "door", "cabinet", "cabinet door", "wardrobe door", "dishwasher door", "stair rail", "computer", "picture", "chair", "left hand", "food", "shower curtain"]
)
"""Things that are cleaned where they are, with a cloth in the hand."""
HAND_TOOLS = ("wrench", "hex wrench", "screwdriver", "allen wrench", "pliers", "chuck key")
FASTENING = frozenset(["tightening", "loosening", "screwing", "unscrewing", "turning", "cranking"])
"""Actions on bolts and screws; people did them with `HAND_TOOLS`, under any of these names."""


@dataclass(frozen=True)
class Held:
    """The object of a task, and how it was found."""

    name: str | None
    score: float
    candidates: tuple[tuple[str, float], ...] = ()
    note: str | None = None
    wanted: str | None = None
    """Words that name something which the data do not have."""


def used_for(action: str) -> tuple[tuple[str, float], ...]:
    """Objects that people held for an action, with their shares, most frequent first.

    For bolts and screws the hand tools of all fastening actions are counted together.
    """
    counts: dict[str, float] = {}
    for (name, done), topologies in load_knowledge().pair_counts.items():
        fastening = action in FASTENING and done in FASTENING and name in HAND_TOOLS
        if fastening or (done == action and action not in FASTENING):
            counts[name] = counts.get(name, 0) + sum(topologies)
    total = sum(counts.values())
    ranked = sorted(counts.items(), key=lambda item: (-item[1], item[0]))
    return tuple((name, count / total) for name, count in ranked)


def nearest(text: str) -> tuple[tuple[str, float], ...]:
    """Objects by cosine of their names' vectors with a text, best first.

    Raises:
        EncoderMissingError: the encoder is not installed.
    """
    head = load_head()
    cosines = head.name_vectors @ load_encoder().encode([text])[0]
    best: dict[str, float] = {}
    for i in np.argsort(-cosines)[: 4 * CANDIDATES]:
        for name, certainty in load_lexicon().names[head.names[i]]:
            best.setdefault(name, float(cosines[i]) * certainty)
    return tuple(sorted(best.items(), key=lambda item: -item[1])[:CANDIDATES])


def from_mention(mention: Mention) -> Held:
    """The object that words name, with those that they may name besides."""
    (name, score), *others = mention.objects
    last = mention.words.split()[-1]
    family = [(o, 0.5) for o in load_knowledge().objects if last in o.split() and o != name]
    return Held(name, score, tuple([*others, *family][:CANDIDATES]))


def from_meaning(words: str) -> Held:
    """The object nearest in meaning to words that name none; no name where all are far."""
    try:
        ranked = nearest(words)
    except EncoderMissingError:
        return Held(None, 0.0, wanted=words)
    name, score = ranked[0]
    if score < NEAREST_MINIMUM:
        return Held(None, score, ranked, wanted=words)
    return Held(
        name, score, ranked[1:], f"no object is called {words!r}: took the nearest, {name!r}"
    )


def from_data(action: str, besides: tuple[tuple[str, float], ...] = ()) -> Held:
    """The object that people used most for an action, said openly."""
    ranked = used_for(action)
    name, share = ranked[0]
    note = f"no tool was named for {action}: took {name!r}, which people used most often for it"
    return Held(name, share, tuple([*ranked[1:CANDIDATES], *besides]), note)


def antecedent(task: Task) -> Mention | None:
    """What "it" refers to: the latest object named before the clause."""
    earlier = task.source.earlier
    return earlier[-1] if earlier else None


def held_by(role: Role, task: Task) -> Held | None:
    """The object of a role; None for a pronoun that refers to nothing."""
    if role.mention is not None:
        return from_mention(role.mention)
    if role.pronoun:
        before = antecedent(task)
        return from_mention(before) if before is not None else None
    return from_meaning(role.text)


def is_worked_on(name: str, action: str) -> bool:
    """Whether a named object is what the tool works on rather than what the hand holds."""
    if action not in TOOL_ACTIONS:
        return False
    if name in FIXTURES:
        return True
    return action in WORK_ACTIONS and (name, action) not in load_knowledge().pair_counts


def choose_object(task: Task, action: str | None) -> Held:
    """The object of a task: instrument first, then what is acted on, then what people used."""
    if task.held is not None:
        held = held_by(task.held, task)
        if held is not None and held.name is not None:
            return held
        if action is None or action not in TOOL_ACTIONS:
            return held or Held(None, 0.0)
    if action is None or task.told is None:
        return Held(None, 0.0)
    roles = task.told.clause.roles
    target = next((r for r in roles if r.kind == "target"), None)
    for role in [r for r in roles if r.kind == "instrument"]:
        held = held_by(role, task)
        if held is not None:
            return held
    others = [r for r in roles if r.kind in {"source", "place"} and r.mention is not None]
    if action in {"calling", "texting", "talking on phone"} and others:
        return from_mention(others[0].mention)
    if action in CONTENT_ACTIONS and others and (target is None or target.mention is None):
        return from_mention(others[0].mention)
    named = next((r for r in roles if r.kind == "target" and r.mention is not None), None)
    if named is not None:
        return _from_target(named.mention, action)
    if target is not None and target.pronoun:
        return _from_pronoun(task, action)
    return _from_rest(task, action, target, others)


def _from_target(mention: Mention, action: str) -> Held:
    held = from_mention(mention)
    if held.name is not None and is_worked_on(held.name, action):
        return from_data(action, ((held.name, held.score),))
    return held


def _from_pronoun(task: Task, action: str) -> Held:
    before = antecedent(task)
    if before is not None:
        return _from_target(before, action)
    return from_data(action) if action in TOOL_ACTIONS else Held(None, 0.0)


def _from_rest(task: Task, action: str, target: Role | None, others: list[Role]) -> Held:
    """Nothing known is acted on: a container or surface, the data's tool, or the nearest name."""
    unknown = target is not None
    if others and not (unknown and action in PLACING_ACTIONS) and action not in PLACING_ACTIONS:
        if action not in TOOL_ACTIONS or not is_worked_on(others[0].mention.objects[0][0], action):
            return from_mention(others[0].mention)
    if action in TOOL_ACTIONS:
        return from_data(action)
    if unknown:
        return from_meaning(target.text)
    before = antecedent(task)
    return from_mention(before) if before is not None else Held(None, 0.0)
