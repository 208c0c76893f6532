"""Laws of the wide search."""

import numpy as np

from maniskill_taskgrasp.tasks.cross_entropy import PATIENCE, SearchSpace, cross_entropy

SPACE = SearchSpace(
    lower=np.full(3, -2.0),
    upper=np.full(3, 2.0),
    spread=np.full(3, 1.0),
    floor=np.full(3, 0.01),
)
TARGET = np.array([0.7, -1.2, 1.9])


def bowl(candidates):
    return -((candidates - TARGET) ** 2).sum(1)


def search(score, seed=0, **kwargs):
    rng = np.random.default_rng(seed)
    start = np.zeros((1, 3))
    return cross_entropy(score, start, SPACE, rng, population=40, generations=12, **kwargs)


def test_cross_entropy_finds_the_top_of_a_smooth_hill():
    best, _ = search(bowl)
    np.testing.assert_allclose(best, TARGET, atol=0.1)


def test_cross_entropy_stays_in_the_box():
    """A hill outside the box is approached up to the wall, never beyond."""
    best, history = search(lambda c: c.sum(1))
    assert (history[:, :3] <= 2.0).all() and (history[:, :3] >= -2.0).all()
    assert best.min() > 1.5


def test_cross_entropy_same_seed_same_answer():
    np.testing.assert_array_equal(search(bowl, 3)[0], search(bowl, 3)[0])
    assert not np.array_equal(search(bowl, 3)[0], search(bowl, 4)[0])


def test_cross_entropy_looks_wide_first():
    """`first` populations are tried before anything is learned from them."""
    _, history = search(bowl, first=3)
    assert len(history) == 40 * (12 + 2)
    assert history[:120, :3].std() > 3 * history[-40:, :3].std(axis=0).mean()


def test_cross_entropy_does_not_average_basins():
    """Of two hills, one on each side, the higher one is climbed, not the valley between."""
    left, right = np.full(3, -1.5), np.full(3, 1.5)

    def hills(candidates):
        heights = [np.exp(-4 * ((candidates - top) ** 2).sum(1)) for top in (left, right)]
        return heights[0] + 1.2 * heights[1]

    rng = np.random.default_rng(0)
    best, _ = cross_entropy(
        hills, np.stack([left, right]), SPACE, rng, population=40, generations=8
    )
    np.testing.assert_allclose(best, right, atol=0.1)


def test_cross_entropy_stops_when_a_generation_is_good_enough():
    _, history = search(bowl, enough=-0.5)
    assert len(history) < 40 * 12
    assert history[-40:, 3].mean() >= -0.5


def test_cross_entropy_gives_up_where_nothing_ever_scores():
    _, history = search(lambda c: np.zeros(len(c)), hopeless=1.0)
    assert len(history) == 40 * PATIENCE
