"""Searched grasps: where the palm went and how the hand closed, and the nearest for a new object.

`assets/pregrasps.json` is written by `python train/pregrasps.py` from train objects alone.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from maniskill_taskgrasp.agents.hand import HandDescription
from maniskill_taskgrasp.tasks.placement import Placement
from maniskill_taskgrasp.tasks.posture_space import PostureSpace
from maniskill_taskgrasp.topology import TOPOLOGIES, Topology

LIBRARY_FILE = "pregrasps.json"
FORM_WEIGHT = 0.7  # Of a stored grasp's worth; the rest is the plain lift.
WORTH = 0.7  # Size mismatch (log ratio) that one whole unit of worth makes up for.
OTHER_TOPOLOGY = 1.0  # Size mismatch that counts for a grasp found for kin (docs/planning.md).
OTHER_PRESENTATION = 1.25  # Size mismatch that counts for a grasp found in another presentation.
MASS = 0.1  # Weight of the log ratio of masses beside those of sizes.


@dataclass(frozen=True)
class Grasp:
    """A palm pose and a posture that worked on a train object."""

    topology: str
    """Slug."""
    obj: str
    presentation: str
    extents: tuple[float, float, float]
    """[m] world-aligned box of the placed object."""
    height: float
    """[m] of the object's centre above the table."""
    mass: float
    """[kg]"""
    pregrasp: tuple[float, ...]
    """(6,) `pregrasp.PREGRASP_FIELDS`."""
    preshape: tuple[float, ...]
    """(num_actuators,) [rad]"""
    closing: tuple[float, ...]
    """(num_actuators,) [rad]"""
    lift: float
    """Share of fresh trials that lifted the object."""
    both: float
    """Share of fresh trials that lifted it in the named topology."""
    trials: int

    def mismatch(self, placement: Placement) -> float:
        """How little this grasp suits an object: log ratios of size and mass, less its worth."""
        own, other = np.asarray(self.extents), placement.extents
        # Across the fingers (x) and in height size decides; along the object (y) hardly.
        ratios = np.abs(np.log(other / own)) * np.array([1.0, 0.25, 0.7])
        mass = MASS * abs(np.log(placement.model.mass_kg / self.mass))
        height = abs(placement.centre[2] - self.height) / 0.05
        stand = OTHER_PRESENTATION * (placement.presentation.kind != self.presentation)
        worth = FORM_WEIGHT * self.both + (1 - FORM_WEIGHT) * self.lift
        return float(ratios.sum() + 0.5 * height + mass + stand - WORTH * worth)


def nearest_grasps(
    hand: HandDescription,
    topology: Topology,
    placement: Placement,
    count: int = 1,
    known: Sequence[Grasp] | None = None,
) -> list[Grasp]:
    """Grasps that suit a topology and the placed object best, best first; may be empty.

    Those of kin, topologies with the same opposition, are carried over to the topology's own
    fingers and count as somewhat less suited.

    Args:
        known: among which; by default those that are shipped.
    """
    kin = {other.slug: other for other in TOPOLOGIES if other.opposition == topology.opposition}
    ranked = []
    for grasp in stored_grasps() if known is None else known:
        if grasp.topology in kin:
            distance = OTHER_TOPOLOGY * (grasp.topology != topology.slug)
            ranked.append((grasp.mismatch(placement) + distance, grasp))
    ranked.sort(key=lambda row: row[0])
    return [_carried(hand, kin[grasp.topology], grasp, topology) for _, grasp in ranked[:count]]


def _carried(hand: HandDescription, maker: Topology, grasp: Grasp, topology: Topology) -> Grasp:
    """The grasp with the fingers of another topology."""
    if maker == topology:
        return grasp
    space = PostureSpace.of(hand, topology)
    numbers = PostureSpace.of(hand, maker).compress(
        np.array(grasp.preshape), np.array(grasp.closing)
    )
    preshape, closing = space.expand(numbers.clip(space.lower, space.upper)[None])
    return replace(
        grasp,
        topology=topology.slug,
        preshape=tuple(preshape[0].tolist()),
        closing=tuple(closing[0].tolist()),
    )


@cache
def stored_grasps() -> tuple[Grasp, ...]:
    """All searched grasps that are shipped."""
    file = files("maniskill_taskgrasp.assets").joinpath(LIBRARY_FILE)
    if not file.is_file():
        return ()
    rows = json.loads(file.read_text("utf-8"))
    return tuple(Grasp(**{k: _frozen(v) for k, v in row.items()}) for row in rows)


def dump_grasps(grasps: list[Grasp]) -> str:
    """The library as JSON, one grasp a line, sorted so that it diffs well."""
    rows = sorted(grasps, key=lambda grasp: (grasp.topology, grasp.obj, grasp.presentation))
    return "[\n" + ",\n".join(json.dumps(asdict(row)) for row in rows) + "\n]\n"


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
