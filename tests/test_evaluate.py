"""Laws of success tables: what is tried, with which seeds, and what the episodes add up to."""

import json
import math

import numpy as np
import pytest
import trimesh

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks.outcome import FAILURES
from maniskill_taskgrasp.topology import TOPOLOGY_NAMES, resolve_topology
from maniskill_taskgrasp.train import evaluate as evaluation
from maniskill_taskgrasp.train.batched_episodes import (
    Conditions,
    Episodes,
    Job,
    Trace,
    episode_seeds,
    jobs_at_once,
    run_jobs,
)
from maniskill_taskgrasp.train.cells import by_topology, measured_cell, overall, refused_cell
from maniskill_taskgrasp.train.evaluation_config import EvaluateConfig
from maniskill_taskgrasp.train.intervals import wilson_interval
from maniskill_taskgrasp.train.offers import Offer, list_offers
from maniskill_taskgrasp.train.paired import compare, compare_results
from maniskill_taskgrasp.train.tables import table_lines
from maniskill_taskgrasp.train.traces import file_label

PAD = resolve_topology("Precision pad abd 2-3")
PALM = resolve_topology("Power palm abd 2-5")
CELL_KEYS = {
    "topology",
    "object",
    "offered",
    "episodes",
    "successes",
    "rate",
    "ci95",
    "failures",
    "fidelity",
    "mean_force_n",
}
OVERALL_KEYS = {"offered", "objects", "episodes", "successes", "rate", "ci95"}


def offer(name="screwdriver", topology=PAD, offered=True, text=None):
    return Offer(name, name, topology, offered, "because", "table", text)


def episodes(lifted, form, failure, trace=None):
    return Episodes(
        lifted=[bool(x) for x in lifted],
        in_form=[bool(x) for x in form],
        failure=[FAILURES.index(name) for name in failure],
        lift_m=[0.25 if x else 0.01 for x in lifted],
        force_n=[10.0 if x else 1.0 for x in lifted],
        success=trace,
        miss=trace,
    )


MIXED = episodes([1, 1, 0, 0], [1, 0, 1, 0], ["none", "none", "slipped", "no_contact"])


# Seeds and batches


def test_seeds_do_not_depend_on_how_many_episodes_there_are():
    job = Job(PAD, "screwdriver", "screwdriver")
    assert episode_seeds(0, job, 100)[:7] == episode_seeds(0, job, 7)


@pytest.mark.parametrize(
    "other",
    [
        Job(PALM, "screwdriver", "screwdriver"),
        Job(PAD, "phone", "phone"),
        Job(PAD, "screwdriver", "screwdriver", text="hand me the screwdriver"),
    ],
)
def test_pairs_draw_different_noise(other):
    own = episode_seeds(0, Job(PAD, "screwdriver", "screwdriver"), 50)
    assert not set(own) & set(episode_seeds(0, other, 50))


def test_seeds_follow_the_evaluations_seed_and_do_not_repeat():
    job = Job(PAD, "screwdriver", "screwdriver")
    first, second = episode_seeds(0, job, 500), episode_seeds(1, job, 500)
    assert len({*first, *second}) == 1000


def test_the_path_of_a_mesh_does_not_decide_its_seeds():
    here, there = (Job(PAD, f"{folder}/mug.stl", "mug") for folder in ("a", "b"))
    assert episode_seeds(0, here, 5) == episode_seeds(0, there, 5)


@pytest.mark.parametrize(
    ("jobs", "number", "envs"), [(27, 100, 64), (1, 100, 64), (123, 100, 64), (4, 3, 64), (5, 1, 2)]
)
def test_scenes_never_hold_more_environments_than_asked_for(jobs, number, envs):
    size = jobs_at_once(jobs, number, envs)
    assert 1 <= size <= min(jobs, envs)
    assert size * min(number, envs // size) <= envs


def test_scenes_of_a_table_waste_little():
    """27 pairs x 100 episodes need at most a fifth more than the least number of batches."""
    size = jobs_at_once(27, 100, 64)
    rounds = math.ceil(27 / size) * math.ceil(100 / (64 // size))
    assert rounds <= 1.2 * math.ceil(27 * 100 / 64)


# What episodes add up to


def test_a_cell_counts_lift_form_failures_and_force():
    cell = measured_cell(offer(), MIXED)
    assert set(cell) >= CELL_KEYS
    assert (cell["episodes"], cell["successes"], cell["both"]) == (4, 2, 1)
    assert cell["rate"] == 0.5
    assert cell["ci95"] == [round(x, 4) for x in wilson_interval(2, 4)]
    assert cell["both_ci95"] == [round(x, 4) for x in wilson_interval(1, 4)]
    assert cell["failures"] == {"no_contact": 1, "slipped": 1}
    assert cell["fidelity"] == 0.5  # One of the two that were lifted.
    assert cell["mean_force_n"] == 10.0  # Of the lifted ones alone.
    assert (cell["lifted"], cell["in_form"]) == ("1100", "1010")


def test_form_without_a_lift_is_no_success():
    cell = measured_cell(offer(), episodes([0], [1], ["not_lifted"]))
    assert (cell["both"], cell["fidelity"], cell["mean_force_n"]) == (0, None, None)


def test_every_episode_is_a_lift_or_has_a_failure_class():
    cell = measured_cell(offer(), MIXED)
    assert cell["successes"] + sum(cell["failures"].values()) == cell["episodes"]


def test_what_is_not_offered_has_a_reason_and_no_rate():
    cell = refused_cell(offer(offered=False))
    assert set(cell) >= CELL_KEYS
    assert (cell["offered"], cell["episodes"], cell["rate"]) == (False, 0, None)
    assert cell["reason"] == "because"
    assert cell["ci95"] == [0.0, 1.0]


def test_the_whole_counts_objects_once_and_sums_cells():
    cells = [
        measured_cell(offer("phone"), MIXED),
        measured_cell(offer("phone", PALM), MIXED),
        refused_cell(offer("anvil", None, offered=False)),
    ]
    total = overall(cells)
    assert set(total) >= OVERALL_KEYS
    assert (total["offered"], total["objects"]) == (1, 2)
    assert (total["episodes"], total["successes"], total["both"]) == (8, 4, 2)
    assert total["failures"] == {"no_contact": 2, "slipped": 2}


def test_topologies_come_in_the_data_sets_order_and_hold_all_episodes():
    cells = [measured_cell(offer("phone", t), MIXED) for t in (PAD, PALM, PAD)]
    rows = by_topology(cells)
    assert [row["topology"] for row in rows] == [PALM.name, PAD.name]
    assert [(row["pairs"], row["episodes"]) for row in rows] == [(1, 4), (2, 8)]


def test_table_lines_name_every_cell_and_say_whether_grasps_were_searched():
    cells = [measured_cell(offer(), MIXED), refused_cell(offer("anvil", None, offered=False))]
    document = {"cells": cells, "overall": overall(cells)}
    text = "\n".join(table_lines(document))
    assert "2/4 =  50.0 %" in text
    assert "not tried: because" in text
    assert "nothing was searched on the evaluated objects" in text
    searched = {"generations": 4, "trials_per_pair": 384}
    text = "\n".join(table_lines(document | {"search": searched}))
    assert "searched on the evaluated object: 4 generations, 384 simulated trials" in text


# What is tried


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"episodes": 0}, "--episodes must be 1 or more, got 0"),
        ({"search": -1}, "--search must be 0 or more, got -1"),
        ({"num_envs": 0}, "--num-envs must be 1 or more, got 0"),
        ({"limit": 0}, "--limit must be 1 or more, got 0"),
        ({"table": "papper"}, "unknown table 'papper'"),
        ({"topologies": ("pinch",)}, "unknown topology 'pinch'"),
        ({"table": "paper", "objects": ("mug",)}, "--objects and --table"),
        ({"table": "paper", "topologies": ("all",)}, "--topologies does not go with"),
    ],
)
def test_nonsense_is_refused_before_anything_runs(given, message):
    with pytest.raises(InputError, match=message):
        EvaluateConfig(**given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"objects": ("nosuch",)}, "nosuch"),
        ({"objects": ("phone",), "noise": "loud"}, "unknown noise 'loud'"),
        ({"objects": ("phone",), "presentation": "sky"}, "unknown presentation 'sky'"),
    ],
)
def test_unknown_names_are_refused_before_anything_runs(given, message):
    with pytest.raises(InputError, match=message):
        list_offers(EvaluateConfig(topologies=(PAD.name,), **given))


def test_tables_are_the_committed_lists():
    assert len(list_offers(EvaluateConfig(table="paper"))) == 27
    few = list_offers(EvaluateConfig(table="paper", limit=9))
    assert len(few) == len({o.topology for o in few}) == 9  # Evenly from the whole list.


def test_named_topologies_are_tried_on_all_objects_that_fit():
    offers = list_offers(EvaluateConfig(topologies=("all",), objects=("metal slab", "phone")))
    assert len(offers) == 2 * len(TOPOLOGY_NAMES)
    refused = [o for o in offers if o.object == "metal slab" and not o.offered]
    assert len(refused) == len(TOPOLOGY_NAMES)  # It weighs a kilogramme.
    assert all(o.reason for o in refused)


def test_the_selector_offers_at_most_one_topology_an_object():
    offers = list_offers(EvaluateConfig(objects=("screwdriver", "metal slab")))
    assert [(o.object, o.offered) for o in offers] == [("screwdriver", True), ("metal slab", False)]
    assert offers[0].topology is not None
    assert offers[1].topology is None


def test_a_folder_without_meshes_is_refused(tmp_path):
    with pytest.raises(InputError, match="no mesh in"):
        list_offers(EvaluateConfig(mesh_dir=tmp_path))


def test_meshes_that_share_a_name_are_told_apart(tmp_path):
    trimesh.creation.box((0.03, 0.04, 0.1)).export(tmp_path / "block.stl")
    trimesh.creation.cylinder(0.02, 0.1).export(tmp_path / "block.ply")
    offers = list_offers(EvaluateConfig(mesh_dir=tmp_path))
    assert [offer.object for offer in offers] == ["block", "block 2"]
    assert len({offer.source for offer in offers}) == 2


def test_a_wrong_distance_is_refused_before_a_folder_is_made(tmp_path):
    config = EvaluateConfig(objects=("hammer",), distance="weird", out=tmp_path / "out")
    with pytest.raises(InputError, match="--distance must be one of exact, noisy, none"):
        evaluation.evaluate(config)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("content", ["{", "{}", "[]"])
def test_damaged_results_are_refused_in_one_line(tmp_path, content):
    (tmp_path / "results.json").write_text(content)
    config = EvaluateConfig(objects=("hammer",), episodes=1, out=tmp_path)
    with pytest.raises(InputError, match="is damaged: remove it"):
        evaluation.evaluate(config)


def test_pictures_of_sentences_about_one_object_have_names_of_their_own():
    start = "please " * 30
    labels = {file_label("cup", text) for text in ("", f"{start}lift it", f"{start}hand it over")}
    assert len(labels) == 3


def test_sentences_are_understood_or_refused_with_a_reason(tmp_path):
    """A sentence whose object is taken for another counts as refused, not as tried."""
    path = tmp_path / "sentences.jsonl"
    rows = [
        {"text": "hand me the screwdriver", "objects": ["screwdriver"]},
        {"text": "hand me the screwdriver please", "objects": ["phone"]},
        {"text": "what a fine day", "objects": ["phone"]},
        {"text": "fold the towel", "objects": ["towel"]},  # Not carried: left out.
    ]
    path.write_text("\n".join(map(json.dumps, rows)), "utf-8")
    offers = list_offers(EvaluateConfig(instructions=path))
    assert [o.offered for o in offers] == [True, False, False]
    assert offers[1].reason == "meant was phone"


# Going on, and files


@pytest.fixture
def simulated(monkeypatch):
    """Stands for the simulator: four mixed episodes a job; counts what was asked for."""
    asked = []

    def fake(jobs, conditions):
        asked.extend((job.topology.name, job.name) for job in jobs)
        trace = Trace(5, *(np.zeros((92, *shape)) for shape in ((5, 3), (7,), (6,))))
        trace.obj[:, 3] = 1.0
        trace.tips[:] = np.arange(15).reshape(5, 3) / 100
        return [episodes([1, 1, 0, 0], [1, 0, 1, 0], MIXED_NAMES, trace) for _ in jobs]

    monkeypatch.setattr(evaluation, "run_jobs", fake)
    return asked


MIXED_NAMES = ["none", "none", "slipped", "no_contact"]


def config(tmp_path, objects=("screwdriver",), **given):
    return EvaluateConfig(
        topologies=(PAD.name,), objects=objects, episodes=4, out=tmp_path / "out", **given
    )


def test_results_are_written_and_are_what_is_returned(simulated, tmp_path):
    document = evaluation.evaluate(config(tmp_path))
    assert json.loads((tmp_path / "out" / "results.json").read_text("utf-8")) == document
    assert document["config"]["complete"] is True
    assert simulated == [(PAD.name, "screwdriver")]


def test_an_evaluation_goes_on_where_it_stopped(simulated, monkeypatch, tmp_path):
    """Cells in the folder are kept: killed after the first pair, only the second is run again."""
    both = config(tmp_path, ("screwdriver", "phone"), num_envs=1)
    fake, runs = evaluation.run_jobs, []

    def killed(jobs, conditions):
        if runs:
            raise KeyboardInterrupt
        runs.append(1)
        return fake(jobs, conditions)

    monkeypatch.setattr(evaluation, "run_jobs", killed)
    with pytest.raises(KeyboardInterrupt):
        evaluation.evaluate(both)
    half = json.loads((both.out / "results.json").read_text("utf-8"))
    assert (len(half["cells"]), half["config"]["complete"]) == (1, False)
    monkeypatch.setattr(evaluation, "run_jobs", fake)
    whole = evaluation.evaluate(both)
    assert (len(whole["cells"]), whole["config"]["complete"]) == (2, True)
    assert simulated == [(PAD.name, "screwdriver"), (PAD.name, "phone")]


@pytest.mark.parametrize("given", [{"seed": 1}, {"noise": "hard"}, {"presentation": "table"}])
def test_results_of_other_settings_are_never_mixed(simulated, tmp_path, given):
    evaluation.evaluate(config(tmp_path))
    with pytest.raises(InputError, match=f"other {next(iter(given))}"):
        evaluation.evaluate(config(tmp_path, **given))


def test_sentences_without_a_grasp_count_as_failed(simulated, tmp_path):
    path = tmp_path / "sentences.txt"
    path.write_text("hand me the screwdriver\nwhat a fine day\n", "utf-8")
    document = evaluation.evaluate(EvaluateConfig(instructions=path, episodes=4))
    assert document["overall"]["rate"] == 0.5
    assert (document["instructions"]["episodes"], document["instructions"]["rate"]) == (8, 0.25)


def test_the_report_stands_alone_and_names_all_cells(simulated, monkeypatch, tmp_path):
    """One page: pictures are inside, nothing is fetched; the same pictures lie beside it."""
    from maniskill_taskgrasp.train import report

    monkeypatch.setattr(report, "rendering_available", lambda: False)
    evaluation.evaluate(config(tmp_path, ("screwdriver", "metal slab")))
    page = report.write_report(tmp_path / "out").read_text("utf-8")
    assert "http" not in page
    assert "<script" not in page
    assert page.count('src="data:image/png;base64,') == page.count("src=") == 3
    for text in ("screwdriver", PAD.name, "50.0 %", "metal slab", "carries at most"):
        assert text in page
    assert {p.name for p in (tmp_path / "out" / "pictures").iterdir()} >= {
        "heat_map.png",
        "failures.png",
    }


def test_a_report_needs_results(tmp_path):
    from maniskill_taskgrasp.train.report import write_report

    with pytest.raises(InputError, match=r"no results\.json"):
        write_report(tmp_path)


# Paired comparison


def test_comparison_counts_only_disagreements():
    """McNemar, by hand: 6 against 1 of 7 disagreements has p = 2 (1 + 7) / 2^7 = 0.125."""
    found = compare("1111110" + "1" * 5 + "0" * 3, "0000001" + "1" * 5 + "0" * 3)
    assert (found.only_a, found.only_b) == (6, 1)
    assert found.p == pytest.approx(0.125)
    assert found.difference == pytest.approx(5 / 15)
    assert found.ci95[0] < found.difference < found.ci95[1]


def test_comparison_with_itself_finds_nothing():
    same = compare("1010", "1010")
    assert (same.difference, same.p, same.ci95) == (0.0, 1.0, (0.0, 0.0))


def test_comparison_is_antisymmetric():
    there, back = compare("1101", "0110"), compare("0110", "1101")
    assert there.difference == -back.difference
    assert there.p == back.p


def test_only_paired_evaluations_are_compared(simulated, tmp_path):
    first = evaluation.evaluate(EvaluateConfig(topologies=(PAD.name,), objects=("phone",)))
    other = evaluation.evaluate(EvaluateConfig(topologies=(PAD.name,), objects=("phone",), seed=1))
    assert compare_results(first, first)["lift"].episodes == 4
    with pytest.raises(InputError, match="not paired: seed differ"):
        compare_results(first, other)


# The simulator itself


def test_outcomes_do_not_depend_on_what_runs_beside_them():
    """The same pair gives the same episodes alone and beside another pair."""
    from maniskill_taskgrasp.tasks.closing import ConstantClosing

    conditions = Conditions(
        episodes=2,
        noise="paper",
        presentation="auto",
        seed=0,
        num_envs=4,
        make_policy=ConstantClosing,
        env_kwargs={"obs": "paper"},
    )
    screwdriver, phone = Job(PAD, "screwdriver", "screwdriver"), Job(PALM, "phone", "phone")
    alone = run_jobs([screwdriver], conditions)[0]
    beside = run_jobs([phone, screwdriver], conditions)[1]
    assert len(alone) == len(beside) == 2
    assert alone.failure == beside.failure
    np.testing.assert_allclose(alone.lift_m, beside.lift_m, atol=1e-3)
