"""Clauses of a whole text -> tasks in the order to be done, transfers joined with their purpose."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.lexicon import (
    TOOL_ACTIONS,
    WEAK_TRANSFER_VERBS,
    load_lexicon,
    matches,
)
from maniskill_taskgrasp.language.roles import PLACE_WORDS, SOMETHING, SOURCE_WORDS, Role, governor
from maniskill_taskgrasp.language.words import word_set

if TYPE_CHECKING:
    from spacy.tokens import Doc

    from maniskill_taskgrasp.language.clauses import Clause
    from maniskill_taskgrasp.language.mentions import Mention
    from maniskill_taskgrasp.language.segments import Segment

USE_VERBS = word_set("use_verbs")
PREPARING_VERBS = word_set("preparing_verbs")
"""Verbs that, before another request, only say what to do it with."""
ABSTRACT = word_set("abstract")
"""Things that are asked for but not handed over: "I need help"."""
GRIPPERS = word_set("grippers")
"""Tools that hold another object in the hand's stead."""
LONG_TEXT = 18  # Words from which on what leads up to a request is taken for background.
CONTINUING = ("you ", "and ", "then ")
"""What a request starts with that only goes on with what was told: "and then put it back"."""
SEEKING = re.compile(r"where (?:is|are) |(?:is|are) there (?:a|an|any) |got (?:a|an|any) ")
"""Questions that look for an object."""
SEE_VERBS = word_set("see_verbs")
"""Verbs that point at something without a task for the hand: "see the hammer?"."""


@dataclass(frozen=True)
class Told:
    """A clause with what had been mentioned before it."""

    clause: Clause
    earlier: tuple[Mention, ...]
    """Objects named before this clause, oldest first, without those that were ruled out."""
    later: tuple[Mention, ...] = ()
    """Objects named after it, for a pronoun that runs ahead of its noun."""
    said: str = ""
    """The whole request around it."""
    sought: Mention | None = None
    """The object that a question looks for: "where is the hose?"."""


@dataclass(frozen=True)
class Task:
    """One thing to do."""

    told: Told | None
    """What to do; None for a transfer without a purpose."""
    held: Role | None = None
    """What the words of a transfer or of "use" put into the hand."""
    preparation: Told | None = None
    """The transfer or "use" that named `held`."""
    anything: bool = False
    """The transfer asks for "something", so that the data choose."""
    meant: bool = False
    """The meaning of the whole request shows that it is one (`meaning`)."""

    @property
    def transfer(self) -> bool:
        return self.preparation is not None and self.preparation.clause.transfer

    @property
    def direct(self) -> bool:
        """Whether it is asked of the hearer, not told as what "you have to do"."""
        told = [t for t in (self.told, self.preparation) if t is not None]
        return any(t.clause.direct and not t.said.startswith(CONTINUING) for t in told)

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
    clauses = doc._.clauses
    if segment.negated and all(c.negated for c in clauses):
        return not clauses or clauses[0].verb in USE_VERBS | {"mind"}
    before = [t.lower_ for t in doc[max(0, mention.start - 3) : mention.start]]
    denied = ("not" in before and "should" not in before) or before[-2:-1] == ["n't"]
    return denied or before[-3:-1] == ["anything", "but"]


def is_place(doc: Doc, mention: Mention) -> bool:
    """Whether an object is named only as where something is ("the pliers on the bench")."""
    return mention.start > 1 and governor(doc, mention.start, -1) in PLACE_WORDS | SOURCE_WORDS


def tell(segments: list[Segment], docs: list[Doc]) -> list[Told]:
    """All clauses of the text, in the order of doing."""
    seen: dict[int, list[Mention]] = {}
    before: list[Mention] = []
    for k, (segment, doc) in enumerate(zip(segments, docs, strict=True)):
        seen[k] = list(before)
        meant = [m for m in doc._.mentions if not ruled_out(segment, doc, m)]
        before += sorted(meant, key=lambda m: not is_place(doc, m))
    told = []
    asked_for = [d for s, d in zip(segments, docs, strict=True) if SEEKING.match(s.text)]
    sought = next((m for doc in asked_for for m in doc._.mentions), None)
    for k in order_segments(segments):
        if segments[k].asking:
            continue
        for clause in docs[k]._.clauses:
            if segments[k].negated and " mind " in segments[k].framed[:12]:
                continue  # "Never mind folding it".
            own = [m for m in docs[k]._.mentions if m.end <= clause.at]
            later = [m for doc in docs[k + 1 :] for m in doc._.mentions]
            told.append(Told(clause, (*seen[k], *own), tuple(later), segments[k].text, sought))
    return told


def _forbids(told: Told) -> bool:
    too_much = "too" in told.clause.words  # "Don't cut it too short" limits, it does not forbid.
    return told.clause.negated and told.clause.mood != "statement" and not too_much


def contradiction(told: list[Told]) -> str | None:
    """The verb that is both asked for and forbidden for the same thing, if there is one."""
    for yes in told:
        for no in told:
            if not _is_asked(yes) or not _forbids(no) or yes.clause.verb != no.clause.verb:
                continue
            asked, denied = yes.clause.role("target"), no.clause.role("target")
            unclear = asked is None or denied is None or asked.pronoun or denied.pronoun
            same = unclear or asked.text == denied.text  # type: ignore[union-attr]
            if same and _tool(yes.clause) == _tool(no.clause):
                return yes.clause.verb
    return None


def asked_verbs(told: list[Told]) -> frozenset[str]:
    """Verbs that are asked for."""
    return frozenset(one.clause.verb for one in told if _is_asked(one))


def _tool(clause: Clause) -> str | None:
    role = clause.role("instrument")
    return role.text if role is not None else None


def _names_something(clause: Clause) -> bool:
    """Whether a clause asks for "something" instead of an object."""
    target = clause.role("target")
    return target is not None and target.text.split()[-1] in SOMETHING


def held_role(clause: Clause) -> Role | None:
    """What a transfer or "use" clause names; None for "something"."""
    if _names_something(clause):
        return None
    target, tool = clause.role("target"), clause.role("instrument")
    if tool is not None and tool.mention and tool.mention.objects[0][0] in GRIPPERS:
        return tool  # "Grab the can with the tongs": the hand holds the tongs.
    role = target or tool
    return role or (clause.role("place") if clause.transfer else None)


def _is_asked(told: Told) -> bool:
    clause = told.clause
    target = clause.role("target")
    if clause.transfer and target is not None and target.text in ABSTRACT:
        return False
    left_alone = clause.verb == "leave" and "alone" in clause.words
    only_pointed = clause.verb in SEE_VERBS and not _has_particular_phrase(clause)
    return clause.mood != "statement" and not clause.negated and not left_alone and not only_pointed


def _has_particular_phrase(clause: Clause) -> bool:
    """Whether the lexicon has a phrase for more than the verb alone: "see how long"."""
    phrases = load_lexicon().phrases.get(clause.verb, ())
    nouns = frozenset(clause.words)
    return any(p.specificity > 1 and matches(p, clause.words, nouns) for p in phrases)


def _may_use_tool(clause: Clause) -> bool:
    """Whether the verb names something that people do with a tool."""
    phrases = load_lexicon().phrases.get(clause.verb, ())
    nouns = frozenset(clause.words)
    tools = [p for p in phrases if p.action in TOOL_ACTIONS]
    return any(not p.nouns or matches(p, clause.words, nouns) for p in tools)


def _only_prepares(clause: Clause) -> bool:
    """Whether the verb is one of `PREPARING_VERBS` and no phrase makes it more ("take off")."""
    prepares = clause.verb in PREPARING_VERBS and not _has_particular_phrase(clause)
    return clause.verb in USE_VERBS or prepares


def _takes_out(clause: Clause, following: Told | None) -> bool:
    """Whether a tool is only got out for what follows: "get the hoover out and do the carpet"."""
    target = clause.role("target")
    if following is None or target is None or target.mention is None:
        return False
    name, known = target.mention.objects[0][0], load_knowledge().pair_counts
    phrases = load_lexicon().phrases.get(following.clause.verb, ())
    used = any((name, p.action) in known for p in phrases if p.action in TOOL_ACTIONS)
    return used and clause.verb in WEAK_TRANSFER_VERBS and "out" in clause.words


def _belongs(told: Told, preparation: Told) -> bool:
    """Whether a request is what a preparing clause was for."""
    clause = told.clause
    if clause.purpose or clause.mood == "wish":
        return True
    tool, held = clause.role("instrument"), held_role(preparation.clause)
    if tool is not None and not tool.pronoun:
        return held is not None and held.text == tool.text
    refers = any(r.pronoun for r in clause.roles)
    return refers or clause.role("target") is None or _may_use_tool(clause)


def without_background(tasks: list[Task], words: int) -> list[Task]:
    """Tasks of a long text from the first on that is asked of the hearer, else all.

    Args:
        tasks: in the order of doing.
        words: of the whole text.
    """
    direct = [k for k, task in enumerate(tasks) if task.direct]
    return tasks[direct[0] :] if direct and words >= LONG_TEXT else tasks


def make_tasks(told: list[Told]) -> list[Task]:
    """Requests with their transfers joined; pure transfers stay on their own."""
    tasks: list[Task] = []
    pending: Told | None = None
    asked = [item for item in told if _is_asked(item)]
    for at, item in enumerate(asked):
        following = asked[at + 1] if at + 1 < len(asked) else None
        clause = item.clause
        if clause.verb == "look" and following and any(r.pronoun for r in following.clause.roles):
            continue  # "Look at the rug, vacuum it" only points at it.
        if clause.transfer or _only_prepares(clause) or _takes_out(clause, following):
            leads = following is not None and _belongs(following, item)
            names_tool = not leads and bool(tasks) and _names_tool(item, tasks[-1])
            if tasks and (names_tool or (clause.transfer and _is_wish_without_tool(tasks[-1]))):
                anything = _names_something(clause)
                tasks[-1] = Task(tasks[-1].told, held_role(clause), item, anything)
                continue
            tasks += alone(pending)
            pending = item
        elif pending is not None and _belongs(item, pending):
            anything = _names_something(pending.clause)
            tasks.append(Task(item, held_role(pending.clause), pending, anything))
            pending = None
        else:
            tasks += alone(pending)
            tasks.append(Task(item))
            pending = None
    return tasks + alone(pending)


def _names_tool(item: Told, task: Task) -> bool:
    """Whether a clause says what to do the task before it with: "wipe it, use the cloth"."""
    held = held_role(item.clause)
    if item.clause.transfer or task.preparation is not None or task.told is None or held is None:
        return False
    told = task.told.clause
    if held.mention is None or told.role("instrument") is not None or not _may_use_tool(told):
        return False
    name, known = held.mention.objects[0][0], load_knowledge().pair_counts
    phrases = load_lexicon().phrases.get(told.verb, ())
    return item.clause.verb in USE_VERBS or any((name, p.action) in known for p in phrases)


def _is_wish_without_tool(task: Task) -> bool:
    if task.told is None or task.preparation is not None:
        return False
    return task.told.clause.mood == "wish" or task.told.clause.purpose


def alone(told: Told | None) -> list[Task]:
    """The task of a preparing clause that nothing followed."""
    if told is None:
        return []
    if told.clause.transfer:
        return [Task(None, held_role(told.clause), told)]
    return [Task(told)]
