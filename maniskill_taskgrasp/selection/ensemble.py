"""The perceptrons' forward pass: an ensemble of small networks in numpy, averaged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.selection.features import (
    ACTION_DIRECTIONS,
    OBJECT_DIRECTIONS,
    Described,
    Directions,
)

CLIP = 5.0
"""Standardised inputs are clipped here, so that an odd size cannot run off the training data."""


@dataclass(frozen=True, eq=False)
class InputLayout:
    """Described pairs -> one input vector each."""

    object_directions: Directions
    action_directions: Directions

    @classmethod
    def fit(cls, pairs: Described) -> InputLayout:
        """Directions of the training names, each name counted once."""

        def directions(vectors: np.ndarray, names: np.ndarray, width: int) -> Directions:
            return Directions.fit(vectors[np.unique(names, return_index=True)[1]], width)

        return cls(
            directions(pairs.object_vectors, pairs.objects, OBJECT_DIRECTIONS),
            directions(pairs.action_vectors, pairs.actions, ACTION_DIRECTIONS),
        )

    def __call__(self, pairs: Described) -> np.ndarray:
        """(n, width): sizes, classes, object name, action name."""
        return np.hstack(
            [
                pairs.sizes,
                pairs.classes,
                self.object_directions(pairs.object_vectors),
                self.action_directions(pairs.action_vectors),
            ]
        )

    @property
    def object_name(self) -> slice:
        """Where the object's name lies in the input vector."""
        end = -self.action_directions.basis.shape[1]
        return slice(end - self.object_directions.basis.shape[1], end)


@dataclass(frozen=True, eq=False)
class Ensemble:
    """`members` networks of the same shape: dense, SiLU, ..., dense, softmax; their mean."""

    layout: InputLayout
    mean: np.ndarray
    """(width,) of the training inputs."""
    scale: np.ndarray
    """(width,) their standard deviation, 1 where they do not vary."""
    weights: tuple[np.ndarray, ...]
    """Per layer (members, inputs, outputs)."""
    biases: tuple[np.ndarray, ...]
    """Per layer (members, 1, outputs)."""

    def predict(self, pairs: Described) -> np.ndarray:
        """(n, 15) probabilities."""
        hidden = standardised(self.layout(pairs), self.mean, self.scale)[None]
        for layer, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            hidden = hidden @ weight + bias
            if layer < len(self.weights) - 1:
                hidden = hidden / (1 + np.exp(-hidden))
        return softmax(hidden).mean(0)


def standardised(inputs: np.ndarray, mean: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """(n, width) float32, clipped."""
    return np.clip((inputs - mean) / scale, -CLIP, CLIP).astype(np.float32)


def softmax(logits: np.ndarray) -> np.ndarray:
    """Along the last axis, in float64."""
    shifted = np.exp(logits.astype(float) - logits.max(-1, keepdims=True))
    return shifted / shifted.sum(-1, keepdims=True)


def tempered(probabilities: np.ndarray, temperature: float) -> np.ndarray:
    """(n, 15) distributions raised to 1 / temperature: above 1 flattens, below 1 sharpens."""
    return softmax(np.log(np.maximum(probabilities, 1e-12)) / temperature)
