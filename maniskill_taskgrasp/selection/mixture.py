"""Our model: kernel networks and perceptrons averaged, calibrated, and anchored in evidence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.selection.ensemble import Ensemble, tempered
from maniskill_taskgrasp.selection.features import Described
from maniskill_taskgrasp.selection.kernel import KernelNetwork


@dataclass(frozen=True, eq=False)
class Mixture:
    """The fitted networks and how they are averaged."""

    kernels: tuple[KernelNetwork, ...]
    perceptrons: Ensemble
    share: float
    """Share of the perceptrons in the average; the rest is the kernel networks'."""
    temperature: float
    """Above 1 flattens the average, below 1 sharpens it."""

    def parts(self, pairs: Described) -> tuple[np.ndarray, np.ndarray]:
        """Distributions (n, 15) of the kernel networks' mean and of the perceptrons."""
        kernels = np.mean([network.predict(pairs) for network in self.kernels], axis=0)
        return kernels, self.perceptrons.predict(pairs)

    def predict(self, pairs: Described) -> np.ndarray:
        """(n, 15) probabilities."""
        return blend(*self.parts(pairs), self.share, self.temperature)


def blend(
    kernels: np.ndarray, perceptrons: np.ndarray, share: float, temperature: float
) -> np.ndarray:
    """(n, 15) weighted mean of two lists of distributions, tempered."""
    return tempered((1 - share) * kernels + share * perceptrons, temperature)


def shrunk(counts: np.ndarray, model: np.ndarray, strength: float) -> np.ndarray:
    """What people did, shrunk towards what the model expects: (n_k + a P_k) / (n + a).

    Args:
        counts: (n, 15) rows of each topology; zeros where a pair was never seen.
        model: (n, 15) the model's distributions.
        strength: a, the number of rows that the model's opinion is worth.
    """
    return (counts + strength * model) / (counts.sum(-1, keepdims=True) + strength)
