"""Train the action head of the language front end on sentences made from the table.

python train/language.py

Every sentence of the head is filled from `assets/knowledge.json` and the front end's own lexicon.
How sure it must be where the grammar finds no request (`language/meaning.py`) is learned on the
dev instructions; no other set is read. The result is one npz file: the head (74 actions, "an
object to be handed over", "no action of the table"), that decision, and the vectors of the object
names and situations. Same seed, same file.
"""

from __future__ import annotations

import json
import random
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.actions import HAND_OVER, NO_ACTION, head_of
from maniskill_taskgrasp.language.encoder import load_encoder
from maniskill_taskgrasp.language.lexicon import TOOL_ACTIONS, Phrase, load_lexicon
from maniskill_taskgrasp.language.objects import PHONING
from maniskill_taskgrasp.language.situations import load_situations
from maniskill_taskgrasp.language.text import clean
from maniskill_taskgrasp.language.verbs import base_of
from maniskill_taskgrasp.train.instructions import (
    PEOPLE,
    TARGETS,
    fill_frame,
    fill_idle_frame,
    fill_situation,
    fill_transfer,
    frames,
)
from maniskill_taskgrasp.train.language_decision import fit_decision
from maniskill_taskgrasp.train.script import run_script

DEFAULT_OUT = Path(__file__).resolve().parent.parent / "assets" / "checkpoints" / "language.npz"


RARE = 50  # Sentences of a class below which it weighs no more: "hoding towel" has few.


@dataclass(frozen=True, kw_only=True)
class LanguageConfig:
    """Train the action head of the language front end."""

    out: Path = DEFAULT_OUT
    """Where to write the npz file."""
    clauses: int = 1
    """Bare imperatives made of each phrase of the lexicon."""
    framed: int = 2
    """Whole instructions made of each (`train/instructions.py`)."""
    idle: int = 4500
    """Filled sentences of the class "no action of the table"."""
    transfers: int = 2000
    """Sentences of the class "an object to be handed over"."""
    told: int = 3
    """Sentences made of each situation."""
    hidden: int = 512
    """Units of the hidden layer."""
    dropout: float = 0.5
    """Share of them that is left out at each step."""
    epochs: int = 12
    """Passes over the sentences."""
    batch: int = 256
    """Sentences of a step."""
    rate: float = 2e-3
    """Highest learning rate of AdamW."""
    weight_decay: float = 0.05
    """Its weight decay."""
    smoothing: float = 0.05
    """Share of a label that is spread over all classes."""
    seed: int = 0
    """Seed of the sentence generator."""


def objects_of(action: str) -> list[str]:
    """Objects that people used for the action, most frequent first."""
    counts = {o: sum(n) for (o, a), n in load_knowledge().pair_counts.items() if a == action}
    return sorted(counts, key=lambda name: (-counts[name], name))


def annotator_phrases(action: str) -> list[str]:
    """The table's task phrases as imperatives: "wiping counter" -> "wipe counter"."""
    imperatives = []
    for text in load_knowledge().actions[action].phrases:
        first, _, rest = text.partition(" ")
        base = base_of(first)
        if base is not None:
            imperatives.append(f"{base} {rest}".strip())
    return imperatives


def fill(phrase: Phrase, rng: random.Random) -> str:
    """One imperative from a phrase of the lexicon."""
    all_names = sorted(load_knowledge().objects)
    used = objects_of(phrase.action)
    held = rng.choice(used) if used and rng.random() < 0.7 else rng.choice(all_names)
    target = rng.choice(PEOPLE if phrase.action in PHONING else TARGETS)
    noun = rng.choice(sorted(phrase.nouns)) if phrase.nouns else ""
    verb = phrase.text
    tool = phrase.action in TOOL_ACTIONS
    if noun:
        with_tool = [f"{verb} the {noun} with the {held}"] if tool else []
        return rng.choice([f"{verb} {noun}", f"{verb} the {noun}", f"{verb} a {noun}", *with_tool])
    split = f"{phrase.verb} the {held} {' '.join(phrase.words)}".strip()
    forms = [verb, f"{verb} it", f"{verb} the {held}", f"{verb} the {held}", split]
    if tool:
        forms += [f"{verb} the {target} with the {held}", f"{verb} with the {held}"]
        forms += [f"{verb} the {target}", f"{verb} my {target} with the {held}"]
    else:
        forms += [f"{verb} this {held}", f"{verb} the {held} on the {target}"]
    return rng.choice(forms)


def make_sentences(config: LanguageConfig) -> tuple[list[str], list[str]]:
    """Sentences, cleaned as the front end cleans them, and their actions; no pair twice."""
    phrases = [phrase for found in load_lexicon().phrases.values() for phrase in found]
    rng = random.Random(config.seed)
    pairs: dict[tuple[str, str], None] = {}
    for pair in (
        *_phrase_sentences(phrases, config),
        *_table_sentences(),
        *_situation_sentences(config, rng),
        *((fill_transfer(rng), HAND_OVER) for _ in range(config.transfers)),
        *((text, NO_ACTION) for text in frames("chatter")),
        *((fill_idle_frame(rng.choice(phrases), rng), NO_ACTION) for _ in range(config.idle)),
    ):
        pairs[clean(pair[0]), pair[1]] = None
    return [text for text, _ in pairs], [action for _, action in pairs]


def _phrase_sentences(phrases: list[Phrase], config: LanguageConfig) -> Iterator[tuple[str, str]]:
    for phrase in phrases:
        rng = random.Random(f"{config.seed} {phrase.action} {phrase.text} {sorted(phrase.nouns)}")
        for _ in range(config.clauses):
            yield fill(phrase, rng), phrase.action
        for _ in range(config.framed):
            yield fill_frame(phrase, rng.choice(phrases), rng), phrase.action


def _table_sentences() -> Iterator[tuple[str, str]]:
    for action in load_knowledge().actions:
        for text in annotator_phrases(action):
            yield text, action
            for name in objects_of(action)[:4]:
                yield f"{text} with the {name}", action


def _situation_sentences(config: LanguageConfig, rng: random.Random) -> Iterator[tuple[str, str]]:
    for situation in load_situations():
        yield situation.said, situation.action
        for _ in range(config.told):
            yield fill_situation(situation.said, rng), situation.action


def fit_head(
    vectors: np.ndarray, labels: np.ndarray, classes: int, config: LanguageConfig
) -> dict[str, np.ndarray]:
    """One hidden layer and a softmax, with inverse-square-root class weights.

    Args:
        vectors: (n, d) unit sentence vectors.
        labels: (n,) class of each.
        classes: number of classes.
        config: size, regularisation and steps.

    Returns:
        The arrays of `Head` from hidden_weights to bias, as they are stored.
    """
    torch.manual_seed(config.seed)
    scale = vectors.shape[1] ** 0.5  # Components of about unit variance suit the learning rate.
    x, y = torch.tensor(scale * vectors), torch.tensor(labels)
    first = torch.nn.Linear(x.shape[1], config.hidden)
    last = torch.nn.Linear(config.hidden, classes)
    drop = torch.nn.Dropout(config.dropout)
    weights = torch.bincount(y, minlength=classes).clamp(min=RARE).float().rsqrt()
    parameters = [*first.parameters(), *last.parameters()]
    solver = torch.optim.AdamW(parameters, lr=config.rate, weight_decay=config.weight_decay)
    batches = len(y) // config.batch
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        solver, config.rate, total_steps=config.epochs * batches
    )
    for _ in range(config.epochs):
        for rows in torch.randperm(len(y))[: batches * config.batch].split(config.batch):
            logits = last(drop(torch.relu(first(x[rows]))))
            loss = torch.nn.functional.cross_entropy(
                logits, y[rows], weight=weights, label_smoothing=config.smoothing
            )
            solver.zero_grad()
            loss.backward()
            solver.step()
            schedule.step()
    return {
        "hidden_weights": (scale * first.weight).detach().numpy().astype(np.float16),
        "hidden_bias": first.bias.detach().numpy(),
        "weights": last.weight.detach().numpy().astype(np.float16),
        "bias": last.bias.detach().numpy(),
    }


def encode(texts: list[str]) -> np.ndarray:
    """(n, d) vectors."""
    return load_encoder().encode(texts)


def quantised(vectors: np.ndarray) -> np.ndarray:
    """(n, d) vectors as int8; their direction is kept to a fraction of a degree."""
    return np.rint(vectors * (127 / np.abs(vectors).max(axis=1, keepdims=True))).astype(np.int8)


def save_atomically(path: Path, arrays: dict[str, np.ndarray]) -> None:
    """Write an npz file that is either whole or absent."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".npz", delete=False) as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
    Path(file.name).chmod(0o644)
    Path(file.name).replace(path)


def train(config: LanguageConfig) -> dict[str, object]:
    """Make the sentences, fit the head, write the file; returns what the card states."""
    torch.set_num_threads(1)
    texts, names = make_sentences(config)
    classes = [*load_knowledge().actions, HAND_OVER, NO_ACTION]
    labels = np.array([classes.index(name) for name in names])
    vectors = encode(texts)
    object_names = sorted(load_lexicon().names)
    arrays = {
        **fit_head(vectors, labels, len(classes), config),
        "classes": np.array(classes),
        "names": np.array(object_names),
        "name_vectors": quantised(encode(object_names)),
        "situation_vectors": quantised(encode([s.said for s in load_situations()])),
    }
    head = head_of({**arrays, "decision": np.zeros(1)})
    arrays["decision"], passed = fit_decision(head)
    save_atomically(config.out, arrays)
    fitted = head.log_probabilities(vectors).argmax(1) == labels
    return {
        "sentences": len(texts),
        "classes": len(classes),
        "fitted_top1": round(float(fitted.mean()), 3),
        "dev_requests_passed": round(passed, 3),
        "config": {k: str(v) for k, v in asdict(config).items() if k != "out"},
    }


if __name__ == "__main__":
    run_script(lambda config: print(json.dumps(train(config), indent=2)), LanguageConfig)
