"""The table of what this hand can form: `python -m ...sawyer_ar10.topology_table docs/robot.md`.

Rewrites the table between the marks in that file, from the postures as they are now.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.opposition import OppositionGeometry, Pair, opposing_part
from maniskill_taskgrasp.agents.sawyer_ar10.description import SAWYER_AR10, SENSED_PRIMITIVES
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.topology import TOPOLOGIES

BEGIN, END = "<!-- topologies: begin -->", "<!-- topologies: end -->"
HEADER = (
    "| # | topology | against | gap open → least [mm] | angle [deg] | opposing |",
    "|---|---|---|---|---|---|",
)


@cache
def topology_pairs() -> dict[str, tuple[Pair, ...]]:
    """Topology slug -> its fingers with what they close against."""
    kinematics = ArticulationKinematics.of_description(SAWYER_AR10)
    geometry = OppositionGeometry(AR10, SENSED_PRIMITIVES, kinematics)
    return {topology.slug: geometry.pairs(topology) for topology in TOPOLOGIES}


def table() -> str:
    """The table in markdown, one line a topology; entries in the order of the fingers."""
    lines = list(HEADER)
    for topology in TOPOLOGIES:
        pairs = topology_pairs()[topology.slug]
        cells = (
            str(topology.index + 1),
            topology.name,
            opposing_part(topology),
            ", ".join(f"{p.finger} {millimetres(p)}" for p in pairs),
            ", ".join(f"{p.angle:.0f}" for p in pairs),
            ", ".join(p.finger for p in pairs if p.opposes) or "none",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def millimetres(pair: Pair) -> str:
    """Open and least gap, e.g. "72 → 0"."""
    return f"{1e3 * pair.open_gap:.0f} → {1e3 * pair.least_gap:.0f}"


def rewrite(text: str) -> str:
    """A document with the table between its marks brought up to date.

    Raises:
        ValueError: the marks are missing.
    """
    if BEGIN not in text or END not in text:
        raise ValueError(f"the document has no marks {BEGIN} and {END}")
    before, rest = text.split(BEGIN, 1)
    return f"{before}{BEGIN}\n{table()}\n{END}{rest.split(END, 1)[1]}"


def main(path: Path) -> None:
    """Bring the table in a document up to date."""
    partial = path.with_name(f".{path.name}.part")
    partial.write_text(rewrite(path.read_text(encoding="utf-8")), encoding="utf-8")
    partial.replace(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
