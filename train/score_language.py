"""Score the language front end on the committed evaluation set, phenomenon by phenomenon.

python train/score_language.py --split dev
python train/score_language.py --split test --matcher paper

An action is right when it is in the instruction's accepted set, which was fixed from the words'
meaning before anything was tuned; a transfer is right when no action is answered.
"""

from __future__ import annotations

import json
import statistics
import time
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from maniskill_taskgrasp.language import Instruction, Rejected, parse
from maniskill_taskgrasp.train.script import run_script

DATA = Path(__file__).resolve().parent.parent / "tests" / "data"
Z = 1.96  # Two-sided 95 % quantile of the normal distribution.


@dataclass(frozen=True, kw_only=True)
class ScoreConfig:
    """Score the language front end."""

    split: Literal[
        "dev", "test", "fresh", "second", "third", "fourth", "fifth", "sixth", "seventh", "tenth"
    ] = "dev"
    """Part of the evaluation set; `fresh` and the numbered ones were written later."""
    matcher: Literal["own", "paper"] = "own"
    """Front end: ours, or the paper's recipe."""
    show_errors: bool = False
    """List the instructions that were answered wrongly (for the dev split only)."""
    only: str = ""
    """One phenomenon only."""


@dataclass(frozen=True)
class Outcome:
    """What was right about one answer; None where the question does not arise."""

    top1: bool | None
    top3: bool | None
    object: bool | None
    following: bool | None
    refused: bool | None
    """An instruction that is to be refused was."""
    wrongly_refused: bool | None
    """An instruction that is to be answered was refused."""

    @property
    def right(self) -> bool:
        """Everything that was asked is right."""
        if self.refused is not None:
            return self.refused
        return bool(self.top1) and self.object is not False


def judge(row: dict[str, Any], answer: Instruction | Rejected) -> Outcome:
    """Compare one answer with its row of the evaluation set."""
    if row.get("rejected"):
        return Outcome(None, None, None, None, isinstance(answer, Rejected), None)
    if isinstance(answer, Rejected):
        asked = bool(row["objects"])
        return Outcome(False, False, False if asked else None, None, None, True)
    accepted = set(row["actions"])
    pure = answer.action is None and answer.transfer
    transfer_right = bool(row["transfer"]) and pure
    top1 = transfer_right or answer.action in accepted
    top3 = transfer_right or bool(accepted & {name for name, _ in answer.actions_top3})
    found = answer.object in row["objects"] if row["objects"] else None
    following = None
    if "next" in row:
        later = answer.rest[0] if answer.rest else None
        following = isinstance(later, Instruction) and later.action in row["next"]
    return Outcome(top1, top3, found, following, None, False)


def wilson(right: int, n: int) -> tuple[float, float]:
    """Wilson 95 % interval of a rate."""
    if n == 0:
        return 0.0, 1.0
    p = right / n
    middle = (p + Z * Z / (2 * n)) / (1 + Z * Z / n)
    half = Z * ((p * (1 - p) / n + Z * Z / (4 * n * n)) ** 0.5) / (1 + Z * Z / n)
    return middle - half, middle + half


def rate(values: list[bool | None]) -> str:
    """Percentage of the values that are given, with their number."""
    given = [v for v in values if v is not None]
    return f"{100 * sum(given) / len(given):5.1f} ({len(given)})" if given else "-"


def answer_all(
    rows: list[dict[str, Any]], matcher: Literal["own", "paper"]
) -> tuple[list[Instruction | Rejected], list[float]]:
    """Answers and CPU seconds for each row; the models are loaded before the first."""
    parse("open the drawer", matcher=matcher)
    answers, seconds = [], []
    for row in rows:
        start = time.process_time()
        answers.append(
            parse(str(row["text"]), object_override=row.get("object_override"), matcher=matcher)
        )
        seconds.append(time.process_time() - start)
    return answers, seconds


TABLE_COLUMNS = ("top1", "top3", "object", "following", "refused")


def print_table(rows: list[dict[str, Any]], outcomes: list[Outcome]) -> None:
    """One line per phenomenon: percentages, each with how many instructions it is of."""
    table: dict[str, list[Outcome]] = defaultdict(list)
    for row, outcome in zip(rows, outcomes, strict=True):
        table[row["phenomenon"]].append(outcome)
    print("| phenomenon | n | right | top-1 | top-3 | object | next task | refused rightly |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, group in [*table.items(), ("all", outcomes)]:
        right = f"{100 * sum(o.right for o in group) / len(group):.1f}"
        cells = [rate([getattr(o, column) for o in group]) for column in TABLE_COLUMNS]
        print(f"| {name} | {len(group)} | {right} | " + " | ".join(cells) + " |")


def print_totals(outcomes: list[Outcome], seconds: list[float]) -> None:
    """Rates with Wilson intervals, and the CPU time of one answer."""
    for field in ("top1", "top3", "object", "refused", "wrongly_refused"):
        given = [v for o in outcomes if (v := getattr(o, field)) is not None]
        low, high = wilson(sum(given), len(given))
        share = 100 * sum(given) / max(1, len(given))
        print(f"{field}: {share:.1f} % of {len(given)} [{100 * low:.1f}, {100 * high:.1f}]")
    median, most = 1e3 * statistics.median(seconds), 1e3 * max(seconds)
    print(f"CPU time of one answer: median {median:.1f} ms, most {most:.1f} ms")


def print_errors(
    rows: list[dict[str, Any]], answers: list[Instruction | Rejected], outcomes: list[Outcome]
) -> None:
    """Every instruction that was answered wrongly, with its answer."""
    for row, answer, outcome in zip(rows, answers, outcomes, strict=True):
        if not outcome.right or outcome.following is False:
            print(row["id"], row["phenomenon"], repr(row["text"]), row.get("actions", "refuse"))
            print("    ", brief(answer))


def brief(answer: Instruction | Rejected) -> str:
    """One line about an answer."""
    if isinstance(answer, Rejected):
        return f"{answer.kind}: {answer.reason}"
    later = [a.action if isinstance(a, Instruction) else a.kind for a in answer.rest]
    top = [(name, round(score, 2)) for name, score in answer.actions_top3]
    held = f"{answer.object} {answer.object_score:.2f}"
    return f"{answer.action} {top} | {held} | {later} | {answer.notes}"


def main(config: ScoreConfig) -> None:
    """Print the table and the totals."""
    lines = (DATA / f"instructions_{config.split}.jsonl").read_text("utf-8").splitlines()
    rows = [r for r in map(json.loads, lines) if config.only in ("", r["phenomenon"])]
    answers, seconds = answer_all(rows, config.matcher)
    outcomes = [judge(row, answer) for row, answer in zip(rows, answers, strict=True)]
    print_table(rows, outcomes)
    print_totals(outcomes, seconds)
    if config.show_errors:
        print_errors(rows, answers, outcomes)


if __name__ == "__main__":
    run_script(main, ScoreConfig)
