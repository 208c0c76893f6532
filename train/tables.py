"""An evaluation as lines of text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from maniskill_taskgrasp.train.cells import Json

LABEL = 28  # Characters of a name.


def rate_text(successes: int, interval: list[float], episodes: int) -> str:
    """A rate with its interval, in percent."""
    low, high = interval
    rate = 100 * successes / episodes
    return f"{successes}/{episodes} = {rate:5.1f} % [{100 * low:.1f}-{100 * high:.1f}]"


def table_lines(document: Json) -> Iterator[str]:
    """The whole document, one cell a line."""
    for cell in document["cells"]:
        name = f"{cell['topology'] or '-':{LABEL - 4}s} {cell['object'][:LABEL]:{LABEL}s}"
        yield f"{name} {_outcome(cell)}"
    total = document["overall"]
    yield f"offered for {total['offered']} of {total['objects']}"
    if total["episodes"]:
        yield from _totals("all", total)
    if "instructions" in document:
        yield from _totals("all sentences", document["instructions"])
    if "search" in document:
        search = document["search"]
        yield (
            f"each grasp was searched on the evaluated object: {search['generations']} generations,"
            f" {search['trials_per_pair']} simulated trials a pair"
        )
    else:
        yield "stored grasps alone: nothing was searched on the evaluated objects"


def _totals(name: str, total: Json) -> Iterator[str]:
    for what, key, interval in (
        ("lifted", "successes", "ci95"),
        ("in the named topology", "both", "both_ci95"),
    ):
        yield f"{name}, {what}: {rate_text(total[key], total[interval], total['episodes'])}"


def _outcome(cell: Json) -> str:
    if not cell["episodes"]:
        return f"not tried: {cell['reason']}"
    lift = rate_text(cell["successes"], cell["ci95"], cell["episodes"])
    failures = ", ".join(f"{name} {count}" for name, count in cell["failures"].items())
    tail = f"  {failures}" if failures else ""
    return f"lift {lift}  in form {100 * cell['both_rate']:5.1f} %{tail}"
