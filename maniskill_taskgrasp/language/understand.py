"""Whole text -> Instruction or Rejected: the order of the steps and the decisions to refuse."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from maniskill_taskgrasp.errors import echo
from maniskill_taskgrasp.language.actions import (
    ActionScores,
    most_frequent_parameters,
    score_actions,
)
from maniskill_taskgrasp.language.encoder import EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.guard import TRY, refuse
from maniskill_taskgrasp.language.instruction import Instruction, Rejected
from maniskill_taskgrasp.language.lexicon import SYNONYM_SCORE, load_lexicon
from maniskill_taskgrasp.language.meaning import tasks_by_meaning
from maniskill_taskgrasp.language.model import load_model
from maniskill_taskgrasp.language.objects import Held, antecedent, choose_object
from maniskill_taskgrasp.language.opposites import undone
from maniskill_taskgrasp.language.plan import (
    Task,
    alone,
    asked_verbs,
    contradiction,
    make_tasks,
    tell,
    without_background,
)
from maniskill_taskgrasp.language.segments import (
    frame,
    request_of_state,
    split_requests,
    strip_retraction,
)
from maniskill_taskgrasp.language.spelling import correct, correct_verb
from maniskill_taskgrasp.language.text import FILLERS, MAX_SEGMENTS, URGENT, clean, split_sentences
from maniskill_taskgrasp.language.words import word_set

if TYPE_CHECKING:
    from spacy.tokens import Doc

    from maniskill_taskgrasp.language.clauses import Clause
    from maniskill_taskgrasp.language.segments import Segment

MEANING_MINIMUM = 0.35  # Probability by which meaning alone may name the action of an unknown verb.
NAMED_MINIMUM = 0.25  # The same where the clause names an object of the data.
REFUSED_VERBS = word_set("refused_verbs")
"""Verbs that are no task for a hand, whatever their nouns."""
NO_ACTION_MAXIMUM = 0.5  # Probability of "none of the 74" above which an unknown verb is refused.
ASKED_BACK = re.compile(r",? (?:could|can|would|will|won't) you$")
"""A question behind the request: "I can't reach the remote, could you?"."""
PLEASE_WHERE = re.compile(r"(?P<thing>[\w -]+?),? please[,.] (?:it|they|i)\b")
"""A thing asked for, and then where it is: "my glasses, please, they're on the desk"."""
BY_MEANING = "no listed phrase has "
TRANSFER_NOTE = "the words ask for a transfer, not a use: the object's usual actions decide"
LIGHTER_NOTE = "the sentence encoder is not installed ({}): only listed phrases are understood"


def read_segments(text: str) -> tuple[list[Segment], list[Doc]]:
    """Framed segments of a cleaned text, and their parses with mentions and clauses."""
    sentences = (ASKED_BACK.sub("", sentence) for sentence in split_sentences(text))
    parts = [part for sentence in sentences for part in split_requests(sentence)]
    segments: list[Segment] = []
    for part in parts[:MAX_SEGMENTS]:
        request, instead = strip_retraction(part)
        if instead:
            segments = [replace(segment, asking=True) for segment in segments]
        segments.append(frame(request))
    docs = list(load_model().pipe([segment.framed for segment in segments]))
    return segments, docs


def read_inner(segments: list[Segment], docs: list[Doc]) -> list[Doc]:
    """Docs anew, with the imperative inside each segment that has one."""
    return [
        load_model()(segment.inner) if segment.inner else doc
        for segment, doc in zip(segments, docs, strict=True)
    ]


def understand(text: str, object_override: str | None = None) -> Instruction | Rejected:
    """See `maniskill_taskgrasp.language.parse`."""
    cleaned = clean(text)
    refused = refuse(text, cleaned)
    if refused is not None:
        return refused
    corrected, notes = correct(cleaned)
    result = understand_clean(text, corrected, notes, object_override)
    if isinstance(result, Rejected):
        doubtful = result.kind in {"no_action", "off_topic"}
    else:
        doubtful = is_guess(result)
    if doubtful:
        again, more = correct_verb(corrected, 0)
        if more:
            second = understand_clean(text, again, (*notes, *more), object_override)
            named = isinstance(second, Instruction) and second.object_score >= SYNONYM_SCORE
            return second if named else result
    return result


def understand_clean(
    text: str, cleaned: str, notes: tuple[str, ...], object_override: str | None
) -> Instruction | Rejected:
    """The answer for a cleaned and corrected text.

    Args:
        text: as typed, for the messages.
        cleaned: the text to read.
        notes: remarks on what was corrected.
        object_override: as in `parse`.
    """
    segments, docs = read_segments(cleaned)
    told = tell(segments, docs)
    verb = contradiction(told) or undone(docs, asked_verbs(told))
    if verb is not None:
        reason = f"{echo(text)} both asks for and forbids {verb!r}: say which of the two"
        return Rejected(text, reason, "contradictory")
    bare = bare_name(cleaned)
    if bare is not None and object_override is None:
        return bare_request(text, cleaned, bare, notes)
    tasks = make_tasks(told) or make_tasks(tell(segments, read_inner(segments, docs)))
    tasks = without_background(tasks, len(cleaned.split()))
    answers = [answer(task, text, object_override) for task in tasks]
    refused = answers
    if not any(isinstance(a, Instruction) for a in answers):
        meant = next(filter(None, map(request_of_state, split_sentences(cleaned))), None)
        if meant is not None:
            notes = (*notes, f"took the complaint as {meant!r}")
            return understand_clean(text, meant, notes, object_override)
    if all(isinstance(a, Rejected) or is_guess(a) for a in answers):
        others = [answer(t, text, object_override) for t in tasks_by_meaning(segments, docs)]
        answers = others if any(isinstance(a, Instruction) for a in others) else answers
    if not any(isinstance(a, Instruction) for a in answers):
        return explain_refusal(text, refused + answers, docs)
    understood = [a for a in answers if isinstance(a, Instruction)]
    first = answers.index(understood[0])
    later = tuple(
        a for a in answers[first + 1 :] if isinstance(a, Instruction) or a.kind == "no_object"
    )
    return finish(understood[0], text, later, notes)


def is_guess(result: Instruction) -> bool:
    """Whether no listed phrase names the action."""
    return any(note.startswith(BY_MEANING) for note in result.notes)


def bare_name(cleaned: str) -> str | None:
    """The object that is all there is in a text but politeness, None for anything more."""
    where = PLEASE_WHERE.match(cleaned)
    cleaned = where["thing"] if where else cleaned
    words = [w.strip(",.!?") for w in cleaned.split()]
    while words and words[0] in FILLERS | {"the", "a", "an", "my", "that", "this"}:
        words = words[1:]
    while words and words[-1] in FILLERS | URGENT:
        words = words[:-1]
    found = load_lexicon().names.get(" ".join(words), ())
    return found[0][0] if found else None


def bare_request(
    text: str, cleaned: str, name: str, notes: tuple[str, ...]
) -> Instruction | Rejected:
    """A name alone is a transfer when said politely or urgently, and nothing otherwise."""
    if not URGENT & set(re.split(r"[^a-z]+", cleaned)) and not cleaned.endswith("!"):
        reason = f"{echo(text)} names {name!r} but nothing to do with it: try 'hand me the {name}'"
        return Rejected(text, reason, "no_action")
    return Instruction(
        text=text,
        action=None,
        action_score=0.0,
        actions_top3=(),
        transfer=True,
        object=name,
        object_score=1.0,
        notes=(*notes, TRANSFER_NOTE),
    )


def finish(
    first: Instruction, text: str, rest: tuple[Instruction | Rejected, ...], notes: tuple[str, ...]
) -> Instruction:
    """The first task with the later ones and the remarks on the whole text."""
    try:
        load_encoder()
    except EncoderMissingError as error:
        notes = (*notes, LIGHTER_NOTE.format(error))
    return replace(first, text=text, rest=rest, notes=(*notes, *first.notes))


def explain_refusal(text: str, answers: list[Instruction | Rejected], docs: list[Doc]) -> Rejected:
    """The reason for a text without a task that can be answered."""
    refused = [a for a in answers if isinstance(a, Rejected)]
    for kind in ("no_object", "no_action"):
        for answer_ in refused:
            if answer_.kind == kind:
                return answer_
    if any(clause.negated for doc in docs for clause in doc._.clauses):
        reason = f"{echo(text)} only says what not to do: say what to do, {TRY}"
        return Rejected(text, reason, "no_action")
    mentions = [m for doc in docs for m in doc._.mentions]
    if mentions:
        name = mentions[0].words
        reason = f"{echo(text)} names {name!r} but nothing to do with it: try 'hand me the {name}'"
        return Rejected(text, reason, "no_action")
    return Rejected(text, f"{echo(text)} is no task for a hand: {TRY}", "off_topic")


def is_meant(clause: Clause, scores: ActionScores) -> bool:
    """Whether the words mean one of the 74 actions at all."""
    if clause.verb in REFUSED_VERBS and not scores.particular:
        return False
    if scores.known_verb:
        return True
    named = any(r.certainty == 1 for r in clause.roles)
    least = NAMED_MINIMUM if named else MEANING_MINIMUM
    return scores.ranked[0][1] >= least and scores.no_action <= NO_ACTION_MAXIMUM


def referents(task: Task) -> frozenset[str]:
    """Words for what the clause's pronouns refer to: "the phone is ringing, answer it"."""
    before = antecedent(task)
    pronoun = task.told is not None and any(r.pronoun for r in task.told.clause.roles)
    return frozenset(before.words.split()) if pronoun and before is not None else frozenset()


def answer(task: Task, text: str, object_override: str | None) -> Instruction | Rejected:
    """One task's instruction, or why it has none."""
    scores = None
    if task.told is not None:
        scores = score_actions(task.told.clause, referents(task), task.told.said)
        if not task.meant and not is_meant(task.told.clause, scores):
            if task.preparation is not None:
                return answer(alone(task.preparation)[0], text, object_override)
            reason = f"no action of the data fits {echo(task.told.clause.text)}: {TRY}"
            return Rejected(text, reason, "off_topic")
    action = scores.ranked[0][0] if scores is not None else None
    names_object = task.told is not None and any(r.certainty > 0.5 for r in task.told.clause.roles)
    held = Held(None, 1.0) if object_override else choose_object(task, action)
    if object_override is None:
        if held.name is None:
            return no_object(task, text, held)
        unsure = scores is not None and (
            not scores.known_verb or (scores.no_action > NO_ACTION_MAXIMUM and not names_object)
        )
        if held.guessed and unsure and not task.meant:  # One guess may stand, two may not.
            reason = f"no action of the data fits {echo(task.source.clause.text)}: {TRY}"
            return Rejected(text, reason, "off_topic")
    by_meaning = None
    if task.told is not None and scores is not None and not scores.known_verb:
        words = task.told.clause.verb or task.told.clause.text
        by_meaning = f"{BY_MEANING}{words!r}: took the nearest action in meaning"
    notes = [n for n in (by_meaning, held.note, TRANSFER_NOTE if action is None else None) if n]
    return Instruction(
        text=task.source.clause.text,
        action=action,
        action_score=scores.ranked[0][1] if scores is not None else 0.0,
        actions_top3=scores.ranked[:3] if scores is not None else (),
        transfer=task.transfer,
        object=held.name,
        object_score=held.score,
        object_candidates=held.candidates,
        parameters=most_frequent_parameters(action) if action else {},
        notes=tuple(notes),
    )


def no_object(task: Task, text: str, held: Held) -> Rejected:
    """The refusal of a task whose object is not named or not known."""
    if held.wanted is not None:
        near = ", ".join(repr(name) for name, _ in held.candidates[:3])
        hint = f"; the nearest are {near}" if near else ""
        reason = f"no object of the data is like {echo(held.wanted)}{hint} (or give a mesh)"
    else:
        reason = f"{echo(text)} does not say with what: name an object, {TRY}"
    return Rejected(text, reason, "no_object")
