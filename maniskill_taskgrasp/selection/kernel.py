"""The kernel network: a pair is judged by the pairs it resembles, in object, in action, in both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.selection.ensemble import softmax
from maniskill_taskgrasp.selection.features import CATEGORIES, Described

OWN_SHARE = 0.3
"""Part of an object's (action's) effect that it shares with no other, however similar."""


@dataclass(frozen=True, kw_only=True)
class KernelConfig:
    """Prior of the kernel network: how much each effect matters and how far it reaches."""

    object_variance: float = 2.0
    """Variance of the logits' object effect; an object alike in size, class and name shares it."""
    action_variance: float = 1.0
    pair_variance: float = 1.0
    """Variance of the effect of one object with one action, shared by like pairs."""
    size_scale: float = 2.0
    """Reach over log sizes and log mass, in standard deviations."""
    class_scale: float = 1.0
    """Reach over the share of the five classes that differ."""
    name_scale: float = 0.5
    """Reach over one minus the cosine of the names' sentence vectors."""
    row_power: float = 0.5
    """A pair seen n times weighs n ** row_power in training."""


def kernel(left: Described, right: Described, config: KernelConfig) -> np.ndarray:
    """(n, m) prior covariance of the logits of two lists of pairs.

    k = 1 + v_o (K_o + own) + v_a (K_a + own) + v_oa K_o K_a: a common part, one part per object,
    one per action, one per combination; K_o averages likeness of measurements and of names.
    """
    size_gap = _squared_distances(left.sizes, right.sizes)
    differing = 1 - left.classes @ right.classes.T / len(CATEGORIES)
    measured = np.exp(-size_gap / (2 * config.size_scale**2) - differing / config.class_scale)
    named = _likeness(left.object_vectors, right.object_vectors, config.name_scale)
    obj = (measured + named) / 2
    action = _likeness(left.action_vectors, right.action_vectors, config.name_scale)
    same_object = left.objects[:, None] == right.objects
    same_action = left.actions[:, None] == right.actions
    return (
        1
        + config.object_variance * (obj + OWN_SHARE * same_object)
        + config.action_variance * (action + OWN_SHARE * same_action)
        + config.pair_variance * obj * action
    )


def _squared_distances(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    squares = (left**2).sum(1)[:, None] + (right**2).sum(1) - 2 * left @ right.T
    return np.maximum(squares, 0)


def _likeness(left: np.ndarray, right: np.ndarray, scale: float) -> np.ndarray:
    return np.exp((left @ right.T - 1) / scale)


@dataclass(frozen=True, eq=False)
class KernelNetwork:
    """One hidden unit per training pair: logits = kernel @ coefficients + bias."""

    config: KernelConfig
    centres: Described
    """The training pairs."""
    coefficients: np.ndarray
    """(pairs, 15)"""
    bias: np.ndarray
    """(15,)"""

    def predict(self, pairs: Described) -> np.ndarray:
        """(n, 15) probabilities."""
        return softmax(kernel(pairs, self.centres, self.config) @ self.coefficients + self.bias)
