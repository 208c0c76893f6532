"""Laws of the rule that says which test objects an evaluation asks of which topology."""

import json
from dataclasses import replace
from importlib.resources import files

import pytest

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.knowledge import Knowledge, load_knowledge
from maniskill_taskgrasp.selection.feasibility import hand_limits
from maniskill_taskgrasp.topology import TOPOLOGIES, resolve_topology
from maniskill_taskgrasp.train.compatibility import (
    PAIRS_FILE,
    PAPER_TOPOLOGIES,
    PER_TOPOLOGY,
    committed_pairs,
    compatible_pairs,
    dump,
    to_json,
    topology_rows,
)

PAD = resolve_topology("Precision pad abd 2-3")


@pytest.fixture(scope="module")
def lists():
    knowledge = load_knowledge()
    return compatible_pairs([knowledge.objects[n] for n in library.names("test")], knowledge)


def things(**rows):
    """Knowledge of made-up objects, alike but for their rows in `PAD`."""
    pattern = load_knowledge().objects["screwdriver"]
    objects = {name: replace(pattern, name=name) for name in rows}
    counts = {}
    for name, count in rows.items():
        row = [0] * len(TOPOLOGIES)
        row[PAD.index] = count
        counts[(name, "holding")] = tuple(row)
    return Knowledge(objects=objects, actions={}, pair_counts=counts)


def of(pairs, topology):
    return [pair for pair in pairs if pair.topology == topology.name]


def test_committed_lists_are_what_the_rule_gives(lists):
    """The lists were committed before training; a later change of rule or limits shows here."""
    text = files("maniskill_taskgrasp.assets").joinpath(PAIRS_FILE).read_text("utf-8")
    assert text == dump(to_json(lists))
    assert json.loads(text)["paper"]


def test_table_one_has_nine_topologies_with_three_objects_each():
    pairs = committed_pairs("paper")
    assert {pair.topology for pair in pairs} == {t.name for t in PAPER_TOPOLOGIES}
    assert len(PAPER_TOPOLOGIES) == 9
    assert all(len(of(pairs, topology)) == PER_TOPOLOGY for topology in PAPER_TOPOLOGIES)
    assert len({(pair.topology, pair.object) for pair in pairs}) == 27


def test_table_one_asks_for_at_least_seventeen_objects():
    assert len({pair.object for pair in committed_pairs("paper")}) >= 17


@pytest.mark.parametrize("table", ["paper", "feasible"])
def test_only_test_objects_are_asked_for(table):
    assert {pair.object for pair in committed_pairs(table)} <= set(library.names("test"))


def test_table_one_is_part_of_the_feasible_pairs():
    wide = {(pair.topology, pair.object) for pair in committed_pairs("feasible")}
    assert {(pair.topology, pair.object) for pair in committed_pairs("paper")} <= wide


def test_every_topology_is_asked_for():
    """Every topology that the hand can form."""
    formed = {t.name for t in TOPOLOGIES} - set(hand_limits().unformed)
    assert {pair.topology for pair in committed_pairs("feasible")} == formed


def test_at_least_half_of_the_label_sets_is_kept_and_the_rest_is_listed(lists):
    """Every pair that people were seen to use is either kept or excluded with a reason."""
    knowledge = load_knowledge()
    seen = sum(count > 0 for n in library.names("test") for count in topology_rows(knowledge, n))
    kept = sum(pair.rows > 0 for pair in lists.feasible)
    assert kept + len(lists.excluded) == seen
    assert kept >= 0.5 * seen
    assert all(pair.reason for pair in lists.excluded)


def test_excluded_pairs_name_the_number_that_decides(lists):
    heavy = [p for p in lists.excluded if p.object == "base of handle"]
    assert heavy
    assert all("700 g" in pair.reason for pair in heavy)


def test_most_rows_come_first_and_ties_go_by_name():
    knowledge = things(few=1, most=9, some=4, also=4)
    pairs = of(compatible_pairs(list(knowledge.objects.values()), knowledge).paper, PAD)
    assert [pair.object for pair in pairs] == ["most", "also", "some"]


def test_ties_go_to_objects_that_are_not_in_the_table_yet():
    """What the table's first topology had to leave out comes first in its second."""
    knowledge = things(a=2, b=2, c=2, d=2)
    paper = compatible_pairs(list(knowledge.objects.values()), knowledge).paper
    first, second = (of(paper, topology) for topology in PAPER_TOPOLOGIES[:2])
    assert [pair.object for pair in first] == ["a", "b", "c"]
    assert [pair.object for pair in second] == ["d", "a", "b"]


def test_fitting_objects_fill_a_topology_that_people_were_not_seen_to_use():
    knowledge = things(seen=3, unseen=0, other=0, another=0)
    lists = compatible_pairs(list(knowledge.objects.values()), knowledge)
    chosen = of(lists.feasible, PAD)
    assert len(chosen) == PER_TOPOLOGY
    assert [pair.rows for pair in chosen] == [3, 0, 0]


def test_what_does_not_fit_is_never_used_to_fill():
    knowledge = things(seen=3, unseen=0)
    heavy = replace(knowledge.objects["unseen"], mass_kg=5.0)
    objects = [knowledge.objects["seen"], heavy]
    lists = compatible_pairs(objects, knowledge)
    assert [pair.object for pair in of(lists.feasible, PAD)] == ["seen"]
