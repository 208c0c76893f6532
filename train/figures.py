"""Pictures of an evaluation: heat map, failure classes, fingertip paths and contact forces."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.assets.objects.geometry import part_triangles, quat_to_matrix
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.episode import CLOSE_START, CONTROL_FREQ, LIFT_START, PHASE_ENDS, PHASES
from maniskill_taskgrasp.tasks.outcome import FAILURES
from maniskill_taskgrasp.train.batched_episodes import DIGITS, Trace
from maniskill_taskgrasp.train.cells import Json

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D

DPI = 110
TILES = 8  # Most tiles on a line of the heat map.
# Okabe and Ito's palette: told apart by colour-blind readers too.
COLOURS = dict(
    zip(PARTS, ("#555555", "#0072B2", "#009E73", "#E69F00", "#CC79A7", "#D55E00"), strict=True)
)
FAILURE_COLOURS = dict(
    zip(
        FAILURES,
        ("#7fb77e", "#bdbdbd", "#56B4E9", "#E69F00", "#D55E00", "#CC79A7", "#555555"),
        strict=True,
    )
)
NOT_IN_FORM = "lifted, not in form"
NOT_IN_FORM_COLOUR = "#cfe3b4"
HEAT = colormaps["RdYlGn"]


def heat_colour(rate: float) -> tuple[str, str]:
    """Background and text colour of a rate in [0, 1]."""
    red, green, blue, _ = HEAT(0.08 + 0.84 * rate)
    light = 0.299 * red + 0.587 * green + 0.114 * blue > 0.55
    return to_hex((red, green, blue)), "#111111" if light else "#ffffff"


def png(figure: Figure) -> bytes:
    """The figure as a PNG file."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, facecolor="white")
    return buffer.getvalue()


def heat_map(rows: Sequence[tuple[str, list[Json]]]) -> Figure:
    """One line of tiles for each topology; colour is lift in the named topology.

    Args:
        rows: topology and its measured cells.
    """
    lines = [
        (topology if first == 0 else "", cells[first : first + TILES])
        for topology, cells in rows
        for first in range(0, len(cells), TILES)
    ]
    wide = max(len(cells) for _, cells in lines)
    figure = Figure(figsize=(2.4 + 1.55 * wide, 0.6 + 0.75 * len(lines)), layout="constrained")
    axes = figure.add_subplot()
    for y, (topology, cells) in enumerate(lines):
        axes.text(-0.1, y, topology, ha="right", va="center", fontsize=9)
        for x, cell in enumerate(cells):
            back, ink = heat_colour(cell["both_rate"])
            axes.add_patch(Rectangle((x + 0.02, y - 0.47), 0.96, 0.94, color=back))
            low, high = cell["both_ci95"]
            text = (
                f"{_short(cell['object'])}\n{100 * cell['both_rate']:.0f} % "
                f"[{100 * low:.0f}-{100 * high:.0f}]\nlift {100 * cell['rate']:.0f} %"
            )
            axes.text(x + 0.5, y, text, ha="center", va="center", fontsize=7, color=ink)
    axes.set(xlim=(-2.0, wide), ylim=(len(lines) - 0.5, -0.5))
    axes.axis("off")
    axes.set_title("Lifted in the named topology, with Wilson 95 % intervals", fontsize=10)
    return figure


def _short(name: str) -> str:
    return name if len(name) <= 22 else name[:21] + "…"


def failure_bars(rows: Sequence[Json]) -> Figure:
    """What became of the episodes of each topology, as shares.

    Args:
        rows: of `cells.by_topology`.
    """
    figure = Figure(figsize=(9, 1.1 + 0.36 * len(rows)), layout="constrained")
    axes = figure.add_subplot()
    classes = ["in form", NOT_IN_FORM, *FAILURES[1:]]
    colours = [FAILURE_COLOURS["none"], NOT_IN_FORM_COLOUR]
    colours += [FAILURE_COLOURS[name] for name in FAILURES[1:]]
    left = np.zeros(len(rows))
    for name, colour in zip(classes, colours, strict=True):
        share = np.array([_share(row, name) for row in rows])
        if share.any():
            label = "lifted in form" if name == "in form" else name.replace("_", " ")
            axes.barh(range(len(rows)), share, left=left, color=colour, label=label)
        left += share
    axes.set_yticks(range(len(rows)), [row["topology"] for row in rows], fontsize=9)
    axes.set(xlim=(0, 1), xlabel="share of episodes")
    axes.invert_yaxis()
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    return figure


def _share(row: Json, name: str) -> float:
    count = {"in form": row["both"], NOT_IN_FORM: row["successes"] - row["both"]}
    return count.get(name, row["failures"].get(name, 0)) / row["episodes"]


def example(trace: Trace, model: ObjectModel, title: str) -> Figure:
    """Fingertip paths around the object beside the contact forces over time."""
    figure = Figure(figsize=(9.6, 3.6), layout="constrained")
    figure.suptitle(title, fontsize=10)
    space: Axes3D = figure.add_subplot(1, 2, 1, projection="3d")  # type: ignore[assignment]
    _fingertips(space, trace, model)
    _forces(figure.add_subplot(1, 2, 2), trace)
    lines = [Line2D([], [], color=COLOURS[part], lw=2, label=part) for part in PARTS]
    figure.legend(handles=lines, loc="outside lower center", ncols=6, fontsize=8, frameon=False)
    return figure


def _fingertips(axes: Axes3D, trace: Trace, model: ObjectModel) -> None:
    """Lines from the start of closing to the lift; a dot is where the tip ends up."""
    centre = _draw_object(axes, model, trace.obj[CLOSE_START])
    reach = 0.0
    for digit, name in enumerate(DIGITS):
        path = 1000 * trace.tips[CLOSE_START:LIFT_START, digit]
        axes.plot(*path.T, color=COLOURS[name], lw=2)
        axes.scatter(*path[-1], color=COLOURS[name], s=22)
        reach = max(reach, float(np.abs(path - centre).max()))
    for axis, middle in zip("xyz", centre, strict=True):
        axes.set(**{f"{axis}lim": (middle - reach, middle + reach)})
    axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")
    axes.tick_params(labelsize=6)
    axes.locator_params(nbins=4)
    axes.set_box_aspect((1, 1, 1), zoom=1.25)
    axes.view_init(elev=18, azim=35)


def _draw_object(axes: Axes3D, model: ObjectModel, pose: NDArray[Any]) -> NDArray[np.float64]:
    """Draw the collision parts; returns the middle of their box (3,) [mm]."""
    local = np.concatenate([_outward(part_triangles(part)) for part in model.parts])
    world = 1000 * (local @ quat_to_matrix(pose[3:]).T + pose[:3])
    axes.add_collection3d(Poly3DCollection(world, facecolors="#d8c7a8", alpha=0.6, shade=True))
    corners = world.reshape(-1, 3)
    return (corners.min(0) + corners.max(0)) / 2


def _outward(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Triangles (m, 3, 3) of a convex part, wound so that light falls on their outsides."""
    a, b, c = triangles.transpose(1, 0, 2)
    away = a - triangles.reshape(-1, 3).mean(0)
    inward = (np.cross(b - a, c - a) * away).sum(1) < 0
    return np.where(inward[:, None, None], triangles[:, ::-1], triangles)


def _forces(axes: Any, trace: Trace) -> None:
    """Force of each part on the object, over the phases."""
    seconds = (np.arange(len(trace.forces)) + 1) / CONTROL_FREQ
    start = 0.0
    for number, (phase, end) in enumerate(zip(PHASES, PHASE_ENDS, strict=True)):
        stop = end / CONTROL_FREQ
        axes.axvspan(start, stop, color="#000000", alpha=0.05 * (number % 2), lw=0)
        axes.text((start + stop) / 2, 1.01, phase, transform=axes.get_xaxis_transform(),
                  ha="center", fontsize=7)  # fmt: skip
        start = stop
    for part, force in zip(PARTS, trace.forces.T, strict=True):
        if force.max() > 0:
            axes.plot(seconds, force, color=COLOURS[part], lw=1.4)
    axes.set(xlabel="time [s]", ylabel="contact force [N]", xlim=(0, seconds[-1]))
    axes.set_ylim(bottom=0)
    axes.spines[["top", "right"]].set_visible(False)
