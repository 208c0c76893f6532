"""The data room: what is read, refused, dropped and relabelled."""

import csv

import numpy as np
import pytest

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.selection import fetch
from maniskill_taskgrasp.selection.dataset import COLUMNS, SHA256, load_table, sha256_of
from maniskill_taskgrasp.selection.labels import label_sets
from maniskill_taskgrasp.selection.refinement import (
    MEMBER_GRASPS,
    TYPES,
    UNOBSERVED_GRASPS,
    action_of_phrase,
    shape_class,
    topology_of_grasp,
)
from maniskill_taskgrasp.topology import TOPOLOGY_NAMES

ROW = {
    **dict.fromkeys(TOPOLOGY_NAMES, "0"),
    **{"Object": "cup", "A": "10", "B": "8", "C": "8", "GraspedDimension": "b/c"},
    **{"Rigidity": "rigid", "Roundness": "a", "Mass": "200", "Shape": "prolate"},
    **{"Type": "cylinder", "Task": "drinking", "Force": "weight", "Constraint": "uuu"},
    **{"Class": "use", "Duration": "3.0", "OppType": "Palm", "PIP": "Power"},
    **{"Grasp": "medium wrap", "Grasp_group": "Power palm abd 2-5", "Task_group": "drinking"},
    **{"Power palm abd 2-5": "1", "platform": "0"},
}


@pytest.fixture(scope="module")
def csv_path(shared_dir):
    return shared_dir / "data" / "task-object_grasp_dataset.csv"


@pytest.fixture(scope="module")
def table(csv_path):
    return load_table(csv_path)


def write(path, rows, columns=COLUMNS):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    return path


def test_authors_file_is_the_one_described(csv_path, table):
    """Checksum, rows, and the counts after dropping platform and floppy rows."""
    assert sha256_of(csv_path) == SHA256
    assert len(table) == 6554
    assert len(set(table.objects)) == 286
    kept = table.without_platform()
    assert (len(kept), len(set(kept.objects)), len(set(kept.actions))) == (6487, 283, 74)
    assert kept.pairs.max() + 1 == 574
    rigid = table.without_floppy()
    assert (len(rigid), len(set(rigid.objects)), len(set(rigid.actions))) == (5124, 255, 68)


def test_zero_extents_mean_floppy(table):
    """A = B = C = 0 exactly where every shape attribute reads floppy; mass stays real."""
    for affordance in table.affordances.values():
        zero = affordance.dimensions_m == (0, 0, 0)
        attributes = (affordance.rigidity, affordance.roundness, affordance.shape, affordance.type)
        assert zero == all(value == "floppy" for value in attributes) == affordance.is_floppy
        assert affordance.mass_kg > 0


def test_table_agrees_with_shipped_knowledge(table):
    """Measurements and counts that the product ships are those of the CSV."""
    knowledge = load_knowledge()
    assert table.affordances == knowledge.objects
    kept = table.without_platform()
    names = zip(kept.objects.tolist(), kept.actions.tolist(), kept.topology, strict=True)
    counts = {}
    for obj, action, topology in names:
        counts.setdefault((obj, action), [0] * 15)[topology] += 1
    shipped = {pair: list(n) for pair, n in knowledge.pair_counts.items() if sum(n)}
    assert counts == shipped


def test_label_sets_are_the_union_over_object_and_action(table):
    """The file's 15 label columns follow from its own rows, so they cross any later split."""
    np.testing.assert_array_equal(label_sets(table), table.label_sets)


def test_label_sets_from_training_rows_hide_the_rest(table):
    """A row's set holds nothing that only hidden rows show."""
    rows = np.random.default_rng(0).random(len(table)) < 0.5
    sets = label_sets(table, rows)
    assert not (sets & ~table.label_sets).any()
    seen = rows & (table.topology >= 0)
    for pair in np.unique(table.pairs)[::50]:
        members = table.pairs == pair
        expected = np.unique(table.topology[members & seen])
        np.testing.assert_array_equal(np.flatnonzero(sets[members][0]), expected)


def test_grasps_refine_to_the_files_groups(table):
    """Each of 6,487 grasps maps to the row's own topology; 33 names in all, no name twice."""
    names = [grasp for grasps in MEMBER_GRASPS.values() for grasp in grasps]
    assert len(set(names)) == len(names) == 31
    assert tuple(MEMBER_GRASPS) == TOPOLOGY_NAMES
    assert len(names) + len(UNOBSERVED_GRASPS) == 33
    kept = table.without_platform()
    assert set(kept.grasps) == set(names)
    index = {grasp: topology_of_grasp(grasp).index for grasp in names}
    assert [index[g] for g in kept.grasps.tolist()] == kept.topology.tolist()
    assert all(topology_of_grasp(grasp) is None for grasp in UNOBSERVED_GRASPS)


def test_unknown_grasp_suggests_one():
    """A misspelt grasp is refused with the close name."""
    with pytest.raises(InputError, match="medium wrap"):
        topology_of_grasp("medium warp")


def test_phrases_refine_to_actions(table):
    """207 phrases, 74 actions, and every row's phrase gives its action."""
    mapping = action_of_phrase()
    assert len(mapping) == 207
    assert len(set(mapping.values())) == 74
    assert [mapping[p] for p in table.phrases.tolist()] == table.actions.tolist()


def test_shape_and_type_follow_from_size_and_roundness():
    """Zingg's classes and the 12 types are functions of the measurements, for all 286 objects."""
    for affordance in load_knowledge().objects.values():
        assert shape_class(affordance.dimensions_m) == affordance.shape
        assert TYPES[affordance.shape, affordance.roundness] == affordance.type


def test_an_edited_file_is_read(tmp_path):
    """Another checksum is no obstacle to reading rows that make sense."""
    table = load_table(write(tmp_path / "own.csv", [ROW, ROW | {"Object": "mug"}]))
    assert table.topology.tolist() == [1, 1]
    assert table.affordances["mug"].dimensions_m == (0.1, 0.08, 0.08)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"A": "ten"}, "A is 'ten'"),
        ({"Mass": "-1"}, "Mass"),
        ({"Duration": "nan"}, "Duration"),
        ({"B": "11"}, "A >= B >= C"),
        ({"Grasp_group": "Power palm"}, "no topology"),
        ({"Power palm abd 2-5": "2"}, "0 or 1"),
        ({"Rigidity": ""}, "missing"),
    ],
)
def test_a_bad_cell_is_named(tmp_path, change, message):
    """Each kind of nonsense is refused with the line it is on."""
    path = write(tmp_path / "own.csv", [ROW, ROW | change])
    with pytest.raises(InputError, match=message) as caught:
        load_table(path)
    assert "line 3" in str(caught.value)


def test_contradicting_measurements_are_refused(tmp_path):
    """An object cannot have two sizes."""
    path = write(tmp_path / "own.csv", [ROW, ROW | {"A": "12"}])
    with pytest.raises(InputError, match="two different ways"):
        load_table(path)


@pytest.mark.parametrize("kind", ["missing", "folder", "binary", "columns", "header only"])
def test_another_file_is_refused(tmp_path, kind):
    """What is not this CSV ends in one line."""
    path = tmp_path / "own.csv"
    if kind == "folder":
        path = tmp_path
    elif kind == "binary":
        path.write_bytes(bytes(range(256)))
    elif kind == "columns":
        write(path, [ROW], COLUMNS[:-1])
    elif kind == "header only":
        write(path, [])
    with pytest.raises(InputError) as caught:
        load_table(path)
    assert "\n" not in str(caught.value)


def test_fetch_keeps_a_checked_copy(csv_path, tmp_path):
    """A local copy is taken over bit for bit, and checks out afterwards."""
    kept = fetch.fetch(csv_path, tmp_path / "cache" / "data.csv")
    assert kept == {"path": str(tmp_path / "cache" / "data.csv"), "sha256": SHA256, "rows": 6554}
    assert fetch.check(kept["path"]) == kept


def test_fetch_refuses_another_file_and_keeps_nothing(tmp_path):
    """A file with another checksum is not taken for the authors'."""
    source = write(tmp_path / "own.csv", [ROW])
    target = tmp_path / "cache" / "data.csv"
    with pytest.raises(InputError, match="sha256"):
        fetch.fetch(source, target)
    assert not target.exists()


def test_fetch_without_network_is_one_line(monkeypatch, tmp_path):
    """No network ends in one line that names the way out, and leaves nothing behind."""

    def unreachable(url, timeout):
        raise fetch.URLError("no route to host")

    monkeypatch.setattr(fetch.urllib.request, "urlopen", unreachable)
    with pytest.raises(InputError, match="--from FILE") as caught:
        fetch.fetch(target=tmp_path / "data.csv")
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())
