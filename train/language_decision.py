"""How sure the head must be of a request that the grammar does not show: learned on `dev`.

The dev instructions of one segment, whole, are asked for or not; a logistic regression weighs what
`maniskill_taskgrasp.language.meaning.features` gives, and its bias is set so that at most
`PASSING` of what asks for nothing passes.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.language.actions import LONGEST_SAID, Head
from maniskill_taskgrasp.language.encoder import load_encoder
from maniskill_taskgrasp.language.lexicon import SYNONYM_SCORE
from maniskill_taskgrasp.language.meaning import Meaning, features, meanings_of
from maniskill_taskgrasp.language.spelling import correct
from maniskill_taskgrasp.language.text import clean
from maniskill_taskgrasp.language.understand import read_segments

DEV = Path(__file__).resolve().parent.parent / "tests" / "data" / "instructions_dev.jsonl"
PENALTY = 1.0  # L2 penalty of the regression.
STEPS = 12  # Newton's steps; it converges in half of them.
PASSING = 0.12  # Share of the dev texts that ask for nothing which may be taken for requests.
IDLE = ("offtopic",)
"""Phenomena that ask for nothing; bans and contradictions are left to the grammar."""
UNSHOWN = ("implicit", "question", "transfer")
"""Phenomena whose requests the grammar may not show."""


def dev_texts() -> tuple[list[str], np.ndarray]:
    """Cleaned dev texts, and (n,) whether each asks for something."""
    texts, asked = [], []
    for row in map(json.loads, DEV.read_text("utf-8").splitlines()):
        if row["phenomenon"] not in (IDLE if row.get("rejected") else UNSHOWN):
            continue
        text = correct(clean(row["text"]))[0]
        if text and len(text) <= LONGEST_SAID:
            texts.append(text)
            asked.append(not row.get("rejected"))
    return texts, np.array(asked)


def dev_features(texts: list[str], meanings: list[Meaning]) -> np.ndarray:
    """(n, features) of texts, each by its first segment."""
    rows = []
    for text, meaning in zip(texts, meanings, strict=True):
        segments, docs = read_segments(text)
        mentions = tuple(m for m in docs[0]._.mentions if m.objects[0][1] >= SYNONYM_SCORE)
        rows.append(features(meaning, segments[0], docs[0], mentions))
    return np.array(rows)


def fit_decision(head: Head) -> tuple[np.ndarray, float]:
    """Weights of `meaning.features` with their bias, and the share of dev requests they pass.

    A logistic regression with a small L2 penalty, its features scaled, by Newton's steps.
    """
    texts, asked = dev_texts()
    given = dev_features(texts, meanings_of(load_encoder().encode(texts), head))
    mean, spread = given.mean(0), given.std(0) + 1e-6
    x = np.column_stack([(given - mean) / spread, np.ones(len(given))])
    weights = np.zeros(x.shape[1])
    penalty = np.diag([PENALTY] * (len(weights) - 1) + [0.0])
    for _ in range(STEPS):
        shares = 1 / (1 + np.exp(-x @ weights))
        curvature = (x * (shares * (1 - shares))[:, None]).T @ x + penalty
        weights += np.linalg.solve(curvature, x.T @ (asked - shares) - penalty @ weights)
    decision = with_bias(weights[:-1] / spread, given, asked)
    passed = given[asked] @ decision[:-1] + decision[-1] > 0
    return decision, float(passed.mean())


def with_bias(weights: np.ndarray, given: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """(features + 1,) weights and the bias that lets `PASSING` of the idle texts through.

    Args:
        weights: (features,) of the logistic regression.
        given: (n, features).
        asked: (n,) whether each text asks for something.
    """
    idle = np.sort(given[~asked] @ weights)
    bias = -float(np.quantile(idle, 1 - PASSING))
    return np.array([*weights, bias], np.float32)
