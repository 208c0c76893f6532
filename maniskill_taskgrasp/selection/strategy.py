"""The selector's answer: one distribution over the 15 topologies and what follows from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from maniskill_taskgrasp.topology import OPPOSITIONS, PIPS, TOPOLOGIES, Topology


@dataclass(frozen=True)
class GraspStrategy:
    """How people would grasp an object for an action, as far as the data tell."""

    probabilities: tuple[float, ...]
    """15 numbers in the order of `TOPOLOGIES`; they sum to 1."""
    evidence: int
    """Rows of human data on exactly this object and action; 0 means the network generalises."""

    @classmethod
    def of(cls, probabilities: Sequence[float], evidence: int) -> GraspStrategy:
        """From 15 non-negative numbers, normalised."""
        total = float(sum(probabilities))
        return cls(tuple(float(p) / total for p in probabilities), int(evidence))

    @property
    def opposition(self) -> dict[str, float]:
        """Pad, Palm and Side -> probability: sums over topologies, so they never contradict."""
        return {name: self._sum("opposition", name) for name in OPPOSITIONS}

    @property
    def pip(self) -> dict[str, float]:
        """Power, Precision and Intermediate -> probability, likewise."""
        return {name: self._sum("pip", name) for name in PIPS}

    def ranked(self) -> tuple[Topology, ...]:
        """All topologies, most probable first; ties keep the data set's order."""
        return tuple(sorted(TOPOLOGIES, key=lambda t: -self.probabilities[t.index]))

    def _sum(self, attribute: str, value: str) -> float:
        members = (t.index for t in TOPOLOGIES if getattr(t, attribute) == value)
        return sum(self.probabilities[index] for index in members)
