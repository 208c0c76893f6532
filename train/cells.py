"""What episodes add up to: counts, rates and intervals of one pair, a topology or a whole table."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from maniskill_taskgrasp.errors import InputError, echo
from maniskill_taskgrasp.tasks.outcome import FAILURES
from maniskill_taskgrasp.topology import TOPOLOGY_NAMES
from maniskill_taskgrasp.train.batched_episodes import Episodes
from maniskill_taskgrasp.train.intervals import wilson_interval
from maniskill_taskgrasp.train.offers import Offer

Json = dict[str, Any]
DECIMALS = 4
RESULTS_FILE = "results.json"


def read_results(folder: Path) -> Json:
    """The document of `taskgrasp evaluate --out`.

    Raises:
        InputError: there is none, or it is damaged.
    """
    path = folder / RESULTS_FILE
    if not path.is_file():
        raise InputError(f"no {path.name} in {echo(folder)}: `taskgrasp evaluate --out` makes it")
    try:
        document: Json = json.loads(path.read_text("utf-8"))
        if {"config", "cells"} <= document.keys():
            return document
    except (OSError, ValueError, AttributeError):
        pass
    raise InputError(f"{echo(path)} is damaged: remove it, or choose another folder")


def refused_cell(offer: Offer) -> Json:
    """A row that is not tried, and why."""
    return _head(offer) | counts([], []) | {"failures": {}, "fidelity": None, "mean_force_n": None}


def measured_cell(offer: Offer, episodes: Episodes) -> Json:
    """A row with its outcomes.

    `fidelity` is the share of lifted episodes that ended in the named topology, `mean_force_n` the
    hand's force on the object in lifted episodes, over the last half second.
    """
    both = [a and b for a, b in zip(episodes.lifted, episodes.in_form, strict=True)]
    names = Counter(FAILURES[index] for index in episodes.failure if index)
    force = [f for f, lifted in zip(episodes.force_n, episodes.lifted, strict=True) if lifted]
    successes = sum(episodes.lifted)
    return (
        _head(offer)
        | counts(episodes.lifted, both)
        | {
            "failures": {name: names[name] for name in FAILURES if names[name]},
            "fidelity": round(sum(both) / successes, DECIMALS) if successes else None,
            "mean_force_n": round(sum(force) / successes, 2) if successes else None,
            "mean_lift_m": round(sum(episodes.lift_m) / len(episodes), DECIMALS),
            "lifted": _bits(episodes.lifted),
            "in_form": _bits(episodes.in_form),
        }
    )


def counts(lifted: Iterable[bool], both: Iterable[bool]) -> Json:
    """Episodes and rates with Wilson 95 % intervals, for lifting and for lifting in form.

    Args:
        lifted: per episode.
        both: per episode, lifted in the named topology.
    """
    lifted, both = list(lifted), list(both)
    return tally(len(lifted), sum(lifted), sum(both))


def tally(episodes: int, successes: int, both: int) -> Json:
    """As `counts`, from sums; rates are None where nothing was tried."""
    rate = lambda n: round(n / episodes, DECIMALS) if episodes else None  # noqa: E731
    interval = lambda n: [round(x, DECIMALS) for x in wilson_interval(n, episodes)]  # noqa: E731
    return {
        "episodes": episodes,
        "successes": successes,
        "rate": rate(successes),
        "ci95": interval(successes),
        "both": both,
        "both_rate": rate(both),
        "both_ci95": interval(both),
    }


def overall(cells: list[Json]) -> Json:
    """The whole table; `offered` counts the objects (or sentences) for which something is tried."""
    subjects = {cell["text"] or cell["object"] for cell in cells}
    offered = {cell["text"] or cell["object"] for cell in cells if cell["offered"]}
    return {"offered": len(offered), "objects": len(subjects), **_sum(cells)}


def by_topology(cells: list[Json]) -> list[Json]:
    """One row for each topology that was tried, in the data set's order."""
    tried = {cell["topology"] for cell in cells if cell["episodes"]}
    names = [name for name in TOPOLOGY_NAMES if name in tried]
    groups = {name: [cell for cell in cells if cell["topology"] == name] for name in names}
    return [{"topology": name, "pairs": len(g), **_sum(g)} for name, g in groups.items()]


def _sum(cells: list[Json]) -> Json:
    failures: Counter[str] = Counter()
    for cell in cells:
        failures.update(cell["failures"])
    sums = [sum(cell[name] for cell in cells) for name in ("episodes", "successes", "both")]
    return tally(*sums) | {"failures": {n: failures[n] for n in FAILURES if failures[n]}}


def _head(offer: Offer) -> Json:
    return {
        "topology": offer.topology.name if offer.topology else None,
        "object": offer.object,
        "source": offer.source,
        "offered": offer.offered,
        "reason": offer.reason,
        "presentation": offer.presentation or None,
        "text": offer.text,
    }


def _bits(values: Iterable[bool]) -> str:
    """One character an episode, so that tables can be compared episode by episode."""
    return "".join("1" if value else "0" for value in values)
