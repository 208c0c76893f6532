"""Laws of the way from a sentence to a choice of grasp."""

import pytest

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.pipeline import (
    GraspOptions,
    Pipeline,
    RankedTopology,
    Selection,
    choose_topology,
)
from maniskill_taskgrasp.topology import TOPOLOGY_NAMES


def selection(*feasible):
    ranked = [
        RankedTopology(name, 0.5 - 0.01 * i, able, "reason")
        for i, (name, able) in enumerate(zip(TOPOLOGY_NAMES, feasible, strict=False))
    ]
    return Selection(text="x", object="thing", topologies=ranked)


def test_choose_topology_takes_the_likeliest_that_the_hand_can_do():
    assert choose_topology(selection(False, True, True), None).name == TOPOLOGY_NAMES[1]


def test_choose_topology_obeys_the_user():
    assert choose_topology(selection(True, True), TOPOLOGY_NAMES[7]).name == TOPOLOGY_NAMES[7]


def test_choose_topology_says_why_nothing_fits():
    with pytest.raises(InputError, match=r"'thing' in none of the 15 topologies \(reason\)"):
        choose_topology(selection(False, False), None)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"episodes": 0}, "episodes must be at least 1, got 0"),
        ({"seed": -1}, "seed must be from 0 to 2"),
        ({"topology": "precision pad abd 2-9"}, "unknown topology 'precision pad abd 2-9'"),
    ],
)
def test_options_refuse_nonsense_before_anything_runs(options, message):
    with pytest.raises(InputError, match=message):
        GraspOptions(**options)


def test_select_ranks_all_topologies_and_never_contradicts_itself():
    """Opposition and PIP are sums of the 15 probabilities, which sum to 1."""
    answer = Pipeline().select("wipe the table with the sponge")
    assert (answer.action, answer.object) == ("wiping", "sponge")
    probabilities = [ranked.probability for ranked in answer.topologies]
    assert len(probabilities) == 15
    assert probabilities == sorted(probabilities, reverse=True)
    for shares in (probabilities, answer.opposition.values(), answer.pip.values()):
        assert sum(shares) == pytest.approx(1, abs=2e-3)


def test_select_transfer_says_what_decided():
    answer = Pipeline().select("hand me the screwdriver")
    assert answer.action is None
    assert answer.object == "screwdriver"
    assert any("transfer" in note for note in answer.notes)


@pytest.mark.parametrize("text", ["", "   ", "xyzzy", "what is the capital of France?"])
def test_select_rejects_with_a_reason(text):
    answer = Pipeline().select(text)
    assert answer.rejected
    assert answer.reason
    assert "\n" not in answer.reason
