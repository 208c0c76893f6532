"""Example episodes of an evaluation, kept for its report: a success and a miss of each pair."""

from __future__ import annotations

import io
import re
import zlib
from dataclasses import fields
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.assets.objects.store import write_atomically
from maniskill_taskgrasp.train.batched_episodes import Episodes, Job, Trace

TRACE_FOLDER = "traces"
KINDS = ("success", "miss")


def trace_path(folder: Path, topology_slug: str, name: str, text: str, kind: str) -> Path:
    """File of one example episode."""
    return folder / TRACE_FOLDER / f"{topology_slug}--{file_label(name, text)}--{kind}.npz"


def file_label(name: str, text: str) -> str:
    """Part of a file's name that tells objects, and the sentences that name them, apart."""
    label = re.sub(r"\W+", "_", name)[:80]
    return f"{label}-{zlib.crc32(text.encode()):08x}" if text else label


def save_traces(folder: Path, job: Job, episodes: Episodes) -> None:
    """Write the example episodes of a job."""
    for kind in KINDS:
        trace = getattr(episodes, kind)
        if trace is None:
            continue
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **{f.name: getattr(trace, f.name) for f in fields(Trace)})
        path = trace_path(folder, job.topology.slug, job.name, job.text, kind)
        write_atomically(path, buffer.getvalue())


def load_trace(folder: Path, slug: str, name: str, text: str, kind: str) -> Trace | None:
    """An example episode, None where there was none."""
    path = trace_path(folder, slug, name, text, kind)
    if not path.is_file():
        return None
    with np.load(path) as data:
        return Trace(int(data["seed"]), data["tips"], data["obj"], data["forces"])
