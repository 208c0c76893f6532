"""Searches a grasp on the very object that is to be grasped, within a stated budget of trials."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.folders import cache_folder
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.assets.objects.store import part_to_json, write_atomically
from maniskill_taskgrasp.tasks.fingerprint import code_fingerprint
from maniskill_taskgrasp.tasks.grasp_library import Grasp
from maniskill_taskgrasp.tasks.grasp_search import GraspSearch, SearchBudget, SearchResult
from maniskill_taskgrasp.tasks.pose_search import GraspTrials
from maniskill_taskgrasp.topology import Topology

ACTED = ("pregrasp", "preshape", "closing")  # What of a grasp the environment is given.


@dataclass(frozen=True)
class FoundGrasp:
    """A grasp that was searched on the object itself, and what that took."""

    grasp: Grasp
    """Its lift and both are shares of fresh trials, after the search."""
    start: str
    """Train object whose stored grasp the search started from; "rule" for the bounding box."""
    spent: int
    """Simulated grasps of this search."""
    cached: bool = False
    """Whether an earlier run had searched already."""

    @property
    def note(self) -> str:
        """One line for a person."""
        when = "by an earlier run" if self.cached else "now"
        return (
            f"the grasp was searched on this very object ({self.spent} simulated trials, {when}), "
            f"from {self.start!r}"
        )

    def summary(self) -> dict[str, Any]:
        """What a result says about the search."""
        return {
            "trials": self.spent,
            "start": self.start,
            "lift": self.grasp.lift,
            "both": self.grasp.both,
            "cached": self.cached,
            "grasp": {name: getattr(self.grasp, name) for name in ACTED},
        }


def find_grasp(
    obj: str, topology: Topology, presentation: str, budget: SearchBudget, processes: int = 0
) -> FoundGrasp:
    """The best grasp within the budget, from the cache where the same search was made before.

    Args:
        processes: that share the physics; 0 chooses.

    Raises:
        InputError: unknown object, presentation or noise.
    """
    path = _cache_path(library.load(obj), topology, presentation, budget)
    if path.is_file():
        data = json.loads(path.read_text("utf-8"))
        fields: dict[str, Any] = data.pop("grasp")
        frozen: dict[str, Any] = {
            name: tuple(v) if isinstance(v, list) else v for name, v in fields.items()
        }
        return FoundGrasp(Grasp(**frozen), **data, cached=True)
    found = search(obj, topology, presentation, budget, processes)
    data = asdict(found)
    del data["cached"]
    write_atomically(path, json.dumps(data).encode())
    return found


def search(
    obj: str, topology: Topology, presentation: str, budget: SearchBudget, processes: int = 0
) -> FoundGrasp:
    """Search on an object, whatever was found before."""

    def searching(
        noise: str, distance: str, run: Callable[[GraspSearch], SearchResult]
    ) -> SearchResult:
        trials = GraspTrials(
            obj,
            topology,
            presentation,
            noise,
            budget.num_envs,
            processes=processes,
            follow=budget.follow,
            distance=distance,
        )
        try:
            return run(GraspSearch(trials, topology, budget))
        finally:
            trials.close()

    result = searching(budget.noise, "exact", lambda search: search.run())
    if budget.hardened is not None:
        first = result
        result = searching(budget.hardened, "noisy", lambda search: search.harden(first))
    return FoundGrasp(result.grasp, result.start, result.spent)


def _cache_path(
    model: ObjectModel, topology: Topology, presentation: str, budget: SearchBudget
) -> Path:
    """File of a search; its name changes with anything that could change the result."""
    body = {
        "parts": [part_to_json(part) for part in model.parts],
        "mass": model.mass_kg,
        "friction": model.friction,
        "presentation": presentation,
        "budget": asdict(budget),
        "code": code_fingerprint(),
    }
    digest = hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()[:16]
    name = "".join(c if c.isalnum() else "_" for c in model.name)
    return cache_folder() / "searches" / f"{topology.slug}--{name}--{digest}.json"
