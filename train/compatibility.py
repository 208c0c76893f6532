"""Which test objects an evaluation asks of which topology: a rule of size, mass and human use.

python train/compatibility.py writes the lists it gives to assets/evaluation_pairs.json; they were
committed before any policy was trained.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from maniskill_taskgrasp.assets.objects.store import write_atomically
from maniskill_taskgrasp.knowledge import Affordance, Knowledge
from maniskill_taskgrasp.selection.feasibility import feasible
from maniskill_taskgrasp.topology import TOPOLOGIES, resolve_topology

PAIRS_FILE = "evaluation_pairs.json"
PER_TOPOLOGY = 3  # Objects a topology in the paper's Table I.
PAPER_TOPOLOGIES = tuple(
    resolve_topology(name)
    for name in (
        "Power palm abd 2-5",
        "Power palm add 2-5",
        "Power pad abd 2",
        "Power pad abd 2-4",
        "Precision pad abd 2",
        "Precision pad abd 2-3",
        "Precision pad abd 2-4",
        "Precision pad abd 2-5",
        "Precision pad add 2-5",
    )
)
"""The nine of the paper's Table I (fact sheet "robot", section 4.1)."""
RULE = (
    "A topology and an object are compatible when people were seen to hold the object so (at least "
    "one row of the human data), one of the extents across which they hold it is within the "
    "topology's reach, and its mass within the topology's payload (selection/feasibility.py). "
    f"Where that leaves a topology fewer than {PER_TOPOLOGY} objects, others that fit its reach "
    f"and payload fill it up. Table I: the {PER_TOPOLOGY} fitting objects with most rows for the "
    "topology; ties go to objects that no earlier topology of the table uses, then to those with "
    "most rows in all, then by name. Presentation: by rule from object and topology "
    "(tasks/placement.py, suited)."
)


@dataclass(frozen=True)
class Pair:
    """An object that is to be held in a topology."""

    topology: str
    object: str
    rows: int
    """Human grasps of this object in this topology."""
    reason: str
    """Why it is compatible, or why not."""


@dataclass(frozen=True)
class PairLists:
    """What the rule gives."""

    paper: list[Pair]
    """Table I: the paper's nine topologies x `PER_TOPOLOGY` objects."""
    feasible: list[Pair]
    """Every topology with all its compatible objects."""
    excluded: list[Pair]
    """Pairs that people were seen to use and that the rule leaves out."""

    @property
    def kept_share(self) -> float:
        """Share of the pairs of the label sets that the rule keeps."""
        kept = sum(pair.rows > 0 for pair in self.feasible)
        return kept / (kept + len(self.excluded))


def topology_rows(knowledge: Knowledge, name: str) -> list[int]:
    """Human grasps of an object in each of the 15 topologies, over all actions."""
    rows = [0] * len(TOPOLOGIES)
    for (obj, _), counts in knowledge.pair_counts.items():
        if obj == name:
            rows = [total + count for total, count in zip(rows, counts, strict=True)]
    return rows


def compatible_pairs(objects: Sequence[Affordance], knowledge: Knowledge) -> PairLists:
    """Apply the rule (`RULE`) to some objects; no simulator, no result is looked at."""
    rows = {obj.name: topology_rows(knowledge, obj.name) for obj in objects}
    lists = PairLists([], [], [])
    for topology in TOPOLOGIES:
        fitting = []
        for obj in objects:
            seen = rows[obj.name][topology.index]
            fits, reason = feasible(topology, obj)
            if fits:
                fitting.append(Pair(topology.name, obj.name, seen, reason))
            elif seen:
                lists.excluded.append(Pair(topology.name, obj.name, seen, reason))
        ranked = _ranked(fitting, rows, {pair.object for pair in lists.paper})
        if topology in PAPER_TOPOLOGIES:
            lists.paper.extend(ranked[:PER_TOPOLOGY])
        seen_pairs = [pair for pair in ranked if pair.rows]
        lists.feasible.extend(seen_pairs)
        lists.feasible.extend(ranked[len(seen_pairs) : PER_TOPOLOGY])
    return lists


def _ranked(pairs: list[Pair], rows: dict[str, list[int]], used: set[str]) -> list[Pair]:
    """Most rows first; see `RULE` for ties."""
    order = lambda p: (-p.rows, p.object in used, -sum(rows[p.object]), p.object)  # noqa: E731
    return sorted(pairs, key=order)


def to_json(lists: PairLists) -> dict[str, Any]:
    """The committed document."""
    return {
        "rule": RULE,
        "kept_share_of_label_sets": round(lists.kept_share, 4),
        "paper_objects": len({pair.object for pair in lists.paper}),
        **{name: [asdict(pair) for pair in pairs] for name, pairs in vars(lists).items()},
    }


def dump(document: dict[str, Any]) -> str:
    """The document as text, one pair a line."""
    parts = []
    for name, value in document.items():
        if isinstance(value, list):
            text = "[\n  " + ",\n  ".join(json.dumps(row) for row in value) + "\n ]"
        else:
            text = json.dumps(value)
        parts.append(f" {json.dumps(name)}: {text}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def committed_pairs(table: str) -> list[Pair]:
    """The committed list of a table, "paper" or "feasible"."""
    text = files("maniskill_taskgrasp.assets").joinpath(PAIRS_FILE).read_text("utf-8")
    return [Pair(**row) for row in json.loads(text)[table]]


def main() -> None:
    """Write the committed lists again."""
    from maniskill_taskgrasp.assets.objects import library
    from maniskill_taskgrasp.knowledge import load_knowledge

    knowledge = load_knowledge()
    objects = [knowledge.objects[name] for name in library.names("test")]
    document = to_json(compatible_pairs(objects, knowledge))
    path = Path(__file__).resolve().parent.parent / "assets" / PAIRS_FILE
    write_atomically(path, dump(document).encode())
    print(
        f"{len(document['paper'])} pairs of Table I with {document['paper_objects']} objects, "
        f"{len(document['feasible'])} compatible pairs, {len(document['excluded'])} excluded; "
        f"{100 * document['kept_share_of_label_sets']:.1f} % of the label sets kept"
    )


if __name__ == "__main__":
    main()
