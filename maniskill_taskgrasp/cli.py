"""The `taskgrasp` command: arguments in, text or one JSON document out, and nothing else."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro
from tyro.conf import OmitSubcommandPrefixes, Positional, subcommand

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.evaluation_config import EvaluateConfig

BAR_WIDTH = 24  # Characters of a probability bar,
KEY_WIDTH = 21  # and of the name of a fact before it.


@dataclass(frozen=True, kw_only=True)
class Output:
    """What every command can do with its answer."""

    json: bool = False
    """Print one JSON document on stdout and nothing else; notes go to stderr."""


@dataclass(frozen=True, kw_only=True)
class Grasp(Output):
    """Understand a sentence, choose a grasp and carry it out in simulation.

    Example: taskgrasp grasp "hand me the screwdriver" --video grasp.mp4
    """

    text: Positional[str]
    """What you want done, in plain English."""
    object: str | None = None
    """Library object or mesh file to grasp, whatever the sentence names."""
    topology: str | None = None
    """Grasp topology to use, whatever the selector says (`taskgrasp topologies` lists them)."""
    policy: str = "follow"
    """"constant" closes all the way; with "follow" the palm also follows the object by what is
    sensed; "guarded" also waits with what touches first; "probing" also comes down feeling, for
    touch alone; "learned" is the shipped policy; or a checkpoint file."""
    distance: str | None = None
    """What the distances know: exact, noisy or none; left out, as the policy was trained."""
    episodes: int = 1
    """How many times to try."""
    seed: int = 0
    """Seed of the first episode; the next ones count up."""
    noise: str = "paper"
    """How far the object is from where the planner thinks: none, paper, hard or blind."""
    presentation: str = "auto"
    """How the object is offered: auto, table, stand, rail, rack or holder."""
    search: int = 0
    """Generations of a grasp search on this very object first; 0 uses the stored grasps alone."""
    video: Path | None = None
    """Write an mp4 of the first episode."""

    def run(self) -> None:
        """Print the parse, the strategy and the outcome."""
        from maniskill_taskgrasp.pipeline import GraspOptions, Pipeline

        options = GraspOptions(
            object=self.object,
            topology=self.topology,
            policy=self.policy,
            distance=self.distance,
            episodes=self.episodes,
            seed=self.seed,
            noise=self.noise,
            presentation=self.presentation,
            search=self.search,
            video=self.video,
        )
        with _quiet():
            result = Pipeline().grasp(self.text, options)
        for note in result.notes:
            print(f"note: {note}", file=sys.stderr)
        if self.json:
            print(json.dumps(result.to_json()))
            return
        action = result.action or "transfer (the object's usual actions decide)"
        print(f'"{result.instruction}"\n  action    {action}\n  object    {result.object}')
        print("  topologies, as people would choose them:")
        for ranked in result.strategy:
            print(_probability_line(ranked.name, ranked.probability, ranked.feasible, ranked.why))
        print(f"  grasp     {result.topology}; {result.presentation}")
        for i, (failure, lift, form) in enumerate(
            zip(result.failure, result.lift_m, result.fidelity, strict=True)
        ):
            outcome = "success" if failure == "none" else f"failed ({failure})"
            shape = "in the named topology" if form else "not in the named topology"
            print(f"  episode {i + 1}: {outcome}, lifted {100 * lift:.1f} cm, {shape}")
        print(f"  {result.successes} of {result.episodes} lifted in {result.seconds:.1f} s")
        if result.video is not None:
            print(f"  video     {result.video}")


@dataclass(frozen=True, kw_only=True)
class Select(Output):
    """Understand sentences and rank the 15 topologies, without simulating anything.

    Example: taskgrasp select "pop the lid off that jar"
    """

    text: Positional[str | None] = None
    """What you want done; or give --from-file."""
    from_file: Path | None = None
    """File with one sentence a line; prints one JSON document for each line, blank ones too."""
    object: str | None = None
    """Library object or mesh file, whatever the sentence names."""

    def run(self) -> None:
        """Print the parse and the ranking."""
        from maniskill_taskgrasp.pipeline import Pipeline

        if (self.text is None) == (self.from_file is None):
            raise InputError(
                "select takes one sentence, or --from-file FILE; got "
                + ("neither" if self.text is None else "both")
            )
        pipeline = Pipeline()
        if self.from_file is not None:
            for line in _lines(self.from_file):
                print(json.dumps(pipeline.select(line, self.object).to_json()))
            return
        assert self.text is not None
        selection = pipeline.select(self.text, self.object)
        if selection.rejected:
            raise InputError(selection.reason or "the instruction was not understood")
        for note in selection.notes:
            print(f"note: {note}", file=sys.stderr)
        if self.json:
            print(json.dumps(selection.to_json()))
            return
        action = selection.action or "transfer (the object's usual actions decide)"
        print(f"action  {action}\nobject  {selection.object}")
        print(f"human grasps of exactly this object and action: {selection.evidence}")
        for ranked in selection.topologies:
            print(_probability_line(ranked.name, ranked.probability, ranked.feasible, ranked.why))


@dataclass(frozen=True, kw_only=True)
class Topologies(Output):
    """List the 15 grasp topologies and whether this hand can form them."""

    render: Path | None = None
    """Folder to write a labelled picture sheet into, open and closed."""

    def run(self) -> None:
        """Print one line a topology."""
        with _quiet():
            from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
        from maniskill_taskgrasp.topology import TOPOLOGIES

        rows = [
            {
                "name": t.name,
                "opposition": t.opposition,
                "pip": t.pip,
                "digits": list(t.parts),
                "feasible": AR10.postures[t.slug].feasible,
                "reason": AR10.postures[t.slug].reason,
            }
            for t in TOPOLOGIES
        ]
        if self.render is not None:
            from maniskill_taskgrasp.agents.sawyer_ar10.sheet import render_sheet

            with _quiet():
                path = render_sheet(self.render)
            print(f"picture sheet: {path}", file=sys.stderr)
        if self.json:
            print(json.dumps(rows))
            return
        for row in rows:
            able = "yes" if row["feasible"] else "no "
            print(f"{able}  {row['name']:22s} {row['reason']}")


@dataclass(frozen=True, kw_only=True)
class Evaluate(EvaluateConfig, Output):
    """Measure how often grasps lift, and lift in the named topology, with intervals.

    Example: taskgrasp evaluate --table paper --episodes 100 --out reports/table1
    """

    def run(self) -> None:
        """Print the table; write it, a report and pictures where a folder is given."""
        with _quiet():
            from maniskill_taskgrasp.train.evaluate import evaluate
            from maniskill_taskgrasp.train.tables import table_lines

            document = evaluate(self)
            if self.out is not None:
                from maniskill_taskgrasp.train.report import write_report

                print(f"report: {write_report(self.out)}", file=sys.stderr)
        if self.json:
            print(json.dumps(document))
            return
        print("\n".join(table_lines(document)))


@dataclass(frozen=True, kw_only=True)
class ObjectsList(Output):
    """List the library's objects."""

    split: str | None = None
    """train, test or imported; all where it is left out."""

    def run(self) -> None:
        """Print one line an object."""
        from maniskill_taskgrasp.assets.objects.commands import list_objects

        rows = list_objects(self.split)
        if self.json:
            print(json.dumps(rows))
            return
        for row in rows:
            size = " x ".join(f"{100 * d:.1f}" for d in row["dimensions_m"])
            print(
                f"{row['name']:32s} {size:>20s} cm  {1000 * row['mass_kg']:6.0f} g  {row['split']}"
            )


@dataclass(frozen=True, kw_only=True)
class ObjectsShow(Output):
    """Show one object: its numbers and a picture with parts and poses."""

    name: Positional[str]
    """Library name or mesh file."""
    out: Path | None = None
    """Where to write the picture."""

    def run(self) -> None:
        """Print the object's numbers."""
        from maniskill_taskgrasp.assets.objects.commands import show_object

        with _quiet():
            facts = show_object(self.name, self.out)
        _print_facts(facts, self.json)


@dataclass(frozen=True, kw_only=True)
class ObjectsImport(Output):
    """Import a mesh, or a folder of meshes, into your own library."""

    path: Positional[Path]
    """Mesh file that trimesh reads, or a folder of them."""
    units: str | None = None
    """m, cm or mm; inferred and said where it is left out."""
    mass: float | None = None
    """[kg]; from the volume where it is left out."""

    def run(self) -> None:
        """Print what was imported and what was refused."""
        from maniskill_taskgrasp.assets.objects.commands import import_objects

        with _quiet():
            facts = import_objects(self.path, self.units, self.mass)
        _print_facts(facts, self.json)


@dataclass(frozen=True)
class Objects:
    """The object library: list, show, import."""

    command: (
        Annotated[ObjectsList, subcommand("list")]
        | Annotated[ObjectsShow, subcommand("show")]
        | Annotated[ObjectsImport, subcommand("import")]
    )

    def run(self) -> None:
        """Run the chosen command."""
        self.command.run()


@dataclass(frozen=True, kw_only=True)
class DataFetch(Output):
    """Get the authors' data set: download it, or take a local copy; its sha256 is checked."""

    from_: Annotated[Path | None, tyro.conf.arg(name="from")] = None
    """A copy you have already."""

    def run(self) -> None:
        """Print where the file is."""
        from maniskill_taskgrasp.selection.fetch import fetch

        _print_facts(fetch(self.from_), self.json)


@dataclass(frozen=True, kw_only=True)
class DataCheck(Output):
    """Check the data set that was fetched, or another copy."""

    path: Positional[Path | None] = None
    """The file; the fetched one where it is left out."""

    def run(self) -> None:
        """Print path, sha256 and rows."""
        from maniskill_taskgrasp.selection.fetch import check

        _print_facts(check(self.path), self.json)


@dataclass(frozen=True)
class Data:
    """The authors' data set, which training needs and use does not: fetch, check."""

    command: Annotated[DataFetch, subcommand("fetch")] | Annotated[DataCheck, subcommand("check")]

    def run(self) -> None:
        """Run the chosen command."""
        self.command.run()


Command = (
    Annotated[Grasp, subcommand("grasp")]
    | Annotated[Select, subcommand("select")]
    | Annotated[Evaluate, subcommand("evaluate")]
    | Annotated[Topologies, subcommand("topologies")]
    | Annotated[Objects, subcommand("objects")]
    | Annotated[Data, subcommand("data")]
)


def main(args: list[str] | None = None) -> None:
    """Run one command; exit code 0 when it ran, 2 with one line on stderr for bad input."""
    # Tensors are small: on a busy machine torch's threads wait for each other, 20 times as long.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    try:
        command = _parse(args)
        command.run()
    except InputError as error:
        print(f"taskgrasp: {' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:  # The reader of a pipe, such as `head`, has seen enough.
        sys.stderr.close()
    except OSError as error:
        print(f"taskgrasp: {error.strerror or error}: {error.filename!r}", file=sys.stderr)
        sys.exit(2)


def _parse(args: list[str] | None) -> Any:
    """The command of an argument list.

    Raises:
        InputError: tyro could not make sense of it; its boxed message becomes one line.
    """
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            return tyro.cli(
                Command,  # type: ignore[arg-type]
                config=(OmitSubcommandPrefixes,),
                prog="taskgrasp",
                description="Type a sentence and watch a Sawyer arm with an AR10 hand grasp.",
                args=args,
            )
    except SystemExit as error:
        if error.code != 2:
            raise
    plain = re.sub(r"\x1b\[[0-9;]*m|[╭╮╰╯│─]|-{4,}", " ", complaint.getvalue())
    lines = [" ".join(line.split()) for line in plain.splitlines()]
    text = " ".join(line for line in lines if line and not line.startswith("Parsing error"))
    text = re.sub(r"^Value error (?:Error parsing [A-Z]\w+: )?", "", text)
    text = re.split(r" (?:Argument helptext:|For full helptext)", text)[0]
    raise InputError(text or "the arguments make no sense; see taskgrasp --help")


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep ManiSkill's and gymnasium's warnings out of the user's terminal."""
    import logging
    import warnings

    logging.getLogger("mani_skill").setLevel(logging.ERROR)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read {str(path)!r}: {error}") from None


def _probability_line(name: str, probability: float, feasible: bool, why: str) -> str:
    bar = "#" * round(BAR_WIDTH * probability)
    hand = "" if feasible else f"  not with this hand: {why}"
    return f"    {100 * probability:5.1f} %  {name:22s} {bar:{BAR_WIDTH}s}{hand}".rstrip()


def _print_facts(facts: Any, as_json: bool) -> None:
    if as_json:
        print(json.dumps(facts))
        return
    for entry in facts if isinstance(facts, list) else [facts]:
        print("\n".join(f"{key:{KEY_WIDTH}s}{_plain(value)}" for key, value in entry.items()))


def _plain(value: Any) -> str:
    """A value as a person reads it: numbers in a row, other lists one entry a line."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_plain(entry)}" for key, entry in value.items())
    if isinstance(value, list):
        numbers = all(isinstance(entry, (int, float)) for entry in value)
        between = ", " if numbers else "\n" + " " * KEY_WIDTH
        return between.join(_plain(entry) for entry in value) or "none"
    return "none" if value is None else str(value)
