"""What this hand can do with an object's size and mass, whatever people would do with it.

A separate, visible step after the ranking: human probabilities are never altered here. All limits
were measured on the AR10 hand alone, free of the arm, before anything was built on it.
"""

from __future__ import annotations

from dataclasses import dataclass

from maniskill_taskgrasp.knowledge import Affordance
from maniskill_taskgrasp.topology import TOPOLOGY_NAMES, Topology, resolve_topology

APERTURE_M = 0.080
"""[m] The hand opens 94-99 mm from pad to pad; two rubbers take 15 mm of it."""


@dataclass(frozen=True)
class Reach:
    """What one topology can take hold of."""

    thinnest_m: float
    """[m] Least extent it can close on."""
    thickest_m: float
    """[m] Greatest extent that fits between the opposing surfaces of the preshape."""
    payload_kg: float
    """[kg] Heaviest mass trusted; see the comment of each row."""


# Extents: pad-to-pad gap of the preshape less 15 mm of rubber, at most the aperture, narrowed by
# what the posture search could hold; rods under 10 mm escape the curled fingers of the palm types.
# Payloads: palm types 0.4 kg, pad types 0.3 kg, unless a 4 x 14 cm cylinder said less; they are
# lower bounds from few trials. Side types were not measured and stay at 0.2 kg.
REACH: dict[str, Reach] = {
    "Power palm add 3-5": Reach(0.010, APERTURE_M, 0.4),
    "Power palm abd 2-5": Reach(0.010, APERTURE_M, 0.4),
    "Power palm add 2-5": Reach(0.010, 0.074, 0.4),  # 1 kg was lifted, but trapped, not held.
    "Power pad abd 2": Reach(0.010, 0.072, 0.1),
    "Power pad abd 2-3": Reach(0.010, 0.072, 0.3),
    "Power pad abd 2-4": Reach(0.010, 0.072, 0.3),
    "Intermediate abd 2": Reach(0.0035, 0.0105, 0.2),  # The fixed gap from index to middle finger.
    "Intermediate add 2": Reach(0.0, 0.015, 0.2),  # At 20 mm the thumb meets the middle finger.
    "Intermediate add 3": Reach(0.005, 0.033, 0.2),
    "Precision pad abd 2": Reach(0.005, APERTURE_M, 0.1),
    "Precision pad abd 2-3": Reach(0.005, APERTURE_M, 0.3),
    "Precision pad abd 2-4": Reach(0.005, APERTURE_M, 0.3),
    "Precision pad abd 2-5": Reach(0.005, 0.079, 0.3),
    "Precision pad add 2-5": Reach(0.025, 0.075, 0.1),  # Straight fingers stay 25 mm off.
    "Precision side abd 3": Reach(0.005, 0.020, 0.2),
}
assert tuple(REACH) == TOPOLOGY_NAMES
UNFORMED = {
    "Intermediate abd 2": "index and middle finger cannot spread, and no searched grasp held",
}
"""Topologies that this hand cannot form, whatever the object (docs/planning.md)."""


def feasible(topology: Topology | str, affordance: Affordance) -> tuple[bool, str]:
    """Can this hand hold the object in this topology, in a presentation that suits it?

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
    if name in UNFORMED:
        return False, UNFORMED[name]
    reach = REACH[name]
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
