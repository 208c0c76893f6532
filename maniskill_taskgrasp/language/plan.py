"""Clauses of a whole text -> tasks in the order to be done, transfers joined with their purpose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from maniskill_taskgrasp.language.lexicon import TOOL_ACTIONS, load_lexicon
from maniskill_taskgrasp.language.roles import SOMETHING, Role

if TYPE_CHECKING:
    from spacy.tokens import Doc

    from maniskill_taskgrasp.language.clauses import Clause
    from maniskill_taskgrasp.language.mentions import Mention
    from maniskill_taskgrasp.language.segments import Segment

USE_VERBS = frozenset(["use", "employ", "utilize", "utilise"])
PREPARING_VERBS = USE_VERBS | {"take", "have"}
"""Verbs that, before another request, only say what to do it with."""


@dataclass(frozen=True)
class Told:
    """A clause with where it stood and what had been mentioned before it."""

    clause: Clause
    segment: int
    earlier: tuple[Mention, ...]
    """Objects named before this clause, oldest first, without those that were ruled out."""


@dataclass(frozen=True)
class Task:
    """One thing to do."""

    told: Told | None
    """What to do; None for a transfer without a purpose."""
    held: Role | None = None
    """What the words of a transfer or of "use" put into the hand."""
    transfer: bool = False
    preparation: Told | None = None
    """The transfer or "use" that named `held`."""

    @property
    def source(self) -> Told:
        told = self.told or self.preparation
        assert told is not None
        return told


def order_segments(segments: list[Segment]) -> list[int]:
    """Indices of the segments in the order of doing: "before X, Y" is Y, X."""
    order = list(range(len(segments)))
    for i in range(len(segments) - 1):
        if segments[i].order == "after next":
            order[i], order[i + 1] = order[i + 1], order[i]
    return order


def ruled_out(segment: Segment, doc: Doc, mention: Mention) -> bool:
    """Whether the words say that this object is not meant ("not with the towel")."""
    if segment.negated and not any(not c.negated for c in doc._.clauses):
        return not doc._.clauses or doc._.clauses[0].verb in USE_VERBS | {"mind"}
    before = [t.lower_ for t in doc[max(0, mention.start - 3) : mention.start]]
    return "not" in before and "should" not in before


def tell(segments: list[Segment], docs: list[Doc]) -> list[Told]:
    """All clauses of the text, in the order of doing."""
    seen: dict[int, list[Mention]] = {}
    before: list[Mention] = []
    for k, (segment, doc) in enumerate(zip(segments, docs, strict=True)):
        seen[k] = list(before)
        before += [m for m in doc._.mentions if not ruled_out(segment, doc, m)]
    told = []
    for k in order_segments(segments):
        own: list[Mention] = []
        for clause in docs[k]._.clauses:
            own = [m for m in docs[k]._.mentions if m.end <= clause.at]
            told.append(Told(clause, k, (*seen[k], *own)))
    return told


def contradiction(told: list[Told]) -> str | None:
    """The verb that is both asked for and forbidden for the same thing, None where there is none."""
    for yes in told:
        for no in told:
            if yes.clause.negated or not no.clause.negated or yes.clause.verb != no.clause.verb:
                continue
            asked, denied = yes.clause.role("target"), no.clause.role("target")
            unclear = asked is None or denied is None or asked.pronoun or denied.pronoun
            tools = yes.clause.role("instrument"), no.clause.role("instrument")
            if (unclear or asked.text == denied.text) and tools[0] == tools[1]:
                return yes.clause.verb
    return None


def _held_role(clause: Clause) -> Role | None:
    """What a transfer or "use" clause names; None for "something"."""
    role = clause.role("target") or clause.role("instrument")
    return None if role is None or role.text.split()[-1] in SOMETHING else role


def _is_candidate(told: Told) -> bool:
    clause = told.clause
    left_alone = clause.verb == "leave" and "alone" in clause.words
    return clause.mood != "statement" and not clause.negated and not left_alone


def may_use(told: Told) -> bool:
    """Whether the task is one that people do with a tool."""
    phrases = load_lexicon().phrases.get(told.clause.verb, ())
    return any(p.action in TOOL_ACTIONS and not p.nouns for p in phrases)


def _belongs(task: Told, preparation: Told) -> bool:
    """Whether a request is what a preparing clause was for."""
    clause = task.clause
    if clause.purpose or clause.mood == "wish":
        return True
    target = clause.role("target")
    refers = any(r.pronoun for r in clause.roles) and preparation.clause.transfer
    names_own = clause.role("instrument") is not None and clause.role("instrument").mention
    if names_own and not clause.role("instrument").pronoun:
        held = _held_role(preparation.clause)
        return held is not None and held.text == clause.role("instrument").text
    return refers or target is None or may_use(task)


def make_tasks(told: list[Told]) -> list[Task]:
    """Requests with their transfers joined; pure transfers stay on their own."""
    tasks: list[Task] = []
    pending: Told | None = None
    for item in (t for t in told if _is_candidate(t)):
        clause = item.clause
        if clause.transfer or clause.verb in PREPARING_VERBS:
            wished = tasks and tasks[-1].told is not None and tasks[-1].told.clause.mood == "wish"
            if clause.transfer and wished and tasks[-1].held is None:
                tasks[-1] = Task(tasks[-1].told, _held_role(clause), True, item)
                continue
            if pending is not None:
                tasks.append(_alone(pending))
            pending = item
            continue
        if pending is not None and _belongs(item, pending):
            tasks.append(Task(item, _held_role(pending.clause), pending.clause.transfer, pending))
        else:
            if pending is not None:
                tasks.append(_alone(pending))
            tasks.append(Task(item))
        pending = None
    if pending is not None:
        tasks.append(_alone(pending))
    return tasks


def _alone(told: Told) -> Task:
    if told.clause.transfer:
        return Task(None, _held_role(told.clause), True, told)
    return Task(told)
