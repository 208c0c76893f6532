"""The shipped selector: what `Selector.load` and `rank` promise the rooms that use them."""

import dataclasses
import subprocess
import sys
import time
from importlib.resources import files

import numpy as np
import pytest

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import Affordance, load_knowledge
from maniskill_taskgrasp.selection import Selector
from maniskill_taskgrasp.selection.mixture import shrunk

MUG = Affordance("my own mug", (0.12, 0.09, 0.08), 0.3, "b/c", "rigid", "a", "prolate", "cylinder")


@pytest.fixture(scope="module")
def selector():
    return Selector.load()


def test_rank_is_one_distribution(selector):
    """Topologies, oppositions and PIP classes are sums of the same 15 numbers."""
    strategy = selector.rank("screwdriver", "turning")
    assert len(strategy.probabilities) == 15
    assert sum(strategy.probabilities) == pytest.approx(1)
    assert min(strategy.probabilities) > 0
    assert sum(strategy.opposition.values()) == pytest.approx(1)
    assert sum(strategy.pip.values()) == pytest.approx(1)
    ranked = [strategy.probabilities[t.index] for t in strategy.ranked()]
    assert ranked == sorted(ranked, reverse=True)


def test_rank_follows_strong_evidence(selector):
    """Where people were seen often, their commonest grasp comes first and evidence counts rows."""
    knowledge = load_knowledge()
    for pair, counts in knowledge.pair_counts.items():
        if sum(counts) >= 100:
            strategy = selector.rank(*pair)
            assert strategy.evidence == sum(counts)
            assert strategy.ranked()[0].index == int(np.argmax(counts))


def test_transfer_request_is_the_mixture_of_the_objects_own_actions(selector):
    """rank(object, None) equals the weighted mean of rank(object, action)."""
    weights = load_knowledge().actions_of("hammer")
    parts = [np.array(selector.rank("hammer", action).probabilities) for action in weights]
    mean = np.average(parts, axis=0, weights=list(weights.values()))
    np.testing.assert_allclose(selector.rank("hammer", None).probabilities, mean, atol=1e-6)
    np.testing.assert_allclose(selector.rank("hammer", weights).probabilities, mean, atol=1e-6)


def test_parameters_tell_actions_apart_and_nothing_else(selector):
    """They move a mixture towards the actions that have them, and leave a known action alone."""
    contact = {"force": "interaction", "task_class": "use"}
    known = selector.rank("screwdriver", "turning")
    assert selector.rank("screwdriver", "turning", contact).probabilities == known.probabilities
    even = {"turning": 1.0, "holding": 1.0}
    turning = np.array(known.probabilities)

    def distance(parameters):
        return np.abs(selector.rank("screwdriver", even, parameters).probabilities - turning).sum()

    assert distance(contact) < distance(None)
    assert distance({"force": "weight", "task_class": "hold"}) > distance(None)


def test_unknown_name_is_placed_by_its_vector(selector):
    """With an encoder a new name is used: a synonym's vector gives the synonym's answer."""
    vectors = {"my own mug": selector._describer.object_names.known["mug"]}
    reader = Selector.load(encode=vectors.__getitem__)
    blank, placed = selector.rank(MUG, "drinking"), reader.rank(MUG, "drinking")
    named = dataclasses.replace(MUG, name="mug")
    goal = np.array(selector.parts([(named, "drinking")])[1])
    found = np.array(reader.parts([(MUG, "drinking")])[1])
    np.testing.assert_allclose(found, goal, atol=1e-9)
    assert blank.probabilities != placed.probabilities


def test_imported_object_is_ranked_without_evidence(selector):
    """An object nobody filmed still gets a distribution, with evidence 0."""
    for action in ("drinking", None):
        strategy = selector.rank(MUG, action)
        assert strategy.evidence == 0
        assert sum(strategy.probabilities) == pytest.approx(1)


def test_a_transfer_of_any_object_is_ranked(selector):
    """Also of the three whose rows are all of the open palm, which is no topology."""
    for name in load_knowledge().objects:
        assert sum(selector.rank(name, None).probabilities) == pytest.approx(1)


def test_every_known_pair_of_names_is_ranked(selector):
    """No name of the data set is refused, floppy objects included."""
    knowledge = load_knowledge()
    for name in knowledge.objects:
        assert np.isfinite(selector.rank(name, "holding").probabilities).all()
    for name in knowledge.actions:
        assert np.isfinite(selector.rank("towel", name).probabilities).all()


@pytest.mark.parametrize(
    ("obj", "action", "parameters"),
    [
        ("hamer", "turning", None),
        ("hammer", "hamering", None),
        ("hammer", {"turning": -1.0}, None),
        ("hammer", {"turning": float("nan")}, None),
        ("hammer", {}, None),
        ("hammer", {"turning": 0.0}, None),
        ("hammer", "turning", {"force": "enormous"}),
        ("hammer", "turning", {"speed": "fast"}),
    ],
)
def test_bad_input_is_one_line(selector, obj, action, parameters):
    """A name or weight that cannot be used is refused with one line."""
    with pytest.raises(InputError) as caught:
        selector.rank(obj, action, parameters)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "damage", ["missing", "empty", "truncated", "text", "other", "array", "header"]
)
def test_bad_checkpoint_is_input_error(tmp_path, damage):
    """A missing, damaged or foreign file never becomes a selector."""
    path = tmp_path / "selector.npz"
    if damage == "empty":
        path.write_bytes(b"")
    elif damage == "truncated":
        whole = (
            files("maniskill_taskgrasp.assets").joinpath("checkpoints/selector.npz").read_bytes()
        )
        path.write_bytes(whole[: len(whole) // 2])
    elif damage == "text":
        path.write_text("not a checkpoint")
    elif damage == "other":
        np.savez(path, agent=np.zeros(3))
    elif damage == "array":
        np.save(path.open("wb"), np.zeros(3))
    elif damage == "header":
        np.savez(path, header=np.array("[1, 2]"))
    with pytest.raises(InputError) as caught:
        Selector.load(path)
    assert "\n" not in str(caught.value)


def test_shrunk_closed_form():
    """No rows give the model, many rows their frequencies, a rows the halfway point."""
    model = np.full(15, 1 / 15)
    counts = np.zeros(15)
    np.testing.assert_allclose(shrunk(counts, model, 3.0), model)
    counts[4] = 3
    np.testing.assert_allclose(shrunk(counts, model, 3.0)[4], (3 + 3 / 15) / 6)
    np.testing.assert_allclose(shrunk(counts * 1e9, model, 3.0)[4], 1, atol=1e-6)


def test_one_selection_is_fast(selector):
    """A selection takes at most 5 ms of one core, the median of many (other programs may run)."""
    times = []
    for _ in range(101):
        start = time.process_time()
        selector.rank("towel", "turning")
        times.append(time.process_time() - start)
    assert np.median(times) <= 0.005


def test_loading_imports_neither_simulator_nor_torch():
    """The front end starts without ManiSkill, and in a tenth of the time that torch would take."""
    code = (
        "import sys; from maniskill_taskgrasp.selection import Selector; "
        "Selector.load().rank('towel', 'wiping'); "
        "sys.exit(any(m in sys.modules for m in ('mani_skill', 'sapien', 'sklearn', 'torch')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
