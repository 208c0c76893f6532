"""Success tables: which pairs are tried, how often they lift, and in the named topology.

taskgrasp evaluate --table paper --search 4 --out reports/table1
"""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, fields
from multiprocessing import get_context
from pathlib import Path

from tqdm import tqdm

from maniskill_taskgrasp.assets.objects.store import write_atomically
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.pipeline import policy_maker
from maniskill_taskgrasp.tasks.fingerprint import code_fingerprint
from maniskill_taskgrasp.tasks.own_search import FoundGrasp, SearchBudget, find_grasp
from maniskill_taskgrasp.train.batched_episodes import (
    Conditions,
    Job,
    jobs_at_once,
    run_jobs,
)
from maniskill_taskgrasp.train.cells import (
    RESULTS_FILE,
    Json,
    by_topology,
    measured_cell,
    overall,
    read_results,
    refused_cell,
    tally,
)
from maniskill_taskgrasp.train.evaluation_config import EvaluateConfig
from maniskill_taskgrasp.train.offers import Offer, list_offers
from maniskill_taskgrasp.train.script import run_script
from maniskill_taskgrasp.train.traces import save_traces

Searched = tuple[str, str]
"""Topology and source of an object."""

ELSEWHERE = ("out", "num_envs")  # Settings that change no result.


@dataclass
class Table:
    """Cells that are measured, kept in a file where there is one."""

    settings: Json
    path: Path | None
    cells: dict[tuple[str, str, str], Json]

    @classmethod
    def open(cls, config: EvaluateConfig) -> Table:
        """The table in the output folder, to be gone on with, or an empty one.

        Raises:
            InputError: the folder holds another evaluation's results, or damaged ones.
        """
        settings = _settings(config)
        path = config.out / RESULTS_FILE if config.out else None
        if path is None or not path.is_file():
            return cls(settings, path, {})
        found = read_results(path.parent)
        differing = [n for n, value in settings.items() if found["config"].get(n) != value]
        if differing:
            raise InputError(
                f"{str(path)!r} holds results with other {', '.join(differing)}: "
                "choose another --out, or remove it"
            )
        return cls(settings, path, {_key(c): c for c in found["cells"] if c["episodes"]})

    def document(self, offers: list[Offer], complete: bool) -> Json:
        """The JSON document, cells in the order of the offers."""
        cells = [
            self.cells.get(offer.key) or refused_cell(offer)
            for offer in offers
            if offer.key in self.cells or not offer.offered
        ]
        document = {
            "cells": cells,
            "topologies": by_topology(cells),
            "overall": overall(cells),
            "config": self.settings | {"complete": complete},
        }
        if self.settings["instructions"]:
            document["instructions"] = _end_to_end(cells, self.settings["episodes"])
        if self.settings["search"]:
            document["search"] = _search_note(self.settings, cells)
        return document

    def save(self, offers: list[Offer]) -> Json:
        """Write the document, whole or not at all."""
        complete = all(offer.key in self.cells for offer in offers if offer.offered)
        document = self.document(offers, complete)
        if self.path is not None:
            write_atomically(self.path, (json.dumps(document, indent=1) + "\n").encode())
        return document


def evaluate(config: EvaluateConfig) -> Json:
    """Measure all pairs that are not in the output folder yet.

    Returns:
        The JSON document of the command line's contract (docs/evaluation.md).

    Raises:
        InputError: something that was named does not exist, or the folder holds other results.
    """
    make_policy, env_kwargs = policy_maker(config.policy, config.distance)
    if config.policy == "constant":
        env_kwargs |= {"obs": "paper"}  # It looks at the clock alone; this costs least.
    table, offers = Table.open(config), list_offers(config)
    todo = [offer for offer in offers if offer.offered and offer.key not in table.cells]
    conditions = Conditions(
        episodes=config.episodes,
        noise=config.noise,
        presentation=config.presentation,
        seed=config.seed,
        num_envs=config.num_envs,
        make_policy=make_policy,
        env_kwargs=env_kwargs,
    )
    document = table.save(offers)
    grasps = _search_all(todo, config) if config.search else {}
    with tqdm(total=len(todo) * config.episodes, unit="episode", disable=not todo) as bar:
        for chunk in _chunks(todo, config):
            for offer, cell in _measure(chunk, grasps, config, conditions):
                table.cells[offer.key] = cell
            document = table.save(offers)
            bar.update(len(chunk) * config.episodes)
            bar.set_postfix_str(_headline(document["overall"]))
    return document


def _chunks(offers: list[Offer], config: EvaluateConfig) -> Iterator[list[Offer]]:
    if not offers:
        return
    size = jobs_at_once(len(offers), config.episodes, config.num_envs)
    for first in range(0, len(offers), size):
        yield offers[first : first + size]


def _search_all(offers: list[Offer], config: EvaluateConfig) -> dict[Searched, FoundGrasp]:
    """The grasp of every topology and object, searched on the object; a core for each search."""
    wanted = {_searched(offer): offer for offer in offers}
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    # Spawned, not forked: a simulation that was built before a fork is no good after it.
    with ProcessPoolExecutor(min(cores, len(wanted) or 1), get_context("spawn")) as pool:
        jobs = {pool.submit(_search, offer, config): key for key, offer in wanted.items()}
        with tqdm(as_completed(jobs), total=len(jobs), unit="search", disable=not jobs) as bar:
            return {jobs[job]: job.result() for job in bar}


def _searched(offer: Offer) -> Searched:
    """What a search is for: sentences may ask for the same."""
    return (offer.topology.name if offer.topology else "", offer.source)


def _measure(
    offers: list[Offer],
    grasps: dict[Searched, FoundGrasp],
    config: EvaluateConfig,
    conditions: Conditions,
) -> list[tuple[Offer, Json]]:
    """Run the episodes of some pairs together."""
    start = time.perf_counter()
    found = [grasps.get(_searched(offer)) for offer in offers]
    jobs = [
        Job(o.topology, o.source, o.object, o.text or "", f.grasp if f else None)
        for o, f in zip(offers, found, strict=True)
        if o.topology is not None
    ]
    results = run_jobs(jobs, conditions)
    seconds = round((time.perf_counter() - start) / len(jobs), 1)
    cells = []
    for offer, job, episodes, search in zip(offers, jobs, results, found, strict=True):
        cell = measured_cell(offer, episodes)
        cell |= {"seconds": seconds, "code": code_fingerprint()}
        cell["search"] = search.summary() if search else None
        cells.append((offer, cell))
        if config.out is not None:
            save_traces(config.out, job, episodes)
    return cells


def _search(offer: Offer, config: EvaluateConfig) -> FoundGrasp:
    assert offer.topology is not None
    # The same grasps whatever the policy, so that policies can be compared.
    budget = SearchBudget.on_object(config.search, config.seed, config.noise)
    return find_grasp(offer.source, offer.topology, config.presentation, budget, processes=1)


def _settings(config: EvaluateConfig) -> Json:
    """What decides the results, JSON-able; a checkpoint is named by its content too."""
    own = {field.name for field in fields(EvaluateConfig)} - set(ELSEWHERE)
    settings = {n: v for n, v in asdict(config).items() if n in own}
    settings = {n: str(v) if isinstance(v, Path) else v for n, v in settings.items()}
    settings = {n: list(v) if isinstance(v, tuple) else v for n, v in settings.items()}
    policy = Path(config.policy)
    if policy.is_file():
        settings["policy_sha256"] = hashlib.sha256(policy.read_bytes()).hexdigest()
    return settings


def _search_note(settings: Json, cells: list[Json]) -> Json:
    """That grasps were searched on the evaluated objects, and how much simulation that took."""
    budget = SearchBudget.on_object(settings["search"], settings["seed"], settings["noise"])
    return {
        "on_evaluated_objects": True,
        "generations": budget.generations,
        "trials_per_pair": budget.trials,
        "noise": budget.hardened or budget.noise,
        "pairs": sum(cell.get("search") is not None for cell in cells),
    }


def _end_to_end(cells: list[Json], episodes: int) -> Json:
    """Rates over all sentences: one that leads to no grasp counts as failed."""
    sums = [sum(cell[name] for cell in cells) for name in ("successes", "both")]
    return tally(len(cells) * episodes, *sums)


def _key(cell: Json) -> tuple[str, str, str]:
    return (cell["topology"] or "", cell["object"], cell["text"] or "")


def _headline(total: Json) -> str:
    return f"lifted {total['successes']}, in form {total['both']} of {total['episodes']}"


def main(config: EvaluateConfig) -> None:
    document = evaluate(config)
    if config.out is None:
        print(json.dumps(document))
        return
    from maniskill_taskgrasp.train.report import write_report

    print(write_report(config.out))


if __name__ == "__main__":
    run_script(main, EvaluateConfig)
