"""Whether one policy beats another on the same episodes: McNemar's test on two evaluations.

python train/paired.py reports/learned reports/constant
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path

from tyro.conf import Positional

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.cells import Json, read_results
from maniskill_taskgrasp.train.intervals import Z_95
from maniskill_taskgrasp.train.script import run_script

SAME = ("noise", "seed", "presentation", "episodes")  # Settings without which nothing is paired.


@dataclass(frozen=True)
class Comparison:
    """Paired outcomes of two policies, a and b."""

    episodes: int
    only_a: int
    """Episodes in which a succeeded and b failed."""
    only_b: int
    rate_a: float
    rate_b: float
    difference: float
    """rate_a - rate_b."""
    ci95: tuple[float, float]
    """Wald interval of the difference of paired rates."""
    p: float
    """Two-sided, exact (McNemar): chance of so uneven a split if neither is better."""


def compare(a: str, b: str) -> Comparison:
    """Compare outcomes bit by bit; "1" is success.

    Raises:
        ValueError: different numbers of episodes, or none.
    """
    if len(a) != len(b) or not a:
        raise ValueError(f"need as many outcomes of one as of the other, got {len(a)} and {len(b)}")
    from scipy.stats import binomtest

    n = len(a)
    only_a = sum(x == "1" and y == "0" for x, y in zip(a, b, strict=True))
    only_b = sum(x == "0" and y == "1" for x, y in zip(a, b, strict=True))
    difference = (only_a - only_b) / n
    margin = Z_95 * math.sqrt(max(0.0, only_a + only_b - n * difference**2)) / n
    split = only_a + only_b
    return Comparison(
        episodes=n,
        only_a=only_a,
        only_b=only_b,
        rate_a=a.count("1") / n,
        rate_b=b.count("1") / n,
        difference=difference,
        ci95=(difference - margin, difference + margin),
        p=binomtest(only_a, split).pvalue if split else 1.0,
    )


def compare_results(a: Json, b: Json) -> dict[str, Comparison]:
    """Compare the pairs that two result documents share, in lift and in lift with form.

    Raises:
        InputError: the documents' episodes are not paired, or no pair is in both.
    """
    differing = [name for name in SAME if a["config"][name] != b["config"][name]]
    if differing:
        raise InputError(f"the episodes are not paired: {', '.join(differing)} differ")
    first, second = ({_key(c): c for c in d["cells"] if c["episodes"]} for d in (a, b))
    shared = [key for key in first if key in second]
    if not shared:
        raise InputError("the two evaluations have no pair of topology and object in common")
    joined = lambda cells, bits: "".join(bits(cells[key]) for key in shared)  # noqa: E731
    return {
        name: compare(joined(first, bits), joined(second, bits))
        for name, bits in (("lift", lambda cell: cell["lifted"]), ("both", _both))
    }


def _both(cell: Json) -> str:
    pairs = zip(cell["lifted"], cell["in_form"], strict=True)
    return "".join("1" if x == y == "1" else "0" for x, y in pairs)


def _key(cell: Json) -> tuple[str, str, str]:
    return cell["topology"], cell["object"], cell["text"] or ""


@dataclass(frozen=True)
class PairedConfig:
    """Compare two evaluations of the same episodes."""

    a: Positional[Path]
    """Folder of `taskgrasp evaluate --out`."""
    b: Positional[Path]
    """Another, with other policy and the rest the same."""


def main(config: PairedConfig) -> None:
    """Print one JSON document."""
    results = compare_results(read_results(config.a), read_results(config.b))
    print(json.dumps({name: asdict(value) for name, value in results.items()}, indent=1))


if __name__ == "__main__":
    run_script(main, PairedConfig)
