"""How sure the head must be of a request that the grammar does not show: learned on `dev`.

The dev instructions of one segment, whole, are asked for or not; a logistic regression weighs what
`maniskill_taskgrasp.language.meaning.features` gives, and its bias is set so that at most
`PASSING` of what asks for nothing passes.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.language.actions import LONGEST_SAID
from maniskill_taskgrasp.language.lexicon import SYNONYM_SCORE
from maniskill_taskgrasp.language.meaning import Meaning, features
from maniskill_taskgrasp.language.spelling import correct
from maniskill_taskgrasp.language.text import clean
from maniskill_taskgrasp.language.understand import read_segments

DEV = Path(__file__).resolve().parent.parent / "tests" / "data" / "instructions_dev.jsonl"
PASSING = 0.06  # Share of the dev texts that ask for nothing which may be taken for requests.
IDLE = ("offtopic",)
"""Phenomena that ask for nothing; bans and contradictions are left to the grammar."""


def dev_texts() -> tuple[list[str], np.ndarray]:
    """Cleaned dev texts, and (n,) whether each asks for something."""
    texts, asked = [], []
    for row in map(json.loads, DEV.read_text("utf-8").splitlines()):
        if row.get("rejected") and row["phenomenon"] not in IDLE:
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
