"""Which object of the data the hand is to hold for a task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.actions import GENERIC_ACTIONS, load_head
from maniskill_taskgrasp.language.encoder import EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.lexicon import SYNONYM_SCORE, TOOL_ACTIONS, load_lexicon
from maniskill_taskgrasp.language.situations import load_situations
from maniskill_taskgrasp.language.spelling import respell_name
from maniskill_taskgrasp.language.words import word_map, word_set

if TYPE_CHECKING:
    from maniskill_taskgrasp.language.clauses import Clause
    from maniskill_taskgrasp.language.mentions import Mention
    from maniskill_taskgrasp.language.plan import Task
    from maniskill_taskgrasp.language.roles import Role

NEAREST_MINIMUM = 0.72  # Cosine below which a name is not the object that was meant.
USED_MINIMUM = 0.4  # Cosine from which an unknown thing is like what people used for the action.
NAMED_AFTER_MINIMUM = 0.75  # The same for a verb with its target, for a tool that nobody named.
SITUATION_MINIMUM = 0.4  # Cosine from which a request is like a known situation.
NEAR_SITUATION = 0.7  # The same for a request that the grammar shows.
SLIP_SCORE = 0.8  # What one slip leaves of a name's certainty.
CANDIDATES = 5  # Alternatives that an answer lists.
CONTENT_ACTIONS = word_set("content_actions")
"""Actions whose target is what comes out; the hand holds the container."""
PLACING_ACTIONS = word_set("placing_actions")
"""Actions whose place is where the object goes, never what is held."""
POURED_ACTIONS = frozenset(["spraying", "aiming", "oiling", "applying"])
HOLDER_WORDS = word_set("holder_words")
"""Words of things that `POURED_ACTIONS` come out of, so that they are what is held."""
WORK_ACTIONS = word_set("work_actions")
"""Tool actions whose target is what is worked on, unless people held that very object."""
FIXTURES = word_set("fixtures")
"""Things that are cleaned where they are, with a cloth in the hand."""
TOOLS_OF_VERBS = word_map("tools_of_verbs")
"""Verbs that say what is held without being its name: "sweep" takes a brush."""
TOOLS_OF_ACTIONS = word_map("tools_of_actions")
"""Where the data's most frequent object is no tool (drilling: a machine's handle)."""
CONTENTS = word_set("contents")
"""What is spilled or poured: words that stand for their container only where it is handled."""
HAND_TOOLS = ("wrench", "hex wrench", "screwdriver", "allen wrench", "pliers", "chuck key")
FASTENING = word_set("fastening")
"""Actions on bolts and screws; people did them with `HAND_TOOLS`, under any of these names."""


PHONING = frozenset(["calling", "texting", "talking on phone"])
"""Actions done on what "on" leads: "write to her on the phone"."""
HELD_AT_PLACE = {
    "wiping": frozenset(["towel", "cloth", "washcloth", "paper towel", "tissue"]),
    "drying": frozenset(["towel", "cloth", "washcloth", "paper towel", "tissue"]),
    "measuring": frozenset(["scale", "bathroom scale", "measuring cup"]),
    "writing": frozenset(["computer"]),
    "using": frozenset(["computer", "calculator"]),
}
"""Tools that English puts behind "on": "dry your hands on the towel"."""


@dataclass(frozen=True)
class Held:
    """The object of a task, and how it was found."""

    name: str | None
    score: float
    candidates: tuple[tuple[str, float], ...] = ()
    note: str | None = None
    wanted: str | None = None
    """Words that name something which the data do not have."""
    guessed: bool = False
    """No words named it: it comes from the data or is the nearest in meaning."""


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


def _only_contains(text: str, name: str) -> bool:
    """Whether a name has the text as a part: a "nail" is no "nail hammer", a "bus" no "toy bus"."""
    return text != name and f" {text} " in f" {name} "


def nearest(text: str, *, synonyms: bool = True) -> tuple[tuple[str, float], ...]:
    """Objects by cosine of their names' vectors with a text, best first.

    Args:
        text: what to compare.
        synonyms: whether other names than the data's count too.

    Raises:
        EncoderMissingError: the encoder is not installed.
    """
    head = load_head()
    cosines = head.name_vectors @ load_encoder().encode([text])[0]
    best: dict[str, float] = {}
    for i in np.argsort(-cosines)[: 4 * CANDIDATES]:
        foreign = not synonyms and head.names[i] not in load_knowledge().objects
        if foreign or _only_contains(text, head.names[i]):
            continue
        for name, certainty in load_lexicon().names[head.names[i]]:
            best.setdefault(name, float(cosines[i]) * certainty)
    return tuple(sorted(best.items(), key=lambda item: -item[1])[:CANDIDATES])


def from_mention(mention: Mention, action: str | None = None) -> Held:
    """The object that words name, with those that they may name besides.

    Of several, the one is taken that people used for the action.
    """
    known = load_knowledge().pair_counts
    ranked = sorted(mention.objects, key=lambda item: (item[0], action) not in known)
    (name, score), *others = ranked
    last = mention.words.split()[-1]
    family = [(o, 0.5) for o in load_knowledge().objects if last in o.split() and o != name]
    note = f"took {mention.words!r} as {name!r}" if score < 1 else None
    return Held(name, score, tuple([*others, *family][:CANDIDATES]), note)


def from_words(words: str) -> Held:
    """The object that unknown words mean: one slip away, else nearest in meaning, else none."""
    respelled = respell_name(words)
    if respelled is not None:
        (name, score), *others = load_lexicon().names[respelled]
        return Held(name, score * SLIP_SCORE, tuple(others), f"read {words!r} as {respelled!r}")
    try:
        ranked = nearest(words)
    except EncoderMissingError:
        return Held(None, 0.0, wanted=words)
    name, score = ranked[0] if ranked else ("", 0.0)  # None is near "metal" but what has it.
    if score < NEAREST_MINIMUM:
        return Held(None, score, ranked, wanted=words)
    note = f"no object is called {words!r}: took the nearest, {name!r}"
    return Held(name, score, ranked[1:], note, guessed=True)


def from_data(action: str, besides: tuple[tuple[str, float], ...] = ()) -> Held:
    """The object that people used most for an action, said openly."""
    ranked = used_for(action)
    name, share = ranked[0]
    usual = TOOLS_OF_ACTIONS.get(action)
    if usual is not None:
        note = f"no object was named for {action}: took {usual!r}, the usual tool"
        return Held(usual, share, (*ranked[:CANDIDATES], *besides), note, guessed=True)
    note = f"no object was named for {action}: took {name!r}, which people used most often for it"
    return Held(name, share, (*ranked[1:CANDIDATES], *besides), note, guessed=True)


def tool_in_verb(clause: Clause, action: str) -> Held | None:
    """The tool that the verb itself names: "sponge off the table", "sweep the porch"."""
    verb = clause.verb
    known = load_knowledge().pair_counts
    called = [o for o, _ in load_lexicon().names.get(verb, ()) if (o, action) in known]
    name = TOOLS_OF_VERBS.get(verb) or next(iter(called), None)
    if name is None:
        return None
    note = f"no object was named: took {name!r}, which {verb!r} is done with"
    return Held(name, SYNONYM_SCORE, (), note)


def like_what_was_used(text: str, action: str) -> Held | None:
    """Of the objects that people used for an action, the one that an unknown thing is like."""
    used = [name for name, _ in used_for(action)] if action not in GENERIC_ACTIONS else []
    head = load_head()
    rows = [head.names.index(name.lower()) for name in used]
    try:
        vector = load_encoder().encode([text])[0]
    except EncoderMissingError:
        return None
    cosines = head.name_vectors[rows] @ vector
    if not rows or cosines.max() < USED_MINIMUM:
        return None
    name, score = used[int(cosines.argmax())], float(cosines.max())
    note = f"no object is called {text!r}: took {name!r}, the nearest that people used for {action}"
    return Held(name, score, nearest(text), note, guessed=True)


def from_situation(task: Task, action: str) -> Held | None:
    """The object that the likest known situation takes: flashlight for "it's dark in here"."""
    if task.told is None:
        return None
    least = SITUATION_MINIMUM if task.meant else NEAR_SITUATION
    try:
        vector = load_encoder().encode([task.told.said])[0]
    except EncoderMissingError:
        return None
    likeness = load_head().situation_vectors @ vector
    known = load_situations()
    rows = [i for i in np.argsort(-likeness) if known[i].action == action]
    if not rows or likeness[rows[0]] < least:
        return None
    name, score = known[rows[0]].object, float(likeness[rows[0]])
    note = f"no object was named: took {name!r}, as for {known[rows[0]].said!r}"
    others = dict.fromkeys(known[i].object for i in rows[1:] if known[i].object != name)
    return Held(name, score, tuple((n, score) for n in others)[:CANDIDATES], note, guessed=True)


def named_after(clause: Clause) -> Held | None:
    """The object whose name tells its purpose: "brush your teeth" is the toothbrush's job."""
    target = clause.role("target")
    if target is None or target.pronoun or target.mention is not None:
        return None
    try:
        ranked = nearest(f"{clause.verb} {target.text}", synonyms=False)
    except EncoderMissingError:
        return None
    name, score = next(iter(ranked), ("", 0.0))
    if score < NAMED_AFTER_MINIMUM or name == target.text:
        return None
    note = f"no object was named: took {name!r}, whose name says what it is for"
    return Held(name, score, ranked[1:], note, guessed=True)


def antecedent(task: Task) -> Mention | None:
    """What "it" refers to: the latest object named before the clause, else the next after it."""
    source = task.source
    pronoun = any(role.pronoun for role in source.clause.roles)
    later = source.later if pronoun else ()
    return next(iter((*reversed(source.earlier), *later)), None)


def is_worked_on(name: str, action: str) -> bool:
    """Whether a named object is what the tool works on rather than what the hand holds."""
    if action not in TOOL_ACTIONS:
        return False
    if name in FIXTURES:
        return not (action == "washing" and load_knowledge().objects[name].is_floppy)
    if action in POURED_ACTIONS and any(w in HOLDER_WORDS for w in name.split()):
        return False
    return action in WORK_ACTIONS and (name, action) not in load_knowledge().pair_counts


def _from_role(role: Role, task: Task) -> Held | None:
    """The object of a role; None for a pronoun that refers to nothing."""
    if role.mention is not None:
        return from_mention(role.mention)
    if role.pronoun:
        before = antecedent(task)
        return from_mention(before) if before is not None else None
    return from_words(role.text)


def _from_acted_on(mention: Mention, task: Task, action: str) -> Held:
    """The named target, or the data's tool where the target is only worked on."""
    held = from_mention(mention, action)
    spilled = mention.words in CONTENTS and action in TOOL_ACTIONS - POURED_ACTIONS
    if held.name is not None and (spilled or is_worked_on(held.name, action)):
        spoken = _spoken_of(task, action) or from_situation(task, action)
        return spoken or from_data(action, ((held.name, held.score),))
    return held


def _prepared(task: Task, action: str | None) -> Held | None:
    """What a transfer or "use" put into the hand; None where it named nothing."""
    if task.anything and action is not None:
        return from_data(action)
    if task.held is None:
        return None
    held = _from_role(task.held, task)
    if held is not None and held.name is None and action in TOOL_ACTIONS:
        return None
    return held


def _instrument(task: Task, clause: Clause, action: str) -> Held | None:
    """What stands behind "with" and the like, or on what people phone."""
    tool = clause.role("instrument")
    if tool is not None:
        held = _from_role(tool, task)
        guessed = tool.mention is None and not tool.pronoun and action not in TOOL_ACTIONS
        if held is not None and held.name is not None and not (guessed and clause.role("target")):
            return held
    sought, target = task.source.sought, clause.role("target")
    if sought is not None and (target is None or not target.mention or clause.mood == "wish"):
        return from_mention(sought)  # "I want to rinse the plate, where is the hose?"
    place = clause.role("place")
    if place is not None and place.mention is not None:
        name = place.mention.objects[0][0]
        if action in PHONING or name in HELD_AT_PLACE.get(action, ()):
            return from_mention(place.mention)
    return None


def _container(clause: Clause, action: str) -> Held | None:
    """What something comes out of: "pour from the kettle", "squeeze it out of the tube"."""
    source = clause.role("source")
    if action not in CONTENT_ACTIONS or source is None or source.mention is None:
        return None
    return from_mention(source.mention)


def _target(task: Task, clause: Clause, action: str) -> Held | None:
    """What the action is done to, where that is what the hand holds."""
    target = clause.role("target")
    if target is None:
        return None
    if target.mention is not None:
        return _from_acted_on(target.mention, task, action)
    if target.pronoun:
        before = antecedent(task)
        return _from_acted_on(before, task, action) if before is not None else None
    return None


def _elsewhere(clause: Clause, action: str) -> Held | None:
    """An object named only as source or place, unless the action puts things there."""
    target = clause.role("target")
    named = target is not None and not target.pronoun
    for kind in ("source", "place"):
        role = clause.role(kind)
        if role is None or role.mention is None or action in PLACING_ACTIONS:
            continue
        if named and kind == "place" and role.certainty < 1 and action in TOOL_ACTIONS:
            continue  # "The nut on the wheel": neither is held.
        if not is_worked_on(role.mention.objects[0][0], action):
            return from_mention(role.mention)
    return None


def _spoken_of(task: Task, action: str) -> Held | None:
    """An object named before that people use for the action: "the pen, I must sign"."""
    usual = {name for name, _ in used_for(action)}
    for mention in (*reversed(task.source.earlier), *task.source.later):
        if mention.objects[0][0] in usual:
            return from_mention(mention)
    return None


def _instead(task: Task, action: str, unknown: Held) -> Held:
    """What to hold where the target is no object of the data: a like thing that is."""
    like = like_what_was_used(unknown.wanted or "", action)
    return like or (from_situation(task, action) if task.meant else None) or unknown


def choose_object(task: Task, action: str | None) -> Held:
    """The object of a task.

    In this order: what a transfer or "use" names, the instrument, the container, what is acted
    on, an object named elsewhere, the tool that people used, the nearest name by meaning, and
    what was spoken of last.
    """
    held = _prepared(task, action)
    tool = task.told.clause.role("instrument") if task.told is not None else None
    says_tool = task.transfer and tool is not None and tool.mention is not None
    if action is None or task.told is None or (held is not None and not says_tool):
        return held or Held(None, 0.0)
    clause = task.told.clause
    held = (
        _instrument(task, clause, action)
        or _container(clause, action)
        or _target(task, clause, action)
        or _elsewhere(clause, action)
    )
    if held is not None:
        return held
    target = clause.role("target")
    if action in TOOL_ACTIONS:
        spoken = _spoken_of(task, action) or named_after(clause) or tool_in_verb(clause, action)
        return spoken or from_situation(task, action) or from_data(action)
    if target is not None and not target.pronoun:
        held = named_after(clause) or tool_in_verb(clause, action) or from_words(target.text)
        found = held.name is not None
        return held if found else _instead(task, action, held)
    before = antecedent(task) if target is None else None
    if before is not None:
        return from_mention(before)
    return (from_situation(task, action) if task.meant else None) or Held(None, 0.0)
