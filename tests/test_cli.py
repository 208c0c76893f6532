"""Laws of the command line: exit codes, one line for bad input, one JSON document."""

import json

import pytest

from maniskill_taskgrasp import cli

SELECT_KEYS = {
    "text",
    "action",
    "action_score",
    "actions_top3",
    "object",
    "object_score",
    "rejected",
    "reason",
    "topologies",
    "opposition",
    "pip",
}
GRASP_KEYS = {
    "instruction",
    "action",
    "object",
    "strategy",
    "topology",
    "episodes",
    "successes",
    "lift_m",
    "failure",
    "fidelity",
    "video",
    "seconds",
}


def run(capsys, *args):
    """Exit code, stdout and stderr of one call."""
    code = 0
    try:
        cli.main(list(args))
    except SystemExit as stop:
        code = stop.code
    out, err = capsys.readouterr()
    return code, out, err


@pytest.mark.parametrize(
    ("args", "names"),
    [
        (("grasp", ""), "empty"),
        (("grasp", "xyzzy"), "xyzzy"),
        (("grasp", "hand me the mug", "--object", "nosuch"), "nosuch"),
        (("grasp", "hand me the mug", "--topology", "nosuch"), "nosuch"),
        (("grasp", "hand me the mug", "--episodes", "none"), "none"),
        (("grasp", "hand me the mug", "--episodes", "0"), "0"),
        (("grasp", "hand me the mug", "--noise", "loud"), "loud"),
        (("grasp", "hand me the mug", "--policy", "nosuch.pt"), "nosuch.pt"),
        (("grasp", "hand me the mug", "--distance", "guessed"), "guessed"),
        (("grasp",), "STR"),
        (("select",), "neither"),
        (("select", "--from-file", "nosuch.txt"), "nosuch.txt"),
        (("dance",), "dance"),
        (("objects", "show", "nosuch"), "nosuch"),
        (("data", "check", "nosuch.csv"), "nosuch.csv"),
    ],
)
def test_bad_input_gets_exit_code_2_and_one_line(capsys, args, names):
    """The line names what came; stdout stays empty."""
    code, out, err = run(capsys, *args)
    assert code == 2
    assert out == ""
    lines = err.strip().splitlines()
    assert len(lines) == 1, err
    assert lines[0].startswith("taskgrasp: ")
    assert names in lines[0]


def test_select_prints_one_json_document(capsys):
    code, out, err = run(capsys, "select", "hand me the screwdriver", "--json")
    assert code == 0
    assert set(json.loads(out)) >= SELECT_KEYS
    assert "note:" in err


def test_select_from_file_answers_each_line_blank_ones_too(capsys, tmp_path):
    lines = ["hand me the mug", "", "xyzzy", "wipe the table with the sponge"]
    path = tmp_path / "lines.txt"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    code, out, _ = run(capsys, "select", "--from-file", str(path))
    answers = [json.loads(line) for line in out.splitlines()]
    assert code == 0
    assert [answer["text"] for answer in answers] == lines
    assert [answer["rejected"] for answer in answers] == [False, True, True, False]


def test_topologies_lists_all_fifteen(capsys):
    code, out, _ = run(capsys, "topologies", "--json")
    rows = json.loads(out)
    assert code == 0
    assert len(rows) == 15
    assert set(rows[0]) == {"name", "opposition", "pip", "digits", "feasible", "reason"}


def test_objects_list_filters_by_split(capsys):
    code, out, _ = run(capsys, "objects", "list", "--split", "test", "--json")
    rows = json.loads(out)
    assert code == 0
    assert {row["split"] for row in rows} == {"test"}
    assert {"name", "dimensions_m", "mass_kg", "parts", "watertight"} <= set(rows[0])


def test_grasp_repeats_itself_to_the_digit(capsys):
    """Same seed, same document, but for the time it took."""
    documents = []
    for _ in range(2):
        code, out, _ = run(capsys, "grasp", "hand me the screwdriver", "--seed", "0", "--json")
        assert code == 0
        document = json.loads(out)
        assert set(document) >= GRASP_KEYS
        del document["seconds"]
        documents.append(document)
    assert documents[0] == documents[1]


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    flags = ("--objects", "hammer", "--episodes", "1", "--out", str(tmp_path / "taken"))
    code, _, err = run(capsys, "evaluate", *flags)
    assert code == 2
    assert err.count("\n") == 1 and "taken" in err


def test_a_seed_that_numpy_cannot_take_is_one_line(capsys):
    code, _, err = run(capsys, "grasp", "lift the cup", "--seed", str(2**32))
    assert (code, err.count("\n")) == (2, 1)
    assert "seed must be from 0 to 2**32" in err
