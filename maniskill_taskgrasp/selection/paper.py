"""The paper's network, as published: three heads on 127 inputs, noise copies, sigmoid topologies.

Li et al. 2021: 127 -> 2048 -> 256 shared; 64 -> 15 sigmoid, 3 softmax, 3 softmax; Adam 1e-3, batch
64, 5,000 epochs, Gaussian noise on the continuous inputs to 136,627 rows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.selection.dataset import NUM_TOPOLOGIES, GraspTable
from maniskill_taskgrasp.selection.features import indicators
from maniskill_taskgrasp.selection.metrics import OPPOSITION_OF, PIP_OF
from maniskill_taskgrasp.topology import OPPOSITIONS, PIPS

BATCH = 64
LEARNING_RATE = 1e-3
AUGMENTED_ROWS = 136_627
"""Rows after the paper's augmentation."""
PARAMETER_VALUES: dict[str, tuple[str, ...]] = {
    "forces": ("weight", "interaction"),
    "constraints": (
        *("uuu", "ttr", "rxx", "uur", "utt", "txx", "uxx", "trx", "xxx", "urx", "ttx"),
    ),
    "classes": ("use", "hold", "feel"),
}
"""Column of `GraspTable` -> the data set's values; 16 indicators."""
CONTINUOUS = ("A", "B", "C", "Mass", "Duration")
"""First columns of `paper_features`: those that augmentation perturbs."""


@dataclass(frozen=True, eq=False)
class Targets:
    """What the three heads are trained on; n rows."""

    labels: np.ndarray
    """(n, 15) bool."""
    opposition: np.ndarray
    """(n,) int into `OPPOSITIONS`."""
    pip: np.ndarray
    """(n,) int into `PIPS`."""

    def take(self, rows: np.ndarray) -> Targets:
        return Targets(self.labels[rows], self.opposition[rows], self.pip[rows])


def paper_targets(table: GraspTable, labels: np.ndarray) -> Targets:
    """Targets of a table without platform, given its label sets (n, 15)."""
    return Targets(labels, OPPOSITION_OF[table.topology], PIP_OF[table.topology])


def paper_features(table: GraspTable, duration: bool = True) -> np.ndarray:
    """(n, 127) inputs, or 126 without Duration: continuous columns first, then indicators.

    Object, Task and Grasp names are no inputs; OppType and PIP would be targets as inputs.
    """
    affordances = [table.affordances[name] for name in table.objects.tolist()]
    continuous = [[*(100 * d for d in a.dimensions_m), 1000 * a.mass_kg] for a in affordances]
    parts = [np.array(continuous)]
    if duration:
        parts.append(table.durations[:, None])
    parts.append(np.array([indicators(a) for a in affordances]))
    parts.append(parameter_indicators(table))
    parts.append(table.actions[:, None] == np.array(list(load_knowledge().actions)))
    return np.hstack(parts).astype(np.float32)


def parameter_indicators(table: GraspTable) -> np.ndarray:
    """(n, 16) bool: force, constraint and class of each row."""
    return np.hstack(
        [getattr(table, c)[:, None] == np.array(v) for c, v in PARAMETER_VALUES.items()]
    )


def augmented(
    features: np.ndarray, rows: int, sigma: float, continuous: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Standardised inputs repeated in turn with noise, until there are enough.

    Args:
        features: (n, width) raw inputs.
        rows: how many to return, the first n of them without noise.
        sigma: noise in standard deviations of each continuous column.
        continuous: number of leading columns that get noise.
        seed: of the noise.

    Returns:
        (rows, width) inputs and (rows,) the original row of each.
    """
    source = np.arange(rows) % len(features)
    copies = standardised(features, features)[source]
    noise = np.random.default_rng(seed).normal(0, sigma, (rows, continuous))
    noise[: len(features)] = 0
    copies[:, :continuous] += noise.astype(np.float32)
    return copies, source


def standardised(features: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Columns scaled by mean and deviation of `reference`; constant ones are only centred."""
    scale = reference.std(0)
    scale[scale < 1e-6] = 1
    return ((features - reference.mean(0)) / scale).astype(np.float32)


class PaperNetwork(nn.Module):
    """Shared 2048-256, then one head per question."""

    def __init__(self, inputs: int) -> None:
        super().__init__()
        self.shared = nn.Sequential(
            nn.Linear(inputs, 2048), nn.ReLU(), nn.Linear(2048, 256), nn.ReLU()
        )
        self.topology = nn.Sequential(nn.Linear(256, 64), nn.ReLU(), nn.Linear(64, NUM_TOPOLOGIES))
        self.opposition = nn.Linear(256, len(OPPOSITIONS))
        self.pip = nn.Linear(256, len(PIPS))

    def forward(self, inputs: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """(n, inputs) -> logits (n, 15), (n, 3), (n, 3)."""
        hidden = self.shared(inputs)
        return self.topology(hidden), self.opposition(hidden), self.pip(hidden)


class PaperTrainer:
    """Trains the network epoch by epoch; its whole state can be saved and taken up again."""

    def __init__(self, inputs: np.ndarray, targets: Targets, batch: int, seed: int) -> None:
        """From standardised inputs (n, width) and their targets."""
        torch.manual_seed(seed)
        self._inputs = torch.from_numpy(inputs)
        self._labels = torch.from_numpy(targets.labels).float()
        self._classes = (torch.from_numpy(targets.opposition), torch.from_numpy(targets.pip))
        self._batch = batch
        self._generator = torch.Generator().manual_seed(seed)
        self.network = PaperNetwork(inputs.shape[1])
        self._optimiser = torch.optim.Adam(self.network.parameters(), lr=LEARNING_RATE)
        self.epochs = 0

    def epoch(self) -> float:
        """One pass over the rows in a fresh order; the mean loss."""
        losses = []
        order = torch.randperm(len(self._inputs), generator=self._generator)
        for rows in order.split(self._batch):
            topology, opposition, pip = self.network(self._inputs[rows])
            loss = F.binary_cross_entropy_with_logits(topology, self._labels[rows])
            loss = loss + F.cross_entropy(opposition, self._classes[0][rows])
            loss = loss + F.cross_entropy(pip, self._classes[1][rows])
            self._optimiser.zero_grad()
            loss.backward()
            self._optimiser.step()
            losses.append(loss.item())
        self.epochs += 1
        return float(np.mean(losses))

    def state(self) -> dict:
        """Weights, optimiser, order generator and epoch count."""
        return {
            "network": self.network.state_dict(),
            "optimiser": self._optimiser.state_dict(),
            "generator": self._generator.get_state(),
            "epochs": self.epochs,
        }

    def restore(self, state: dict) -> None:
        """Go on exactly where `state()` was taken."""
        self.network.load_state_dict(state["network"])
        self._optimiser.load_state_dict(state["optimiser"])
        self._generator.set_state(state["generator"])
        self.epochs = state["epochs"]


@torch.no_grad()
def predict(network: PaperNetwork, inputs: np.ndarray) -> tuple[np.ndarray, ...]:
    """Sigmoid scores (n, 15), opposition (n, 3) and PIP (n, 3) probabilities."""
    topology, opposition, pip = network(torch.from_numpy(inputs))
    heads = topology.sigmoid(), opposition.softmax(1), pip.softmax(1)
    return tuple(head.double().numpy() for head in heads)
