"""Splits and scores: the protocol's arithmetic on tables small enough to check by hand."""

import numpy as np
import pytest

from maniskill_taskgrasp.selection import metrics
from maniskill_taskgrasp.selection.dataset import load_table
from maniskill_taskgrasp.selection.splits import SPLITS, deal, folds_of, group_of_rows
from maniskill_taskgrasp.topology import TOPOLOGIES

PRIOR_OWN1 = {"random": 24.6, "pairs": 25.1, "objects": 24.6, "actions": 26.6}
"""Row-weighted own@1 [%] of the global prior, as first measured on these splits."""


@pytest.fixture(scope="module")
def table(shared_dir):
    return load_table(shared_dir / "data" / "task-object_grasp_dataset.csv").without_platform()


def test_per_row_by_hand():
    """One row whose every metric is known."""
    scores = np.full((1, 15), 0.01)
    scores[0, [1, 4, 9]] = 0.4, 0.3, 0.2  # Power palm, power pad, precision pad.
    labels = np.zeros((1, 15), bool)
    labels[0, [4, 7, 9, 12]] = True
    value = {k: float(v[0]) for k, v in metrics.per_row(scores, np.array([4]), labels).items()}
    assert value["hit@1"] == 0
    assert value["match@3"] == pytest.approx(2 / 3)
    assert value["any@3"] == 1
    assert value["P@3"] == pytest.approx(2 / 3)
    assert (value["own@1"], value["own@3"]) == (0, 1)
    assert value["o"] == 1  # Pad 0.3 + 0.2 + ... beats palm 0.4 + 0.02.
    assert value["p"] == 1  # Power 0.4 + 0.3 beats precision.
    assert value["NLL"] == pytest.approx(-np.log(0.3 / scores.sum()))


def test_match3_of_a_small_set_can_be_perfect():
    """A set of one label is matched fully when it is among the three best."""
    scores = np.linspace(1, 0.1, 15)[None]
    labels = np.zeros((1, 15), bool)
    labels[0, 2] = True
    assert metrics.per_row(scores, np.array([2]), labels)["match@3"][0] == 1


def test_marginals_are_sums():
    """Opposition and PIP sums of a distribution each sum to 1 and follow the topologies' names."""
    scores = np.random.default_rng(0).dirichlet(np.ones(15), 50)
    for group_of in (metrics.OPPOSITION_OF, metrics.PIP_OF):
        np.testing.assert_allclose(metrics.marginal(scores, group_of).sum(1), 1)
    side = [t.index for t in TOPOLOGIES if t.opposition == "Side"]
    np.testing.assert_allclose(
        metrics.marginal(scores, metrics.OPPOSITION_OF)[:, 2], scores[:, side].sum(1)
    )


def test_calibration_error_closed_form():
    """Right 70 % of the time at confidence 0.9 is an error of 0.2; at 0.7 of 0."""
    correct = np.repeat([1.0, 0.0], [70, 30])
    assert metrics.calibration_error(np.full(100, 0.9), correct) == pytest.approx(0.2)
    assert metrics.calibration_error(np.full(100, 0.7), correct) == pytest.approx(0.0)


def test_pair_weights_give_each_pair_the_same_total():
    """Weights of a pair's rows sum to 1, whatever their number."""
    pairs = np.array([0, 0, 0, 1, 2, 2])
    weights = metrics.pair_weights(pairs)
    np.testing.assert_allclose(np.bincount(pairs, weights), 1)


def test_micro_scores_by_hand():
    """Two right of three predicted, of four in the sets."""
    predicted = np.array([[1, 1, 0, 0], [0, 0, 1, 0]], bool)
    truth = np.array([[1, 0, 1, 0], [0, 0, 1, 1]], bool)
    assert metrics.micro_scores(predicted, truth) == pytest.approx((2 / 3, 1 / 2, 4 / 7))


def test_deal_is_even_and_fixed():
    """Groups are dealt evenly, rows of a group stay together, the deal never changes."""
    group = np.repeat(np.arange(23), 3)
    fold = deal(group)
    assert all(len(set(fold[group == g])) == 1 for g in range(23))
    assert np.ptp(np.bincount(fold[::3])) <= 1
    np.testing.assert_array_equal(fold, deal(group))


@pytest.mark.parametrize("split", SPLITS)
def test_nothing_held_out_is_in_training(table, split):
    """No group of the split has rows on both sides; grouped folds cover every row once."""
    group = group_of_rows(table, split)
    tests = []
    for train, test in folds_of(table, split):
        assert not (train & test).any()
        assert (train | test).all()
        assert not np.isin(group[test], group[train]).any()
        tests.append(test)
    if split == "random":
        assert [test.sum() for test in tests] == [649] * 5
    else:
        np.testing.assert_array_equal(np.sum(tests, 0), 1)


@pytest.mark.parametrize("split", SPLITS)
def test_splits_are_those_of_the_published_baselines(table, split):
    """The global prior scores what it scored when the protocol was fixed."""
    values = []
    for train, test in folds_of(table, split):
        prior = np.bincount(table.topology[train], minlength=15)[None].repeat(test.sum(), 0)
        rows = metrics.per_row(prior.astype(float), table.topology[test], table.label_sets[test])
        values.append(rows["own@1"].mean())
    assert 100 * np.mean(values) == pytest.approx(PRIOR_OWN1[split], abs=0.05)
