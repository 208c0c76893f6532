"""Which of the 74 actions a clause means: phrases of the lexicon weighed by sentence meaning."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import as_file, files
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.knowledge import PARAMETERS, load_knowledge
from maniskill_taskgrasp.language.encoder import EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.lexicon import load_lexicon, matches
from maniskill_taskgrasp.language.words import word_map, word_set

if TYPE_CHECKING:
    from collections.abc import Mapping

    from maniskill_taskgrasp.language.clauses import Clause

NO_ACTION = "no action of the table"
"""The head's class for everything that is none of the 74 actions."""
HAND_OVER = "an object to be handed over"
"""Its class for transfers that name no use."""
TEMPER = 0.7  # What the head's log-odds count for beside those of the phrases.
PHRASE_BONUS = 6.0  # Log-odds that the most specific matching phrase adds to its action.
PARTICULAR_BONUS = 8.0  # The same for a phrase of more than a verb: "put down".
RANK_DISCOUNT = 1.5  # Taken off that bonus for the last phrase of an action's list.
TOOL_BONUS = 4.0  # Times the share of an action in what people did with the instrument.
GENERIC_ACTIONS = word_set("generic_actions")
"""Actions done with anything, which an instrument says nothing about."""
RESULT_SPECIFICITY = 3  # "Push it shut" says closing more surely than pushing.
RESULTS = word_map("results")
RESULTLESS = word_set("resultless")
"""Verbs that keep a state instead of bringing it about: "hold the door open"."""
LONGEST_SAID = 160  # Characters of a request beyond which its clause alone is weighed.
LITERAL_DISCOUNT = 2.0  # What "clean" loses as cleaning where "clean|dishes" says washing.
VAGUE_BONUS = 2.0  # Log-odds of a phrase less specific than the best.
READINGS = {"clause": 0.65, "said": 0.15, "verb": 0.12, "objects": 0.08}
"""Weights of what is mixed: the clause with its phrases, the whole request by meaning alone, any
phrase of the verb, and what people did with the objects named. The first decides nearly alone;
the others fill the top three where it is wrong."""


@dataclass(frozen=True)
class Head:
    """One hidden layer and a softmax on sentence vectors, and the vectors of the object names."""

    hidden_weights: np.ndarray
    """(h, d)."""
    hidden_bias: np.ndarray
    """(h,)."""
    weights: np.ndarray
    """(classes, h)."""
    bias: np.ndarray
    """(classes,)."""
    classes: tuple[str, ...]
    names: tuple[str, ...]
    """Names and synonyms of objects."""
    name_vectors: np.ndarray
    """(names, d), unit length."""
    situation_vectors: np.ndarray
    """(situations, d), unit length, in the order of `situations.load_situations`."""
    decision: np.ndarray
    """(features + 1,) weights of `meaning.features`, and a bias: is it a request?"""

    def log_probabilities(self, vectors: np.ndarray) -> np.ndarray:
        """(n, classes) of (n, d) sentence vectors."""
        hidden = np.maximum(vectors @ self.hidden_weights.T + self.hidden_bias, 0)
        logits = hidden @ self.weights.T + self.bias
        return logits - np.logaddexp.reduce(logits, axis=1, keepdims=True)


@dataclass(frozen=True)
class ActionScores:
    """Probabilities of all actions for a clause."""

    ranked: tuple[tuple[str, float], ...]
    """(action, probability), best first."""
    no_action: float
    """Probability that the words mean none of them."""
    known_verb: bool
    """The lexicon has a phrase for these words."""
    particular: bool
    """It has one for more than the verb alone."""


@cache
def load_head() -> Head:
    """The trained head (`train/language.py`)."""
    with as_file(files("maniskill_taskgrasp.assets") / "checkpoints" / "language.npz") as path:
        return head_of(np.load(path))


def head_of(data: Mapping[str, np.ndarray]) -> Head:
    """The head from its stored arrays."""
    return Head(
        hidden_weights=data["hidden_weights"].astype(np.float32),
        hidden_bias=data["hidden_bias"],
        weights=data["weights"].astype(np.float32),
        bias=data["bias"],
        classes=tuple(data["classes"].tolist()),
        names=tuple(data["names"].tolist()),
        name_vectors=_unit(data["name_vectors"]),
        situation_vectors=_unit(data["situation_vectors"]),
        decision=data["decision"],
    )


def _unit(vectors: np.ndarray) -> np.ndarray:
    """(n, d) int8 rows as floats of length 1."""
    rows = vectors.astype(np.float32)
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def matching_phrases(
    clause: Clause, referents: frozenset[str] = frozenset()
) -> dict[str, tuple[int, float]]:
    """Action -> (specificity, -rank share) of its best phrase in the clause.

    Args:
        clause: what to match.
        referents: words for what its pronouns refer to.
    """
    found: dict[str, tuple[int, float]] = {}
    told = {w for r in clause.roles for w in r.text.split()}
    singular = {w[:-1] for w in told if w.endswith("s")}
    nouns = referents | frozenset(clause.words) | told | singular
    sizes = _list_sizes()
    for phrase in load_lexicon().phrases.get(clause.verb, ()):
        if matches(phrase, clause.words, nouns):
            key = (phrase.specificity, -phrase.rank / sizes[phrase.action])
            found[phrase.action] = max(found.get(phrase.action, (0, -1.0)), key)
    if clause.result is not None and clause.verb not in RESULTLESS:
        found[RESULTS[clause.result]] = (RESULT_SPECIFICITY, 0.0)
    return found


def phrase_bonus(found: dict[str, tuple[int, float]]) -> dict[str, float]:
    """Action -> log-odds from its best phrase; the most specific phrase counts most.

    "take off" beats "take", and "make a call" beats "make".
    """
    best = max((specificity for specificity, _ in found.values()), default=0)
    bonus = PARTICULAR_BONUS if best > 1 else PHRASE_BONUS
    odds = {}
    for action, (specificity, rank) in found.items():
        literal = rank == 0.0  # The first phrase of an action's list is its own name.
        full = bonus + RANK_DISCOUNT * rank
        vague = full - LITERAL_DISCOUNT if literal else VAGUE_BONUS
        odds[action] = full if specificity == best else vague
    return odds


def _tool_bonus(clause: Clause, action: str) -> float:
    """Log-odds for what people did with the named instrument: a vacuum says vacuuming."""
    tool = clause.role("instrument")
    if tool is None or tool.mention is None or action in GENERIC_ACTIONS:
        return 0.0
    done = load_knowledge().actions_of(tool.mention.objects[0][0])
    total = sum(done.values())  # 0 where all its rows were of the open palm, which is no topology.
    return TOOL_BONUS * done.get(action, 0) / total if total else 0.0


@cache
def _list_sizes() -> dict[str, int]:
    sizes: dict[str, int] = {}
    for phrases in load_lexicon().phrases.values():
        for phrase in phrases:
            sizes[phrase.action] = max(sizes.get(phrase.action, 1), phrase.rank + 1)
    return sizes


def meaning_logits(texts: list[str]) -> np.ndarray:
    """(n, classes) log-probabilities of the head for n texts.

    Raises:
        EncoderMissingError: the encoder is not installed.
    """
    return load_head().log_probabilities(load_encoder().encode(texts))


def _shares(counts: dict[str, float], classes: tuple[str, ...]) -> np.ndarray | None:
    """(classes,) counts as shares of their sum; None where nothing was counted."""
    values = np.array([counts.get(name, 0.0) for name in classes])
    return values / values.sum() if values.any() else None


def _verb_counts(clause: Clause) -> dict[str, float]:
    """How the lexicon uses the verb at all, with any particle or noun: typical phrases more."""
    counts: dict[str, float] = {}
    sizes = _list_sizes()
    for phrase in load_lexicon().phrases.get(clause.verb, ()):
        typical = 1.5 - phrase.rank / sizes[phrase.action]
        counts[phrase.action] = max(counts.get(phrase.action, 0.0), typical / phrase.specificity)
    return counts


def _object_counts(clause: Clause) -> dict[str, float]:
    """What people did with the objects that the clause names."""
    counts: dict[str, float] = {}
    for role in clause.roles:
        if role.mention is not None:
            for action, n in load_knowledge().actions_of(role.mention.objects[0][0]).items():
                counts[action] = counts.get(action, 0.0) + n
    return counts


def mix_readings(readings: dict[str, np.ndarray | None]) -> np.ndarray:
    """(classes,) weighted mean of the readings that there are.

    Args:
        readings: name (`READINGS`) -> (classes,) probabilities, or None.
    """
    given = {name: value for name, value in readings.items() if value is not None}
    total = sum(READINGS[name] for name in given)
    return np.sum([READINGS[name] / total * value for name, value in given.items()], axis=0)


def score_actions(
    clause: Clause, referents: frozenset[str] = frozenset(), said: str = ""
) -> ActionScores:
    """Probabilities of the actions for a clause; by the lexicon alone without the encoder.

    Args:
        clause: what to match.
        referents: words for what its pronouns refer to.
        said: the whole request around the clause.
    """
    found = matching_phrases(clause, referents)
    bonus = phrase_bonus(found)
    classes = (*load_knowledge().actions, HAND_OVER, NO_ACTION)
    whole = None
    try:
        other = said not in ("", clause.text) and len(said) <= LONGEST_SAID
        texts = [clause.text, said] if other else [clause.text]
        readings = meaning_logits(texts)
        logits, whole = TEMPER * readings[0], np.exp(readings[-1])
        classes = load_head().classes
    except EncoderMissingError:
        logits = np.zeros(len(classes))
    no_action = float(np.exp(logits[classes.index(NO_ACTION)] / TEMPER))
    logits = logits + np.array([bonus.get(name, 0.0) for name in classes])
    logits = logits + np.array([_tool_bonus(clause, name) for name in classes])
    probabilities = mix_readings(
        {
            "clause": np.exp(logits - np.logaddexp.reduce(logits)),
            "said": whole,
            "verb": _shares(_verb_counts(clause), classes),
            "objects": _shares(_object_counts(clause), classes),
        }
    )
    known = load_knowledge().actions
    order = [i for i in np.argsort(-probabilities) if classes[i] in known]
    ranked = tuple((classes[i], float(probabilities[i])) for i in order)
    particular = any(specificity > 1 for specificity, _ in found.values())
    return ActionScores(ranked, no_action, bool(found), particular)


def most_frequent_parameters(action: str) -> dict[str, str]:
    """The value of each task parameter that people's rows show most often for an action."""
    statistics = load_knowledge().actions[action].parameters
    return {name: max(statistics[name], key=statistics[name].__getitem__) for name in PARAMETERS}
