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
import tyro

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.actions import HAND_OVER, NO_ACTION
from maniskill_taskgrasp.language.encoder import load_encoder
from maniskill_taskgrasp.language.lexicon import TOOL_ACTIONS, Phrase, load_lexicon
from maniskill_taskgrasp.language.meaning import meanings_of
from maniskill_taskgrasp.language.objects import PHONING
from maniskill_taskgrasp.language.situations import load_situations
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
from maniskill_taskgrasp.train.language_decision import dev_features, dev_texts, with_bias

DEFAULT_OUT = Path(__file__).resolve().parent.parent / "assets" / "checkpoints" / "language.npz"


@dataclass(frozen=True, kw_only=True)
class LanguageConfig:
    """Train the action head of the language front end."""

    out: Path = DEFAULT_OUT
    """Where to write the npz file."""
    clauses: int = 1
    """Bare imperatives made of each phrase of the lexicon."""
    framed: int = 2
    """Whole instructions made of each (`train/instructions.py`)."""
    idle: int = 4000
    """Filled sentences of the class "no action of the table"."""
    transfers: int = 1500
    """Sentences of the class "an object to be handed over"."""
    told: int = 3
    """Sentences made of each situation."""
    weight_decay: float = 1e-5
    """L2 penalty on the head's weights."""
    steps: int = 25
    """L-BFGS iterations."""
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
    """Sentences and their actions, deduplicated in order."""
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
        pairs[pair] = None
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
) -> tuple[np.ndarray, np.ndarray]:
    """Softmax regression with inverse-square-root class weights.

    Args:
        vectors: (n, d) unit sentence vectors.
        labels: (n,) class of each.
        classes: number of classes.
        config: penalty and iterations.

    Returns:
        (classes, d) weights and (classes,) biases.
    """
    torch.manual_seed(config.seed)
    x = torch.tensor(vectors, dtype=torch.float64)
    y = torch.tensor(labels)
    counts = torch.bincount(y, minlength=classes).clamp(min=1).double()
    weights = torch.zeros(classes, x.shape[1], dtype=torch.float64, requires_grad=True)
    bias = torch.zeros(classes, dtype=torch.float64, requires_grad=True)
    solver = torch.optim.LBFGS(
        [weights, bias], max_iter=config.steps, line_search_fn="strong_wolfe"
    )
    sample_weights = counts.rsqrt()

    def closure() -> torch.Tensor:
        solver.zero_grad()
        logits = x @ weights.T + bias
        loss = torch.nn.functional.cross_entropy(logits, y, weight=sample_weights)
        loss = loss + config.weight_decay * weights.square().sum()
        loss.backward()
        return loss

    solver.step(closure)
    return weights.detach().numpy(), bias.detach().numpy()


def fit_decision(
    weights: np.ndarray, bias: np.ndarray, classes: list[str], config: LanguageConfig
) -> tuple[np.ndarray, float]:
    """Weights of `meaning.features` with their bias, and the share of dev requests they pass.

    Args:
        weights: (classes, d) of the head.
        bias: (classes,) of it.
        classes: their names.
        config: penalty and iterations.
    """
    texts, asked = dev_texts()
    vectors, situations = encode(texts), encode([s.said for s in load_situations()])
    meanings = meanings_of(vectors @ weights.T + bias, tuple(classes), vectors @ situations.T)
    given = dev_features(texts, meanings)
    two, _ = fit_head(given, asked.astype(np.int64), 2, config)
    decision = with_bias(two[1] - two[0], given, asked)
    passed = given[asked] @ decision[:-1] + decision[-1] > 0
    return decision, float(passed.mean())


def encode(texts: list[str]) -> np.ndarray:
    """(n, d) vectors, in batches of similar length."""
    encoder = load_encoder()
    order = sorted(range(len(texts)), key=lambda i: len(texts[i]))
    out = np.zeros((len(texts), encoder.encode(["a"]).shape[1]), np.float32)
    for start in range(0, len(order), 64):
        batch = order[start : start + 64]
        out[batch] = encoder.encode([texts[i] for i in batch])
    return out


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
    weights, bias = fit_head(vectors, labels, len(classes), config)
    decision, passed = fit_decision(weights, bias, classes, config)
    fitted = float(((vectors @ weights.T + bias).argmax(1) == labels).mean())
    object_names = sorted(load_lexicon().names)
    save_atomically(
        config.out,
        {
            "weights": weights.astype(np.float16),
            "bias": bias.astype(np.float32),
            "classes": np.array(classes),
            "decision": decision,
            "names": np.array(object_names),
            "name_vectors": quantised(encode(object_names)),
            "situation_vectors": quantised(encode([s.said for s in load_situations()])),
        },
    )
    return {
        "sentences": len(texts),
        "classes": len(classes),
        "fitted_top1": round(fitted, 3),
        "dev_requests_passed": round(passed, 3),
        "config": {k: str(v) for k, v in asdict(config).items() if k != "out"},
    }


if __name__ == "__main__":
    print(json.dumps(train(tyro.cli(LanguageConfig)), indent=2))
