"""Eight numbers that stand for a topology's posture pair, and the box that is searched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.hand import HandDescription
from maniskill_taskgrasp.topology import Topology

Array = NDArray[np.float64]

# Box, first spread and least spread of the six numbers of a pregrasp, `PREGRASP_FIELDS`.
PREGRASP_LOWER = (-0.09, -0.01, -0.05, -0.35, -1.75, -1.75)
PREGRASP_UPPER = (0.05, 0.13, 0.11, 0.80, 1.75, 1.75)
PREGRASP_SPREAD = (0.018, 0.022, 0.022, 0.28, 0.25, 0.12)
PREGRASP_FLOOR = (0.0015, 0.0015, 0.0015, 0.02, 0.02, 0.02)
# The same spreads for the eight of `PostureSpace`, whose box depends on the topology.
POSTURE_SPREAD = (0.12, 0.20, 0.08, 0.25, 0.15, 0.25, 0.25, 0.35)
POSTURE_FLOOR = (0.01,) * 8
# [rad] by which a searched posture keeps clear of the thresholds of form.
ABOVE_ABDUCTED, BELOW_ABDUCTED, BELOW_STRAIGHT = 0.02, 0.03, 0.05


@dataclass(frozen=True)
class PostureSpace:
    """Eight numbers that stand for a posture pair of one topology.

    Thumb rotation open and closed, thumb flexion open and closed, then the mean knuckle and middle
    joint of the moving fingers, open and closed; fingers keep their differences.
    """

    preshape: Array
    closing: Array
    lower: Array
    upper: Array
    finger_range: tuple[float, float]
    """[rad]"""
    rotates: bool
    """Whether the thumb's rotation is part of the closing."""

    @classmethod
    def of(cls, hand: HandDescription, topology: Topology) -> PostureSpace:
        """Bounds that keep the posture within the topology's name."""
        posture = hand.postures[topology.slug]
        lower, upper = np.array(hand.posture_lower), np.array(hand.posture_upper)
        abducted = hand.thumb_abducted
        if topology.opposition == "Pad":
            upper[3] = hand.pinch_thumb_flex
            lower[:2] = abducted + ABOVE_ABDUCTED
            if not topology.thumb_abducted:
                upper[[5, 7]] = hand.straight_pip - BELOW_STRAIGHT
        elif topology.opposition == "Palm":
            if topology.thumb_abducted:
                lower[:2] = abducted + ABOVE_ABDUCTED
            else:
                upper[:2] = abducted - BELOW_ABDUCTED
        return cls(
            preshape=np.array(posture.preshape),
            closing=np.array(posture.closing),
            lower=lower,
            upper=upper,
            finger_range=hand.finger_range,
            rotates=bool(posture.moving[0]),
        )

    @property
    def _moving(self) -> list[int]:
        """First joint's place of each finger that closes."""
        return [i for i in range(2, len(self.preshape), 2) if self.preshape[i] != self.closing[i]]

    def start(self) -> Array:
        """(8,) the hand's own posture."""
        return self.compress(self.preshape, self.closing)

    def compress(self, preshape: Array, closing: Array) -> Array:
        """(8,) numbers of a posture pair, each (num_actuators,) [rad]."""
        fingers = [
            float(np.mean([side[i + joint] for i in self._moving])) if self._moving else 0.5
            for side in (preshape, closing)
            for joint in (0, 1)
        ]
        thumb = [preshape[0], closing[0], preshape[1], closing[1]]
        return np.clip([*thumb, *fingers], self.lower, self.upper)

    def expand(self, numbers: Array) -> tuple[Array, Array]:
        """Preshapes and closings, each (n, num_actuators) [rad], of numbers (n, 8)."""
        n = len(numbers)
        preshape, closing = np.tile(self.preshape, (n, 1)), np.tile(self.closing, (n, 1))
        preshape[:, 0] = numbers[:, 0]
        closing[:, 0] = numbers[:, 1] if self.rotates else numbers[:, 0]
        preshape[:, 1] = numbers[:, 2]
        thumb_moves = self.preshape[1] != self.closing[1]
        closing[:, 1] = numbers[:, 3].clip(min=numbers[:, 2]) if thumb_moves else numbers[:, 2]
        centre = self.start()[4:]
        for i in self._moving:
            for joint in (0, 1):
                at = i + joint
                preshape[:, at] += numbers[:, 4 + joint] - centre[joint]
                closing[:, at] += numbers[:, 6 + joint] - centre[2 + joint]
        preshape[:, 2:] = preshape[:, 2:].clip(*self.finger_range)
        closing[:, 2:] = closing[:, 2:].clip(*self.finger_range)
        return preshape, closing
