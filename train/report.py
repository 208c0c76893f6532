"""The report of an evaluation: one page that needs nothing beside it, and its pictures as PNGs.

python train/report.py reports/table1
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from tyro.conf import Positional

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.store import write_atomically
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks.outcome import FAILURES
from maniskill_taskgrasp.tasks.rendering import rendering_available
from maniskill_taskgrasp.topology import resolve_topology
from maniskill_taskgrasp.train.batched_episodes import Trace
from maniskill_taskgrasp.train.cells import Json, read_results
from maniskill_taskgrasp.train.script import run_script
from maniskill_taskgrasp.train.traces import file_label, load_trace

PAGE = "report.html"
TEMPLATE = "report.html.jinja"
MOST_MISSES = 8  # Missed episodes that are shown, worst pairs first.


def write_report(folder: Path) -> Path:
    """Write report.html and its PNGs beside results.json.

    Raises:
        InputError: the folder holds no results or damaged ones, or matplotlib is missing.
    """
    document = read_results(folder)
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise InputError(
            "the report needs matplotlib: pip install 'maniskill-taskgrasp[train]'"
        ) from None
    page = folder / PAGE
    write_atomically(page, _page(document, folder).encode())
    return page


@dataclass(frozen=True)
class ReportConfig:
    """Write the report of an evaluation again."""

    folder: Positional[Path]
    """Folder of `taskgrasp evaluate --out`."""


def main(config: ReportConfig) -> None:
    """Write the page and print where it is."""
    print(write_report(config.folder))


def _page(document: Json, folder: Path) -> str:
    from jinja2 import Environment

    from maniskill_taskgrasp.train import figures

    measured = [cell for cell in document["cells"] if cell["episodes"]]
    rows = _rows(measured)
    pictures: dict[str, str] = {}
    if rows:
        pictures["heat_map"] = _saved(folder, "heat_map", figures.png(figures.heat_map(rows)))
        bars = figures.png(figures.failure_bars(document["topologies"]))
        pictures["failures"] = _saved(folder, "failures", bars)
    text = files("maniskill_taskgrasp.train").joinpath(TEMPLATE).read_text("utf-8")
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"percent": _percent, "interval": _interval}
    return environment.from_string(text).render(
        document=document,
        rows=rows,
        colour=figures.heat_colour,
        measured=measured,
        refused=[cell for cell in document["cells"] if not cell["offered"]],
        failures=FAILURES[1:],
        codes=sorted({cell["code"] for cell in measured}),
        pictures=pictures,
        examples=list(_examples(rows, document["config"], folder)),
        can_render=rendering_available(),
    )


def _rows(cells: list[Json]) -> list[tuple[str, list[Json]]]:
    """Cells by topology, in the data set's order."""
    names = sorted({c["topology"] for c in cells}, key=lambda name: resolve_topology(name).index)
    return [(name, [cell for cell in cells if cell["topology"] == name]) for name in names]


def _examples(
    rows: list[tuple[str, list[Json]]], config: Json, folder: Path
) -> Iterator[dict[str, Any]]:
    """A success of each topology, then misses of the worst pairs."""
    for _, cells in rows:
        for cell in cells:
            trace = _trace(folder, cell, "success")
            if trace is not None:
                yield _example(cell, trace, "success", config, folder)
                break
    worst = sorted((c for _, cells in rows for c in cells), key=lambda c: c["rate"])
    missed = [(cell, _trace(folder, cell, "miss")) for cell in worst]
    for cell, trace in [(c, t) for c, t in missed if t is not None][:MOST_MISSES]:
        yield _example(cell, trace, "miss", config, folder)


def _trace(folder: Path, cell: Json, kind: str) -> Trace | None:
    slug = resolve_topology(cell["topology"]).slug
    return load_trace(folder, slug, cell["object"], cell["text"] or "", kind)


def _example(cell: Json, trace: Trace, kind: str, config: Json, folder: Path) -> dict[str, Any]:
    from maniskill_taskgrasp.train import figures

    title = f"{cell['topology']}, {cell['object']} ({cell['presentation']})"
    label = file_label(cell["object"], cell["text"] or "")
    name = f"{kind}-{resolve_topology(cell['topology']).slug}-{label}"
    figure = figures.png(figures.example(trace, library.load(cell["source"]), title))
    entry = {"title": title, "kind": kind, "seed": trace.seed, "film": None, "outcome": None}
    entry["figure"] = _saved(folder, name, figure)
    if rendering_available():
        from maniskill_taskgrasp.train.thumbnails import photograph

        strip, entry["outcome"] = photograph(cell, config, trace.seed)
        entry["film"] = _saved(folder, f"{name}-film", strip)
    return entry


def _saved(folder: Path, name: str, picture: bytes) -> str:
    """Keep a PNG beside the page; returns it as a data address, so that the page stands alone."""
    safe = "".join(c if c.isalnum() or c in "-_" else "_" for c in name)
    write_atomically(folder / "pictures" / f"{safe}.png", picture)
    return "data:image/png;base64," + base64.b64encode(picture).decode()


def _percent(rate: float | None) -> str:
    return "–" if rate is None else f"{100 * rate:.1f} %"


def _interval(bounds: list[float]) -> str:
    return f"{100 * bounds[0]:.1f}–{100 * bounds[1]:.1f}"


if __name__ == "__main__":
    run_script(main, ReportConfig)
