"""Laws of the search on the very object: its budget, its cache, and what it may choose."""

from dataclasses import replace

import numpy as np
import pytest

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks import grasp_search, own_search
from maniskill_taskgrasp.tasks.grasp_library import Grasp
from maniskill_taskgrasp.tasks.own_search import FoundGrasp, SearchBudget, find_grasp
from maniskill_taskgrasp.tasks.posture_space import PREGRASP_LOWER, PREGRASP_UPPER
from maniskill_taskgrasp.topology import resolve_topology

PAD = resolve_topology("Precision pad abd 2-3")
PALM = resolve_topology("Power palm abd 2-5")
BUDGET = SearchBudget(generations=3)
FOUND = FoundGrasp(
    Grasp(
        topology=PAD.slug,
        obj="phone",
        presentation="table",
        extents=(0.1, 0.2, 0.3),
        height=0.05,
        mass=0.2,
        pregrasp=(0.0,) * 6,
        preshape=(0.5,) * 10,
        closing=(1.0,) * 10,
        lift=1.0,
        both=0.9,
        trials=32,
    ),
    start="rule",
    spent=320,
)


@pytest.fixture
def searches(monkeypatch, tmp_path):
    """An empty cache, and a search that only notes that it was asked."""
    asked = []
    monkeypatch.setattr(own_search, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(own_search, "search", lambda *args: asked.append(args) or FOUND)
    return asked


def test_the_same_search_is_made_once(searches):
    first = find_grasp("phone", PAD, "auto", BUDGET)
    second = find_grasp("phone", PAD, "auto", BUDGET)
    assert len(searches) == 1
    assert (first.cached, second.cached) == (False, True)
    assert second.grasp == first.grasp == FOUND.grasp
    assert second.spent == 320


@pytest.mark.parametrize(
    ("obj", "topology", "presentation", "budget"),
    [
        ("screwdriver", PAD, "auto", BUDGET),
        ("phone", PALM, "auto", BUDGET),
        ("phone", PAD, "table", BUDGET),
        ("phone", PAD, "auto", replace(BUDGET, generations=4)),
        ("phone", PAD, "auto", replace(BUDGET, seed=1)),
        ("phone", PAD, "auto", replace(BUDGET, noise="hard")),
        ("phone", PAD, "auto", BUDGET.meeting("blind")),
    ],
)
def test_another_search_is_made_anew(searches, obj, topology, presentation, budget):
    find_grasp("phone", PAD, "auto", BUDGET)
    find_grasp(obj, topology, presentation, budget)
    assert len(searches) == 2


@pytest.mark.parametrize("change", [{"mass_kg": 0.2}, {"friction": 0.1}])
def test_a_changed_object_is_searched_anew(searches, monkeypatch, change):
    """The name is the same; what it weighs or is made of is not."""
    find_grasp("phone", PAD, "auto", BUDGET)
    other = replace(library.load("phone"), **change)
    monkeypatch.setattr(own_search.library, "load", lambda name: other)
    find_grasp("phone", PAD, "auto", BUDGET)
    assert len(searches) == 2


def test_changed_code_makes_old_grasps_void(searches, monkeypatch):
    find_grasp("phone", PAD, "auto", BUDGET)
    monkeypatch.setattr(own_search, "code_fingerprint", lambda: "other")
    find_grasp("phone", PAD, "auto", BUDGET)
    assert len(searches) == 2


def test_a_search_without_generations_is_refused():
    with pytest.raises(InputError, match="at least 1 generation, got 0"):
        SearchBudget(generations=0)


@pytest.mark.parametrize(
    ("noise", "hardened"), [("none", None), ("paper", None), ("hard", "blind"), ("blind", "blind")]
)
def test_grasps_that_will_meet_wide_noise_are_hardened(noise, hardened):
    assert BUDGET.meeting(noise).hardened == hardened


def test_a_noise_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match="unknown noise 'loud'"):
        BUDGET.meeting("loud")


def test_results_say_that_the_object_itself_was_searched():
    assert "searched on this very object (320 simulated trials, now)" in FOUND.note
    assert FOUND.summary()["trials"] == 320


@pytest.mark.parametrize(("noise", "most"), [("paper", 176), ("blind", 272)])
def test_a_search_counts_its_trials_and_stays_in_bounds(monkeypatch, noise, most):
    """In the simulator, small: every trial is counted, the grasp lies in the searched box, and
    the last trials meet the noise that the grasp is for."""
    spent, met = [], []
    trials = own_search.GraspTrials

    class Counting(trials):
        def run(self, pregrasp, *args, **kwargs):
            result = super().run(pregrasp, *args, **kwargs)
            spent.append(len(pregrasp))
            met.append(self.env.spec.kwargs["noise"])
            return result

    monkeypatch.setattr(own_search, "GraspTrials", Counting)
    monkeypatch.setattr(grasp_search, "PROVEN", 1.1)  # No start is so good.
    budget = SearchBudget(generations=1, num_envs=8, follow=True).meeting(noise)
    found = own_search.search("screwdriver", PAD, "auto", budget)
    assert sum(spent) == found.spent <= budget.trials == most
    assert (met[0], met[-1]) == ("paper", noise)
    pregrasp = np.array(found.grasp.pregrasp)
    assert (pregrasp >= PREGRASP_LOWER).all()
    assert (pregrasp <= PREGRASP_UPPER).all()
    assert found.grasp.trials == 8


def test_a_wide_search_that_came_to_little_is_repeated_from_other_starts(monkeypatch):
    rivals = []

    def wide(self, starts):
        rivals.append(starts)
        return starts[0]

    monkeypatch.setattr(grasp_search, "PROVEN", 1.1)  # No grasp is so good.
    monkeypatch.setattr(grasp_search, "GOOD_END", 1.1)
    monkeypatch.setattr(grasp_search.GraspSearch, "_wide", wide)
    own_search.search("screwdriver", PAD, "auto", SearchBudget(generations=1, num_envs=16))
    assert len(rivals) == grasp_search.WIDE_SEARCHES
    assert not np.allclose(rivals[0], rivals[1])
