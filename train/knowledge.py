"""Condense the authors' CSV into assets/knowledge.json: facts per object and action, and counts.

python train/knowledge.py --dataset task-object_grasp_dataset.csv
"""

from __future__ import annotations

import collections
import csv
import json
from dataclasses import dataclass
from pathlib import Path

from maniskill_taskgrasp.topology import TOPOLOGY_NAMES
from maniskill_taskgrasp.train.script import run_script

DEFAULT_OUT = Path(__file__).resolve().parent.parent / "assets" / "knowledge.json"
PARAMETER_COLUMNS = {"force": "Force", "constraint": "Constraint", "task_class": "Class"}


@dataclass(frozen=True, kw_only=True)
class KnowledgeConfig:
    """Condense the authors' CSV into facts and counts."""

    dataset: Path
    """The authors' CSV (`taskgrasp data fetch` gets it)."""
    out: Path = DEFAULT_OUT
    """Where to write the JSON."""


def object_facts(row: dict[str, str]) -> dict[str, object]:
    """Measurements of the row's object; every one is a function of its name (facts, section 1)."""
    return {
        "dimensions_m": [round(float(row[axis]) / 100, 5) for axis in "ABC"],
        "mass_kg": round(float(row["Mass"]) / 1000, 6),
        "grasped_dimension": row["GraspedDimension"],
        "rigidity": row["Rigidity"],
        "roundness": row["Roundness"],
        "shape": row["Shape"],
        "type": row["Type"],
    }


def condense(rows: list[dict[str, str]]) -> dict[str, object]:
    """Facts per object, statistics per action, and topology counts per (object, action)."""
    objects = {row["Object"]: object_facts(row) for row in rows}
    phrases: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    parameters: dict[str, dict[str, collections.Counter[str]]] = collections.defaultdict(
        lambda: {name: collections.Counter() for name in PARAMETER_COLUMNS}
    )
    pairs: dict[tuple[str, str], list[int]] = collections.defaultdict(
        lambda: [0] * len(TOPOLOGY_NAMES)
    )
    for row in rows:
        action = row["Task_group"]
        phrases[action][row["Task"]] += 1
        for name, column in PARAMETER_COLUMNS.items():
            parameters[action][name][row[column]] += 1
        counts = pairs[row["Object"], action]
        if row["Grasp_group"] in TOPOLOGY_NAMES:  # The 16th group, platform, is no topology.
            counts[TOPOLOGY_NAMES.index(row["Grasp_group"])] += 1
    return {
        "objects": dict(sorted(objects.items())),
        "actions": {
            action: {"phrases": dict(phrases[action]), "parameters": parameters[action]}
            for action in sorted(phrases)
        },
        "pairs": [[o, a, counts] for (o, a), counts in sorted(pairs.items())],
    }


def main(config: KnowledgeConfig) -> None:
    with config.dataset.open(newline="", encoding="utf-8") as file:
        knowledge = condense(list(csv.DictReader(file)))
    partial = config.out.with_suffix(".partial")
    partial.write_text(json.dumps(knowledge, indent=None, separators=(",", ":")) + "\n", "utf-8")
    partial.replace(config.out)


if __name__ == "__main__":
    run_script(main, KnowledgeConfig)
