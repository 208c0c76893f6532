"""Starting is quick: what is not needed is not imported."""

import resource
import subprocess
import sys

import pytest

PYTHON = [sys.executable, "-c", "pass"]


def cpu_seconds(command, repeats=3):
    """[s] of CPU time of a command, the best of some runs."""
    times = []
    for _ in range(repeats):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(times)


@pytest.mark.parametrize(
    ("command", "limit"),
    [
        ([sys.executable, "-c", "import maniskill_taskgrasp"], 0.3),
        ([sys.executable, "-m", "maniskill_taskgrasp", "--help"], 0.7),
    ],
)
def test_start_takes_little_time(command, limit):
    """Beyond Python's own start."""
    assert cpu_seconds(command) - cpu_seconds(PYTHON) <= limit


def test_the_import_leaves_torch_and_maniskill_alone():
    script = "import sys, maniskill_taskgrasp; print({'torch', 'mani_skill'} & set(sys.modules))"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "set()"
