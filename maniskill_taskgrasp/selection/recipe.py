"""What our model is made of and how its parts are trained."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from maniskill_taskgrasp.selection.dataset import GraspTable
from maniskill_taskgrasp.selection.evidence import condense, fit_describer
from maniskill_taskgrasp.selection.features import Described
from maniskill_taskgrasp.selection.fit import EnsembleConfig, fit_ensemble
from maniskill_taskgrasp.selection.kernel import KernelConfig
from maniskill_taskgrasp.selection.kernel_fit import fit_kernel_network
from maniskill_taskgrasp.selection.mixture import Mixture
from maniskill_taskgrasp.selection.selector import Selector

WIDE = KernelConfig(action_variance=0.5, pair_variance=0.5, size_scale=3.0, row_power=0.7)
"""A second prior: wider over sizes, weaker effects of the action, nearer to counting rows."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """What is averaged, in which shares, and how sure the answer is made."""

    kernels: tuple[KernelConfig, ...] = (KernelConfig(), WIDE)
    perceptrons: EnsembleConfig = field(default_factory=EnsembleConfig)
    share: float = 0.5
    """Share of the perceptrons in the average; the rest is the kernel networks'."""
    temperature: float = 1.0
    """Above 1 flattens the average, below 1 sharpens it."""
    shrink: float = 3.0
    """Rows that the networks' opinion is worth beside human evidence of the same pair."""


def fit_mixture(pairs: Described, counts: np.ndarray, recipe: Recipe) -> Mixture:
    """Train every part on n pairs with their topology counts (n, 15)."""
    return Mixture(
        kernels=tuple(fit_kernel_network(pairs, counts, config) for config in recipe.kernels),
        perceptrons=fit_ensemble(pairs, counts, recipe.perceptrons),
        share=recipe.share,
        temperature=recipe.temperature,
    )


def fit_selector(table: GraspTable, recipe: Recipe) -> Selector:
    """Train the recipe on all rows of a table without platform."""
    evidence = condense(table)
    describer = fit_describer(table)
    mixture = fit_mixture(describer(evidence.pairs), evidence.counts, recipe)
    seen = dict(zip(evidence.keys, evidence.counts, strict=True))
    return Selector(describer, mixture, seen, recipe.shrink)
