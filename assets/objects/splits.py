"""Which catalogue objects a policy may train on: drawn once, then read from split.json.

`python -m maniskill_taskgrasp.assets.objects.splits` draws it again; that invalidates every figure
measured on the test objects, so it is run when the catalogue's list of names changes, never else.
"""

from __future__ import annotations

import json
import random
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

from maniskill_taskgrasp.assets.objects.store import write_atomically
from maniskill_taskgrasp.knowledge import Affordance, load_knowledge

SPLIT_FILE = Path(__file__).parent / "split.json"
SEED = 0
TEST_SHARE = 0.3

ALWAYS_TEST = (
    "aerosol can", "base of handle", "book", "cylindrical part on machine", "deoderant", "game",
    "jewelry box", "laundry detergent bottle", "medium drum-like part", "medium part",
    "metal rectangle", "paper towel roll", "placemat", "plexiglas rectangle", "rectangular block",
    "screw", "small drum-like part", "small food", "small knob", "tool stand",
)  # fmt: skip
"""Objects of which the paper's authors published a mesh: kept unseen, so theirs can test too."""


def stratum(affordance: Affordance) -> tuple[str, int]:
    """Class after Zingg and size class: middle extent up to 1.25, 4, and above 4 cm."""
    middle = affordance.dimensions_m[1]
    return affordance.shape, sum(middle > limit for limit in (0.0125, 0.04))


def draw(names: Iterable[str], seed: int = SEED) -> dict[str, list[str]]:
    """Names split by object, about `TEST_SHARE` of every stratum in the test half."""
    objects = load_knowledge().objects
    strata: dict[tuple[str, int], list[str]] = defaultdict(list)
    for name in sorted(names):
        strata[stratum(objects[name])].append(name)
    rng, test = random.Random(seed), []
    carried = 0.0  # Rounding left over, so that small strata do not all round the same way.
    for key in sorted(strata):
        members = strata[key]
        fixed = [n for n in members if n in ALWAYS_TEST]
        free = [n for n in members if n not in ALWAYS_TEST]
        wanted = TEST_SHARE * len(members) + carried
        count = min(max(round(wanted) - len(fixed), 0), len(free))
        carried = wanted - count - len(fixed)
        test += fixed + rng.sample(free, count)
    chosen = set(test)
    train = [name for names_ in strata.values() for name in names_ if name not in chosen]
    return {"train": sorted(train), "test": sorted(test)}


def main() -> None:
    """Draw the split of all recipes and write it."""
    from maniskill_taskgrasp.assets.objects.recipe import load_recipes

    content = json.dumps(draw(load_recipes()), indent=1) + "\n"
    write_atomically(SPLIT_FILE, content.encode())


if __name__ == "__main__":
    main()
