"""How the perceptrons are trained: soft targets of pairs, all members at once."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from maniskill_taskgrasp.selection.ensemble import Ensemble, InputLayout, standardised
from maniskill_taskgrasp.selection.features import Described

if TYPE_CHECKING:
    import torch


@dataclass(frozen=True, kw_only=True)
class EnsembleConfig:
    """Shape and training of the perceptrons."""

    members: int = 8
    hidden: tuple[int, ...] = (128, 64)
    steps: int = 120
    """Full-batch updates."""
    learning_rate: float = 3e-3
    weight_decay: float = 1e-2
    dropout: float = 0.3
    """Share of hidden units dropped."""
    input_dropout: float = 0.1
    """Share of single inputs dropped."""
    blank_object_name: float = 0.1
    """How often an object's name is blanked, so that the network copes with an unknown one."""
    row_power: float = 0.5
    """A pair seen n times weighs n ** row_power: 1 counts rows, 0 counts pairs."""
    seed: int = 0


def fit_ensemble(pairs: Described, counts: np.ndarray, config: EnsembleConfig) -> Ensemble:
    """Train on n (object, action) pairs.

    Args:
        pairs: the training pairs.
        counts: (n, 15) rows of each topology.
        config: shape, length and seed; the same config gives the same weights on one machine.
    """
    import torch
    import torch.nn.functional as F

    layout = InputLayout.fit(pairs)
    raw = layout(pairs)
    mean, scale = raw.mean(0), raw.std(0)
    scale[scale < 1e-6] = 1.0
    inputs = torch.from_numpy(standardised(raw, mean, scale))
    blank = torch.from_numpy(standardised(np.zeros_like(mean), mean, scale))[layout.object_name]
    rows = torch.from_numpy(counts.sum(1)).float()
    targets = torch.from_numpy(counts).float() / rows[:, None]
    weight_of_pair = rows**config.row_power
    weight_of_pair /= weight_of_pair.mean()
    generator = torch.Generator().manual_seed(config.seed)
    weights, biases = _initial(inputs.shape[1], counts.shape[1], config, generator)

    def dropped(values: torch.Tensor, share: float) -> torch.Tensor:
        kept = torch.rand(values.shape, generator=generator) >= share
        return values * kept / (1 - share)

    def corrupted() -> torch.Tensor:
        values = inputs.repeat(config.members, 1, 1)
        nameless = torch.rand(values.shape[:2], generator=generator) < config.blank_object_name
        part = values[..., layout.object_name]
        values[..., layout.object_name] = torch.where(nameless[..., None], blank, part)
        return dropped(values, config.input_dropout)

    optimiser = torch.optim.AdamW(
        [*weights, *biases], lr=config.learning_rate, weight_decay=config.weight_decay
    )
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, config.steps)
    for _ in range(config.steps):
        hidden = corrupted()
        for layer, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
            hidden = torch.baddbmm(bias, hidden, weight)
            if layer < len(weights) - 1:
                hidden = dropped(F.silu(hidden), config.dropout)
        # A fresh exponential weight per pair and step (Bayesian bootstrap) decorrelates members.
        bootstrap = torch.empty(config.members, len(inputs)).exponential_(1, generator=generator)
        log_loss = -(targets * hidden.log_softmax(-1)).sum(-1)
        loss = (bootstrap * weight_of_pair * log_loss).mean(1).sum()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
    return Ensemble(
        layout=layout,
        mean=mean,
        scale=scale,
        weights=tuple(weight.detach().numpy() for weight in weights),
        biases=tuple(bias.detach().numpy() for bias in biases),
    )


def _initial(
    inputs: int, outputs: int, config: EnsembleConfig, generator: torch.Generator
) -> tuple[list[torch.Tensor], list[torch.Tensor]]:
    """He-initialised weights and zero biases of every layer and member, as leaf tensors."""
    import torch

    weights, biases = [], []
    for fan_in, fan_out in pairwise((inputs, *config.hidden, outputs)):
        draw = torch.randn(config.members, fan_in, fan_out, generator=generator)
        weights.append((draw * (2 / fan_in) ** 0.5).requires_grad_())
        biases.append(torch.zeros(config.members, 1, fan_out, requires_grad=True))
    return weights, biases
