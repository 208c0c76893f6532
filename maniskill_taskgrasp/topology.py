"""The 15 grasp topologies: hand-independent classes of contact between a hand and an object."""

from __future__ import annotations

import re
from dataclasses import dataclass

from maniskill_taskgrasp.errors import unknown_name

INDEX, MIDDLE, RING, LITTLE = 2, 3, 4, 5
OPPOSITIONS = ("Pad", "Palm", "Side")
PIPS = ("Power", "Precision", "Intermediate")

FINGER_NAMES = {INDEX: "index", MIDDLE: "middle", RING: "ring", LITTLE: "little"}

# Their digit numbers name one finger only; what stands against it is in the fact sheet (4.1).
_SIDE_PARTS = {
    "Intermediate abd 2": ("index", "middle"),
    "Intermediate add 2": ("thumb", "index"),
    "Intermediate add 3": ("thumb", "index", "middle"),
    "Precision side abd 3": ("thumb", "index", "middle"),
}

_NAME = re.compile(r"(Power|Intermediate|Precision)(?: (palm|pad|side))? (abd|add) (\d)(?:-(\d))?")


@dataclass(frozen=True)
class Topology:
    """One class of grasp, whatever the hand (Li et al., section II; names as in their dataset)."""

    index: int
    """Place in the dataset's column order, 0 to 14."""
    name: str
    """The dataset's column name, e.g. "Precision pad abd 2-3"."""
    opposition: str
    """Direction of the opposing forces: one of `OPPOSITIONS`."""
    pip: str
    """Power, precision or intermediate: one of `PIPS`."""
    thumb_abducted: bool
    """True where the thumb opposes the fingers ("abd"), False where it lies beside them ("add")."""
    fingers: tuple[int, ...]
    """Fingers that work, 2 index to 5 little; the thumb is not counted."""

    @property
    def slug(self) -> str:
        """The name as an identifier, e.g. "precision_pad_abd_2_3"."""
        return re.sub(r"[ -]", "_", self.name.lower())

    @property
    def parts(self) -> tuple[str, ...]:
        """Parts of the hand that must press the object, of palm, index ... little and thumb."""
        fingers = tuple(FINGER_NAMES[finger] for finger in self.fingers)
        if self.opposition == "Side":
            return _SIDE_PARTS[self.name]
        if self.opposition == "Pad":
            return ("thumb", *fingers)
        return ("palm", "thumb", *fingers) if self.thumb_abducted else ("palm", *fingers)


def _parse(index: int, name: str) -> Topology:
    match = _NAME.fullmatch(name)
    assert match is not None, name
    pip, opposition, thumb, first, last = match.groups()
    return Topology(
        index=index,
        name=name,
        opposition=(opposition or "side").capitalize(),
        pip=pip,
        thumb_abducted=thumb == "abd",
        fingers=tuple(range(int(first), int(last or first) + 1)),
    )


TOPOLOGIES: tuple[Topology, ...] = tuple(
    _parse(index, name)
    for index, name in enumerate(
        (
            "Power palm add 3-5",
            "Power palm abd 2-5",
            "Power palm add 2-5",
            "Power pad abd 2",
            "Power pad abd 2-3",
            "Power pad abd 2-4",
            "Intermediate abd 2",
            "Intermediate add 2",
            "Intermediate add 3",
            "Precision pad abd 2",
            "Precision pad abd 2-3",
            "Precision pad abd 2-4",
            "Precision pad abd 2-5",
            "Precision pad add 2-5",
            "Precision side abd 3",
        )
    )
)
"""All topologies in the dataset's column order; every 15-wide array follows it."""

TOPOLOGY_NAMES: tuple[str, ...] = tuple(topology.name for topology in TOPOLOGIES)

_BY_KEY = {key: t for t in TOPOLOGIES for key in (t.name.lower(), t.slug)}


def resolve_topology(name: str) -> Topology:
    """The topology of that name or slug, whatever the case.

    Raises:
        InputError: no topology has that name.
    """
    try:
        return _BY_KEY[name.strip().lower()]
    except KeyError:
        known = [t.name.lower() for t in TOPOLOGIES] + [t.slug for t in TOPOLOGIES]
        raise unknown_name("topology", name, known, "taskgrasp topologies") from None
