"""How the ensemble is trained: soft targets of pairs, all members at once, no held-out peeking."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.selection.ensemble import CLIP, Ensemble

if TYPE_CHECKING:
    import torch


@dataclass(frozen=True, kw_only=True)
class EnsembleConfig:
    """Shape and training of the ensemble."""

    members: int = 16
    hidden: tuple[int, ...] = (128, 64)
    steps: int = 300
    """Full-batch updates."""
    learning_rate: float = 3e-3
    weight_decay: float = 1e-2
    dropout: float = 0.3
    """Share of hidden units dropped."""
    input_dropout: float = 0.1
    """Share of single inputs dropped."""
    blank_object_name: float = 0.1
    blank_action_name: float = 0.0
    blank_parameters: float = 0.5
    """How often a whole part is blanked in training, so that the network copes without it."""
    row_power: float = 0.5
    """A pair seen n times weighs n ** row_power: 1 counts rows, 0 counts pairs."""
    seed: int = 0


def fit_ensemble(
    features: np.ndarray, counts: np.ndarray, blocks: dict[str, slice], config: EnsembleConfig
) -> Ensemble:
    """Train on groups of rows that share their input.

    Args:
        features: (groups, width) raw features.
        counts: (groups, 15) rows of each topology.
        blocks: where the parts of a feature vector lie (`FeatureEncoder.blocks`).
        config: shape, length and seed; the same config gives the same weights on one machine.
    """
    import torch
    import torch.nn.functional as F

    generator = torch.Generator().manual_seed(config.seed)
    mean, scale = features.mean(0), features.std(0)
    scale[scale < 1e-6] = 1.0

    def standardised(raw: np.ndarray) -> torch.Tensor:
        return torch.from_numpy(np.clip((raw - mean) / scale, -CLIP, CLIP).astype(np.float32))

    inputs, blank = standardised(features), standardised(np.zeros_like(mean))
    rows = torch.from_numpy(counts.sum(1)).float()
    targets = torch.from_numpy(counts).float() / rows[:, None]
    weight_of_pair = rows**config.row_power
    weight_of_pair /= weight_of_pair.mean()
    weights, biases = _initial(inputs.shape[1], counts.shape[1], config, generator)

    def blanked(values: torch.Tensor) -> torch.Tensor:
        values = values.clone()
        for name in ("object_name", "action_name", "parameters"):
            share, part = getattr(config, f"blank_{name}"), blocks[name]
            hidden_here = torch.rand(values.shape[:2], generator=generator) < share
            values[..., part] = torch.where(hidden_here[..., None], blank[part], values[..., part])
        return values

    def dropped(values: torch.Tensor, share: float) -> torch.Tensor:
        kept = torch.rand(values.shape, generator=generator) >= share
        return values * kept / (1 - share)

    optimiser = torch.optim.AdamW(
        [*weights, *biases], lr=config.learning_rate, weight_decay=config.weight_decay
    )
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, config.steps)
    for _ in range(config.steps):
        hidden = dropped(blanked(inputs.expand(config.members, -1, -1)), config.input_dropout)
        for layer, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
            hidden = torch.baddbmm(bias, hidden, weight)
            if layer < len(weights) - 1:
                hidden = dropped(F.silu(hidden), config.dropout)
        # A fresh exponential weight per pair and step (Bayesian bootstrap) decorrelates members.
        bootstrap = torch.empty(config.members, len(inputs)).exponential_(1, generator=generator)
        nll = -(targets * hidden.log_softmax(-1)).sum(-1)
        loss = (bootstrap * weight_of_pair * nll).mean(1).sum()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
    return Ensemble(
        mean=mean,
        scale=scale,
        weights=tuple(weight.detach().numpy() for weight in weights),
        biases=tuple(bias.detach().numpy() for bias in biases),
    )


def _initial(inputs: int, outputs: int, config: EnsembleConfig, generator):
    """He-initialised weights and zero biases of every layer and member, as leaf tensors."""
    import torch

    sizes = (inputs, *config.hidden, outputs)
    weights, biases = [], []
    for fan_in, fan_out in pairwise(sizes):
        draw = torch.randn(config.members, fan_in, fan_out, generator=generator)
        weights.append((draw * (2 / fan_in) ** 0.5).requires_grad_())
        biases.append(torch.zeros(config.members, 1, fan_out, requires_grad=True))
    return weights, biases
