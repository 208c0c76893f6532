"""How raw annotations become classes: grasps to topologies, phrases to actions, sizes to shapes."""

from __future__ import annotations

from functools import cache

from maniskill_taskgrasp.errors import unknown_name
from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.topology import Topology, resolve_topology

MEMBER_GRASPS: dict[str, tuple[str, ...]] = {
    "Power palm add 3-5": ("index finger extension",),
    "Power palm abd 2-5": (
        *("large diameter", "medium wrap", "small diameter", "power disk", "power sphere"),
    ),
    "Power palm add 2-5": ("adducted thumb", "fixed hook", "light tool", "palmar"),
    "Power pad abd 2": ("ring",),
    "Power pad abd 2-3": ("sphere-3 finger",),
    "Power pad abd 2-4": ("extension type", "sphere-4 finger"),
    "Intermediate abd 2": ("adduction",),
    "Intermediate add 2": ("lateral pinch", "stick", "ventral"),
    "Intermediate add 3": ("lateral tripod",),
    "Precision pad abd 2": ("inferior pincer", "thumb-index finger", "tip pinch"),
    "Precision pad abd 2-3": ("thumb-2 finger", "tripod"),
    "Precision pad abd 2-4": ("quadpod", "thumb-3 finger"),
    "Precision pad abd 2-5": ("precision disk", "precision sphere", "thumb-4 finger"),
    "Precision pad add 2-5": ("parallel extension",),
    "Precision side abd 3": ("writing tripod",),
}
"""Topology -> its grasps in the GRASP taxonomy (Feix et al. 2016), by the data set's own names."""

UNOBSERVED_GRASPS = ("distal type", "tripod variation")
"""The taxonomy's other two of 33: no row shows them, so the data give them no topology."""

SHAPE_RATIO = 2 / 3
"""Zingg's limit: an extent counts as shorter than another at or below this ratio."""
TIE = 1e-9  # Ratios of decimal sizes miss 2/3 by rounding.

TYPES: dict[tuple[str, str], str] = {
    ("bladed", "a"): "ellipse A",
    ("bladed", "c"): "ellipse C",
    ("bladed", "non-round"): "irregular",
    ("equant", "a"): "cubic cylinder",
    ("equant", "abc"): "sphere",
    ("equant", "c"): "cubic cylinder",
    ("equant", "non-round"): "cubic",
    ("oblate", "a"): "short ellipse",
    ("oblate", "c"): "disk",
    ("oblate", "non-round"): "short prism",
    ("prolate", "a"): "cylinder",
    ("prolate", "non-round"): "long prism",
    ("floppy", "floppy"): "floppy",
}
"""(shape, axis of roundness) -> type; holds for all 286 objects."""

_TOPOLOGY_OF = {grasp: name for name, grasps in MEMBER_GRASPS.items() for grasp in grasps}


def topology_of_grasp(grasp: str) -> Topology | None:
    """The topology of one of the 33 taxonomy grasps; None for the two that no row shows.

    Raises:
        InputError: no grasp has that name.
    """
    if grasp in UNOBSERVED_GRASPS:
        return None
    if grasp not in _TOPOLOGY_OF:
        known = [*_TOPOLOGY_OF, *UNOBSERVED_GRASPS]
        raise unknown_name("grasp", grasp, known, "the 33 grasps of the GRASP taxonomy")
    return resolve_topology(_TOPOLOGY_OF[grasp])


@cache
def action_of_phrase() -> dict[str, str]:
    """The annotators' 207 task phrases -> the 74 actions."""
    actions = load_knowledge().actions
    return {phrase: name for name, facts in actions.items() for phrase in facts.phrases}


def shape_class(dimensions_m: tuple[float, float, float]) -> str:
    """Zingg's class of an object from its extents a >= b >= c [m]; all zero means floppy.

    A plate is oblate, a rod prolate, a blade both flat and long, the rest equant.
    """
    a, b, c = dimensions_m
    if a == 0:
        return "floppy"
    long, flat = b / a <= SHAPE_RATIO + TIE, c / b <= SHAPE_RATIO + TIE
    return {(True, True): "bladed", (True, False): "prolate", (False, True): "oblate"}.get(
        (long, flat), "equant"
    )
