"""What the human grasping data say about objects and actions, as facts and counts.

`assets/knowledge.json` is made from the authors' CSV by `python train/knowledge.py`; it holds
object measurements, action statistics and topology counts, no row of the CSV. Nothing heavy is
imported here, so the front end starts fast.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from maniskill_taskgrasp.errors import unknown_name

PARAMETERS = ("force", "constraint", "task_class")
"""Task parameters that the data give for an action (CSV columns Force, Constraint, Class)."""


@dataclass(frozen=True)
class Affordance:
    """What can be measured of an object before it is grasped: a function of its name."""

    name: str
    dimensions_m: tuple[float, float, float]
    """Extents a >= b >= c [m]; (0, 0, 0) where the object is floppy. a is capped at 0.15 m."""
    mass_kg: float
    """Mass [kg], capped at 1."""
    grasped_dimension: str
    rigidity: str
    """rigid, squeezable, fragile or floppy."""
    roundness: str
    shape: str
    """Class after Zingg: prolate, oblate, bladed, equant, or floppy."""
    type: str

    @property
    def is_floppy(self) -> bool:
        return self.rigidity == "floppy"


@dataclass(frozen=True)
class ActionFacts:
    """One of the 74 actions, with the phrases the annotators used and its parameter statistics."""

    name: str
    phrases: dict[str, int]
    """Annotators' task phrase -> rows; 207 phrases over all actions."""
    parameters: dict[str, dict[str, int]]
    """Parameter (`PARAMETERS`) -> value -> rows."""


@dataclass(frozen=True)
class Knowledge:
    """All objects, actions and (object, action) -> topology counts of the human data."""

    objects: dict[str, Affordance]
    actions: dict[str, ActionFacts]
    pair_counts: dict[tuple[str, str], tuple[int, ...]]
    """(object, action) -> 15 counts in the order of `topology.TOPOLOGIES`."""

    def affordance(self, name: str) -> Affordance:
        """The object's measurements.

        Raises:
            InputError: no object has that name.
        """
        try:
            return self.objects[name]
        except KeyError:
            raise unknown_name("object", name, self.objects, "taskgrasp objects list") from None

    def actions_of(self, object_name: str) -> dict[str, int]:
        """Action -> how often people did it with the object, most frequent first."""
        counts = {a: sum(n) for (o, a), n in self.pair_counts.items() if o == object_name}
        return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


@cache
def load_knowledge() -> Knowledge:
    """The shipped knowledge, read once."""
    text = files("maniskill_taskgrasp.assets").joinpath("knowledge.json").read_text("utf-8")
    data = json.loads(text)
    return Knowledge(
        objects={
            name: Affordance(name=name, **{**facts, "dimensions_m": tuple(facts["dimensions_m"])})
            for name, facts in data["objects"].items()
        },
        actions={name: ActionFacts(name=name, **facts) for name, facts in data["actions"].items()},
        pair_counts={(o, a): tuple(counts) for o, a, counts in data["pairs"]},
    )
