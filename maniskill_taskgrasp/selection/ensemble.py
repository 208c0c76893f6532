"""The network's forward pass: an ensemble of small perceptrons in numpy, averaged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

CLIP = 5.0
"""Standardised inputs are clipped here, so that an odd size cannot run off the training data."""


@dataclass(frozen=True, eq=False)
class Ensemble:
    """`members` networks of the same shape: dense, SiLU, ..., dense, softmax; mean; temperature."""

    mean: np.ndarray
    """(width,) of the training inputs."""
    scale: np.ndarray
    """(width,) their standard deviation, 1 where they do not vary."""
    weights: tuple[np.ndarray, ...]
    """Per layer (members, inputs, outputs)."""
    biases: tuple[np.ndarray, ...]
    """Per layer (members, 1, outputs)."""
    temperature: float = 1.0
    """The averaged distribution is raised to 1 / temperature and renormalised."""

    def standardise(self, features: np.ndarray) -> np.ndarray:
        """(n, width) raw features -> the network's input."""
        return np.clip((features - self.mean) / self.scale, -CLIP, CLIP).astype(np.float32)

    def predict(self, features: np.ndarray) -> np.ndarray:
        """(n, width) raw features -> (n, 15) probabilities."""
        hidden = self.standardise(features)[None]
        for layer, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            hidden = hidden @ weight + bias
            if layer < len(self.weights) - 1:
                hidden = hidden / (1 + np.exp(-hidden))
        return tempered(softmax(hidden).mean(0), self.temperature)


def softmax(logits: np.ndarray) -> np.ndarray:
    """Along the last axis, in float64."""
    shifted = np.exp(logits.astype(float) - logits.max(-1, keepdims=True))
    return shifted / shifted.sum(-1, keepdims=True)


def tempered(probabilities: np.ndarray, temperature: float) -> np.ndarray:
    """(n, 15) distributions raised to 1 / temperature: above 1 flattens, below 1 sharpens."""
    return softmax(np.log(np.maximum(probabilities, 1e-12)) / temperature)
