"""Speed as ratios in one run: against bare physics, AsyncVectorEnv and other tasks; scaling.

python train/benchmark.py
python train/benchmark.py --num-envs 1 64 --repeats 3 --json
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from statistics import median
from typing import Any

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.run_log import note
from maniskill_taskgrasp.train.script import run_script
from maniskill_taskgrasp.train.speed import (
    Speed,
    available_cores,
    in_own_process,
    measure_async,
    measure_other,
    measure_ours,
)

OTHERS = {
    "PickCube-v1": "mani_skill.envs",
    "RotateSingleObjectInHandLevel0-v1": "mani_skill.envs",
    "HandManipulateBlock-v1": "gymnasium_robotics",
    "AdroitHandHammer-v1": "gymnasium_robotics",
}
"""Task -> package; those that are not installed are left out."""
PYBULLET_SIMULATED = 4.5  # [s/s] of the paper authors' environment, 4.1 to 4.9 on another machine.
MAIN = 64  # Environments that the ratios are about.


@dataclass(frozen=True, kw_only=True)
class BenchmarkConfig:
    """Measure how fast TaskGrasp-v0 runs here, beside bare physics and other tasks."""

    num_envs: tuple[int, ...] = (1, 4, 16, 64, 256)
    """Numbers of environments to measure on one core."""
    repeats: int = 5
    """Episodes a measurement; medians are reported."""
    others: bool = True
    """Measure PickCube-v1 and the hand tasks that are installed as well."""
    json: bool = False
    """Print one JSON document on stdout, and nothing else there."""

    def __post_init__(self) -> None:
        if self.repeats < 1:
            raise InputError(f"--repeats must be 1 or more, got {self.repeats}")
        if not self.num_envs or min(self.num_envs) < 1:
            raise InputError(f"--num-envs must be 1 or more, got {self.num_envs}")


@dataclass(frozen=True)
class Ratio:
    """One comparison, with what the project set itself."""

    name: str
    value: float
    wanted: str


def run(config: BenchmarkConfig) -> dict[str, Any]:
    """Measure everything and return it, fit for JSON; progress goes to stderr."""
    single: dict[int, Speed] = {}
    for num_envs in config.num_envs:
        note(f"one core, {num_envs} environments")
        single[num_envs] = in_own_process(measure_ours, num_envs, 1, config.repeats, 1)
    cores = available_cores()
    many = None
    if cores > 1 and max(config.num_envs) >= MAIN:
        note(f"{cores} cores, {MAIN} environments")
        many = in_own_process(measure_ours, MAIN, cores, config.repeats, cores)
    note(f"AsyncVectorEnv, {cores} processes")
    vector = in_own_process(measure_async, cores, config.repeats)
    others = []
    for env_id, package in OTHERS.items() if config.others else ():
        if find_spec(package.split(".")[0]) is None:
            note(f"{env_id}: {package} is not installed, left out")
            continue
        note(env_id)
        others.append(in_own_process(measure_other, env_id, package, config.repeats))
    ratios = list(_ratios(single, many, vector, others))
    rows = [*single.values(), *([many] if many else []), vector, *others]
    return {
        "cores": cores,
        "repeats": config.repeats,
        "speeds": [speed.summary() for speed in rows],
        "ratios": [vars(ratio) for ratio in ratios],
    }


def _ratios(
    single: dict[int, Speed], many: Speed | None, vector: Speed, others: list[Speed]
) -> Iterator[Ratio]:
    for num_envs, wanted in ((MAIN, ">= 0.80"), (1, ">= 0.60")):
        if (speed := single.get(num_envs)) is not None:
            yield Ratio(f"physics / env.step, N = {num_envs}", speed.sections["physics"], wanted)
            share = median(speed.bare) / median(speed.cpu)
            yield Ratio(f"bare physics / env.step, N = {num_envs}", share, wanted)
    if {MAIN, 256} <= single.keys():
        cost = single[MAIN].rate / single[256].rate
        yield Ratio("cost of an env step, N = 256 / N = 64", cost, "<= 1.15")
    if (best := many or single.get(MAIN)) is not None:
        yield Ratio("batched / AsyncVectorEnv, all cores", best.rate / vector.rate, ">= 1.6")
    if (ours := single.get(MAIN)) is None:
        return
    yield Ratio(
        "simulated s/s / the authors' PyBullet (recorded)",
        ours.simulated / PYBULLET_SIMULATED,
        ">= 20",
    )
    for other in others:
        wanted = ">= 2.2" if other.name == "PickCube-v1" else "> 1"
        yield Ratio(f"steps/s, N = 64 / {other.name}", ours.rate / other.rate, wanted)
        if other.cpu and ours.cpu:
            yield Ratio("  the same by CPU time", ours.cpu_rate / other.cpu_rate, wanted)


def report(result: dict[str, Any]) -> str:
    """Tables for a person."""
    head = f"{'':36}{'envs':>5}{'procs':>6}{'steps/s':>9}{'/CPU s':>8}{'sim s/s':>9}{'MiB/env':>9}"
    lines = [head]
    for row in result["speeds"]:
        by_cpu = f"{row['steps_per_cpu_s']:.0f}" if row["cpu"] else "-"
        lines.append(
            f"{row['name']:36}{row['num_envs']:>5}{row['processes']:>6}{row['steps_per_s']:>9.0f}"
            f"{by_cpu:>8}{row['simulated_s_per_s']:>9.1f}{row['memory_mib_per_env']:>9.1f}"
        )
    for row in result["speeds"]:
        if row["sections"]:
            split = ", ".join(f"{k} {100 * v:.1f} %" for k, v in row["sections"].items())
            lines.append(f"N = {row['num_envs']}: {split}")
    lines += [f"{'ratio':56}{'here':>8}  wanted"]
    lines += [f"{r['name']:56}{r['value']:>8.2f}  {r['wanted']}" for r in result["ratios"]]
    return "\n".join(lines)


def main(config: BenchmarkConfig) -> None:
    """Measure and print."""
    result = run(config)
    print(json.dumps(result, indent=2) if config.json else report(result))


if __name__ == "__main__":
    run_script(main, BenchmarkConfig, __doc__)
