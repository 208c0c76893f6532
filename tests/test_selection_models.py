"""The networks and their training: laws that hold on tables small enough to fit in a second."""

import json
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.selection import learning, targets
from maniskill_taskgrasp.selection.baselines import by_object, by_pair, prior
from maniskill_taskgrasp.selection.dataset import load_table
from maniskill_taskgrasp.selection.ensemble import tempered
from maniskill_taskgrasp.selection.evidence import condense, fit_describer
from maniskill_taskgrasp.selection.features import NAME_WIDTH, Describer
from maniskill_taskgrasp.selection.fit import EnsembleConfig, fit_ensemble
from maniskill_taskgrasp.selection.kernel import KernelConfig, kernel
from maniskill_taskgrasp.selection.kernel_fit import fit_kernel_network
from maniskill_taskgrasp.selection.models import all_models
from maniskill_taskgrasp.selection.names import name_vectors
from maniskill_taskgrasp.selection.recipe import Recipe, fit_selector
from maniskill_taskgrasp.selection.report import markdown
from maniskill_taskgrasp.selection.scoring import evaluate, paired_intervals
from maniskill_taskgrasp.selection.selector import Selector
from maniskill_taskgrasp.selection.splits import folds_of
from maniskill_taskgrasp.selection.tuning import held_out

SMALL = EnsembleConfig(members=2, hidden=(16,), steps=40)
RESULTS = Path(__file__).resolve().parents[1] / "docs" / "selection" / "results.json"


def some_pairs(n, seed=0):
    """Random known pairs with random counts of at least one row each."""
    rng = np.random.default_rng(seed)
    knowledge = load_knowledge()
    objects, actions = list(knowledge.objects.values()), list(knowledge.actions)
    pairs = [(objects[rng.integers(286)], actions[rng.integers(74)]) for _ in range(n)]
    counts = rng.multinomial(1, np.ones(15) / 15, n) + rng.poisson(0.2, (n, 15))
    return pairs, counts.astype(float)


@pytest.fixture(scope="module")
def described():
    pairs, counts = some_pairs(40)
    describer = Describer.fit([p[0] for p in pairs], *name_vectors())
    return describer(pairs), counts


@pytest.fixture(scope="module")
def table(shared_dir):
    return load_table(shared_dir / "data" / "task-object_grasp_dataset.csv").without_platform()


@pytest.fixture(scope="module")
def small_table(table):
    """Every twelfth row: 541 rows of all kinds."""
    return table.take(np.arange(0, len(table), 12))


def test_name_vectors_cover_all_names():
    """One unit vector for each of 286 objects and 74 actions, like names being near."""
    objects, actions = name_vectors()
    assert (len(objects), len(actions)) == (286, 74)
    stacked = np.stack([*objects.values(), *actions.values()]).astype(float)
    assert stacked.shape[1] == NAME_WIDTH
    np.testing.assert_allclose(np.linalg.norm(stacked, axis=1), 1, atol=1e-3)
    near = objects["screwdriver"] @ objects["wrench"]
    assert near > objects["screwdriver"] @ objects["towel"]


def test_kernel_is_a_covariance(described):
    """Symmetric, positive definite, and largest between a pair and itself."""
    pairs, _ = described
    covariance = kernel(pairs, pairs, KernelConfig())
    np.testing.assert_allclose(covariance, covariance.T, atol=1e-12)
    assert np.linalg.eigvalsh(covariance).min() > -1e-9
    assert (covariance.max(1) <= np.diag(covariance) + 1e-9).all()


def test_kernel_fit_is_a_peak(described):
    """No small change of the logits' coefficients raises the posterior."""
    pairs, counts = described
    config = KernelConfig()
    network = fit_kernel_network(pairs, counts, config)
    covariance = kernel(pairs, pairs, config)
    rows = counts.sum(1, keepdims=True)

    def log_posterior(coefficients):
        fitted = replace(network, coefficients=coefficients).predict(pairs)
        fit = (rows**config.row_power * counts / rows * np.log(fitted)).sum()
        return fit - 0.5 * np.sum(coefficients * (covariance @ coefficients))

    rng = np.random.default_rng(0)
    best = log_posterior(network.coefficients)
    for _ in range(20):
        step = rng.normal(0, 0.05, counts.shape)
        assert log_posterior(network.coefficients + step) < best


def test_both_networks_learn_their_training_rows(described):
    """A fitted network makes the training rows more probable than their overall frequency does."""
    pairs, counts = described
    base = counts.sum(0) / counts.sum()
    before = (counts * np.log(base + 1e-9)).sum()
    for network in (
        fit_kernel_network(pairs, counts, KernelConfig()),
        fit_ensemble(pairs, counts, replace(SMALL, dropout=0.0, steps=100)),
    ):
        found = network.predict(pairs)
        np.testing.assert_allclose(found.sum(1), 1, atol=1e-6)
        assert (counts * np.log(found)).sum() > before


def test_same_seed_same_perceptrons(described):
    """Training is a function of the rows and the seed."""
    pairs, counts = described
    first, again, other = (
        fit_ensemble(pairs, counts, replace(SMALL, seed=seed)).predict(pairs) for seed in (0, 0, 1)
    )
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-3


def test_temperature_keeps_the_order():
    """Tempering neither reorders nor unbalances; 1 changes nothing, infinity makes all equal."""
    scores = np.random.default_rng(0).dirichlet(np.ones(15), 20)
    np.testing.assert_allclose(tempered(scores, 1.0), scores, atol=1e-9)
    np.testing.assert_array_equal(tempered(scores, 2.0).argsort(1), scores.argsort(1))
    np.testing.assert_allclose(tempered(scores, 1e9), 1 / 15, atol=1e-6)


def test_saved_selector_answers_the_same(small_table, tmp_path):
    """Save and load is a round trip."""
    selector = fit_selector(small_table, Recipe(perceptrons=SMALL))
    selector.save(tmp_path / "selector.npz", {"note": "test"})
    again = Selector.load(tmp_path / "selector.npz")
    pairs, _ = some_pairs(30, seed=1)
    np.testing.assert_allclose(again.predict(pairs), selector.predict(pairs), atol=1e-5)


def test_scales_come_from_training_rows(small_table):
    """What the networks see of a pair does not depend on objects that were held out."""
    train, test = next(folds_of(small_table, "objects"))
    kept = small_table.take(train)
    before = fit_describer(kept)
    names = set(small_table.objects[test].tolist())
    huge = {
        name: replace(a, dimensions_m=(9.0, 9.0, 9.0), mass_kg=99.0) if name in names else a
        for name, a in small_table.affordances.items()
    }
    after = fit_describer(replace(kept, affordances=huge))
    np.testing.assert_array_equal(before.size_mean, after.size_mean)


def test_test_labels_do_not_reach_the_prediction(small_table):
    """Shuffling the held-out answers changes nothing that is predicted: no leak by construction."""
    train, test = next(folds_of(small_table, "objects"))
    asked = small_table.take(test)
    permuted = np.random.default_rng(0).permutation(len(asked))
    shuffled = replace(
        asked,
        topology=asked.topology[permuted],
        label_sets=asked.label_sets[permuted],
        grasps=asked.grasps[permuted],
        durations=asked.durations[permuted],
    )
    models = {name: all_models()[name] for name in ("trees", "pair")}
    models["ours"] = lambda kept, t, _: _predicted(kept, t)
    for model in models.values():
        first, second = (model(small_table.take(train), t, "objects") for t in (asked, shuffled))
        np.testing.assert_array_equal(first.scores, second.scores)


def _predicted(train, test):
    from maniskill_taskgrasp.selection.scoring import Prediction

    asked = condense(test)
    selector = fit_selector(train, Recipe(perceptrons=SMALL))
    return Prediction(selector.predict(asked.pairs)[asked.pair_of_row])


def test_tuning_scores_rows_by_models_that_did_not_see_them(small_table):
    """Under an inner object split no evidence of a row's own pair is left."""
    view = held_out(small_table, "objects", Recipe(perceptrons=SMALL))
    assert len(view.observed) == len(small_table)
    assert view.counts.sum() == 0
    assert view.weights.sum() == pytest.approx(1)


def test_pair_table_reproduces_the_published_baseline(table, tmp_path):
    """The frequency table scores 51.2 % own@1, 69.9 % o and 67.1 % p on the random split."""
    row = evaluate("pair", by_pair, table, "random", tmp_path)["row"]
    assert 100 * row["own@1"][0] == pytest.approx(51.2, abs=0.05)
    assert 100 * row["o"][0] == pytest.approx(69.9, abs=0.05)
    assert 100 * row["p"][0] == pytest.approx(67.1, abs=0.05)


def test_paired_intervals_hold_the_mean_difference(small_table, tmp_path):
    """Around the mean over folds of what was scored; a model differs from itself by nothing."""
    models = {"object": by_object, "same": by_object, "prior": prior}

    def gaps(other):
        return paired_intervals("object", other, models, small_table, "actions", tmp_path)

    folds = [
        evaluate(name, models[name], small_table, "actions", tmp_path)["folds"]
        for name in ("object", "prior")
    ]
    for metric, (low, high) in gaps("prior").items():
        assert low < np.mean(folds[0][metric]) - np.mean(folds[1][metric]) < high
    assert all(gap == [0, 0] for gap in gaps("same").values())


def test_learning_curve_ends_at_the_whole_training_set(small_table, monkeypatch):
    """All groups used is the recipe scored as it is; half of them is another fit."""
    monkeypatch.setattr(learning, "SHARES", (0.5, 1.0))
    recipe, fits = Recipe(perceptrons=SMALL), []
    half, whole = learning.learning_curve(small_table, "pairs", recipe, 0, lambda: fits.append(1))
    log_losses = []
    for train, test in folds_of(small_table, "pairs"):
        asked = small_table.take(test)
        scores = _predicted(small_table.take(train), asked).scores
        log_losses.append(-np.log(scores[np.arange(len(asked)), asked.topology]).mean())
    assert whole["NLL"][0] == pytest.approx(np.mean(log_losses), rel=1e-6)
    assert half["NLL"][0] != pytest.approx(whole["NLL"][0], rel=1e-6)
    assert len(fits) == 10


def test_leak_guard_fires():
    """o, p or own@1 above what honest inputs allow is called a leak; honest figures are not."""
    assert targets.leaks({"o": 0.70, "p": 0.67, "own@1": 0.512}) == []
    assert targets.leaks({"o": 0.86, "p": 0.67, "own@1": 0.58}) == ["o", "own@1"]


@pytest.mark.parametrize("model", ["ours", "pair", "trees", "four", "paper"])
def test_committed_report_does_not_leak(model):
    """The published random-split figures stay below what only a leak can reach."""
    row = json.loads(RESULTS.read_text("utf-8"))["honest"][model]["random"]["row"]
    assert targets.leaks({name: both[0] for name, both in row.items()}) == []


def test_committed_page_is_what_the_figures_say():
    """report.md is the rendering of results.json, not of something else."""
    results = json.loads(RESULTS.read_text("utf-8"))
    assert RESULTS.with_name("report.md").read_text("utf-8") == markdown(results)


def test_shipped_checkpoint_is_small():
    """At most 10 MB."""
    path = files("maniskill_taskgrasp.assets").joinpath("checkpoints/selector.npz")
    assert len(path.read_bytes()) <= 10_000_000
