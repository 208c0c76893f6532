"""What the hand can do with an object's size and mass, whatever people would do with it.

A separate, visible step after the ranking: human probabilities are never altered here. All limits
are a hand's own and come from its file, `assets/hands/<hand>.json`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from maniskill_taskgrasp.knowledge import Affordance
from maniskill_taskgrasp.topology import TOPOLOGY_NAMES, Topology, resolve_topology

HAND = "ar10"
"""The hand that is meant."""


@dataclass(frozen=True)
class Reach:
    """What one topology can take hold of."""

    thinnest_m: float
    """[m] Least extent it can close on."""
    thickest_m: float
    """[m] Greatest extent that fits between the opposing surfaces of the preshape."""
    payload_kg: float
    """[kg] Heaviest mass trusted."""
    note: str = ""
    """What the numbers alone do not tell."""


@dataclass(frozen=True)
class HandLimits:
    """What one hand can hold."""

    reach: dict[str, Reach]
    """Topology name -> its reach, all 15 of them in their order."""
    unformed: dict[str, str]
    """Topologies that the hand cannot form, whatever the object -> why."""

    @classmethod
    def from_json(cls, document: dict[str, Any]) -> HandLimits:
        """The limits in a hand's file.

        Raises:
            ValueError: the file does not give all topologies, or names others.
        """
        reach = {name: Reach(**row) for name, row in document["reach"].items()}
        unformed = dict(document["unformed"])
        if tuple(reach) != TOPOLOGY_NAMES or not set(unformed) <= set(reach):
            raise ValueError(
                f"a hand's limits need these topologies in this order: {TOPOLOGY_NAMES},"
                f" got {(*reach, *unformed)}"
            )
        return cls(reach, unformed)


@cache
def hand_limits(hand: str = HAND) -> HandLimits:
    """Limits of a hand by the name of its file."""
    path = files("maniskill_taskgrasp.assets").joinpath(f"hands/{hand}.json")
    return HandLimits.from_json(json.loads(path.read_text(encoding="utf-8")))


def feasible(
    topology: Topology | str, affordance: Affordance, hand: str = HAND
) -> tuple[bool, str]:
    """Can the hand hold the object in this topology, in a presentation that suits it?

    The hand closes across one of the extents that people close across
    (`Affordance.grasped_dimension`); one that fits is enough.

    Returns:
        The answer, and one clause that gives the deciding number.

    Raises:
        InputError: no topology has that name.
    """
    name = (resolve_topology(topology) if isinstance(topology, str) else topology).name
    if affordance.is_floppy:
        return False, "floppy: no fixed shape that rigid-body simulation could carry"
    limits = hand_limits(hand)
    if name in limits.unformed:
        return False, limits.unformed[name]
    reach = limits.reach[name]
    extents = closing_extents(affordance)
    fitting = [e for e in extents if reach.thinnest_m <= e <= reach.thickest_m]
    if not fitting:
        range_mm = f"{1000 * reach.thinnest_m:g} to {1000 * reach.thickest_m:g} mm"
        shown = " or ".join(f"{1000 * e:.4g}" for e in extents)
        return False, f"{shown} mm across: this topology closes on {range_mm}"
    if affordance.mass_kg > reach.payload_kg:
        mass, payload = 1000 * affordance.mass_kg, 1000 * reach.payload_kg
        return False, f"{mass:.4g} g: this topology carries at most {payload:g} g"
    return True, f"{1000 * fitting[0]:.4g} mm across and {1000 * affordance.mass_kg:.4g} g fit"


def closing_extents(affordance: Affordance) -> tuple[float, ...]:
    """[m] Extents across which people close their hand on it, thinnest first, without repeats."""
    by_axis = dict(zip("abc", affordance.dimensions_m, strict=True))
    axes = [axis for axis in affordance.grasped_dimension.split("/") if axis in by_axis]
    return tuple(sorted({by_axis[axis] for axis in axes or "bc"}))
