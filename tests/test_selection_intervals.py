"""How sure a figure is: closed forms on groups small enough to check by hand."""

import numpy as np
import pytest

from maniskill_taskgrasp.selection.intervals import calibration_floor, group_interval, label_noise


def test_equal_groups_leave_no_doubt():
    """Where all groups score the same, drawing others changes nothing."""
    group = np.repeat(np.arange(6), 5)
    values = np.tile([1.0, 0.0, 0.0, 0.0, 1.0], 6)
    assert group_interval(values, group, np.repeat([0, 1], 15)) == pytest.approx([0.4, 0.4])


def test_interval_counts_groups_not_rows():
    """400 groups with half of them right: 1.96 deviations of 0.5 / 20, however many rows each."""
    values = np.tile([0.0, 1.0], 200)
    for rows in (1, 25):
        repeated = np.repeat(values, rows)
        group = np.repeat(np.arange(400), rows)
        low, high = group_interval(repeated, group, np.zeros(len(group), int))
        assert low == pytest.approx(0.5 - 1.96 * 0.025, abs=0.005)
        assert high == pytest.approx(0.5 + 1.96 * 0.025, abs=0.005)


def test_folds_count_alike():
    """The figure is the mean of fold means, so a large fold weighs no more than a small one."""
    values, fold = np.array([1.0] * 90 + [0.0] * 10), np.array([0] * 90 + [1] * 10)
    assert group_interval(values, np.arange(100), fold) == pytest.approx([0.5, 0.5])


def test_label_noise_closed_form():
    """Two folds of one pair each: root of the mean variances over rows, over two folds."""
    values = np.array([1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0])
    pairs, fold = np.repeat([0, 1], 4), np.repeat([0, 1], 4)
    variances = np.var(values[:4], ddof=1) / 4 + np.var(values[4:], ddof=1) / 4
    assert label_noise(values, pairs, fold) == pytest.approx(np.sqrt(variances) / 2)
    assert label_noise(np.ones(8), pairs, fold) == 0


def test_single_rows_show_no_label_noise():
    """One row says nothing of how its pair varies; the rest still counts."""
    values = np.array([1.0, 0.0, 1.0])
    assert label_noise(values, np.arange(3), np.zeros(3, int)) == 0


def test_one_group_alone_cannot_look_calibrated():
    """The gap of a single group keeps its size whatever its sign."""
    confidence, correct = np.full(10, 0.35), np.repeat([1.0, 0.0], [6, 4])
    mean, high = calibration_floor(confidence, correct, np.zeros(10, int))
    assert (mean, high) == pytest.approx((0.25, 0.25))


def test_many_groups_average_out():
    """Gaps of +-0.3 in 900 groups of one bin leave about 0.3 * sqrt(2 / pi) / 30."""
    correct = np.zeros(900)
    mean, high = calibration_floor(np.full(900, 0.3), correct, np.arange(900))
    assert mean == pytest.approx(0.3 * np.sqrt(2 / np.pi) / 30, rel=0.1)
    assert high > mean
