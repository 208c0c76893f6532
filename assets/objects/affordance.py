"""What the selector must know of an object that is not in the human data, from its shape."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.knowledge import Affordance

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

ZINGG = 2 / 3  # Ratio of neighbouring extents above which they count as alike.
CAP_LENGTH, CAP_MASS = 0.15, 1.0  # [m], [kg] where the data set caps its measurements.
WIDE = 0.10  # [m] 46 of the data set's 50 objects that are wider, and at most 8 cm thin, are held
# across their thinnest extent; of its 8 disks that are held across the rim one is wider.
HALF_HAND = 0.02  # [m] Half the breadth of two fingers, which close on so much of the length.
ROUND_FILL = 0.06  # Share by which a silhouette may differ from its ellipse and count as round.

TYPES = {
    ("prolate", "a"): ("cylinder", "b/c"),
    ("prolate", "non-round"): ("long prism", "b/c"),
    ("equant", "abc"): ("sphere", "a/b/c"),
    ("equant", "c"): ("cubic cylinder", "a/b"),
    ("equant", "a"): ("cubic cylinder", "b/c"),
    ("equant", "non-round"): ("cubic", "b"),
    ("bladed", "a"): ("ellipse A", "b/c"),
    ("bladed", "c"): ("ellipse C", "a/b"),
    ("bladed", "non-round"): ("irregular", "c"),
    ("oblate", "c"): ("disk", "a/b"),
    ("oblate", "a"): ("short ellipse", "b"),
    ("oblate", "non-round"): ("short prism", "c"),
}
"""(shape, roundness) -> the data set's Type, a function of the two there, and the axes along which
people most often close the hand on such objects (a tie is broken by the larger class)."""


def zingg_shape(dimensions: Sequence[float]) -> str:
    """Class after Zingg of extents a >= b >= c, as the data set uses it."""
    a, b, c = dimensions
    wide, thick = b / a > ZINGG + 1e-9, c / b > ZINGG + 1e-9
    if wide:
        return "equant" if thick else "oblate"
    return "prolate" if thick else "bladed"


def roundness(points: Array, shape: str) -> str:
    """Axis about which points (n, 3) of a surface, object frame, look round: a, c, abc or none.

    Looking along an axis, the silhouette of a round thing fills pi / 4 of its box and is nowhere
    outside the ellipse in it.
    """
    round_axes = {name for axis, name in ((0, "a"), (2, "c")) if _round_along(points, axis)}
    if shape == "equant" and round_axes == {"a", "c"} and _round_along(points, 1):
        return "abc"
    for name in ("c", "a") if shape in ("oblate", "equant") else ("a", "c"):
        if name in round_axes and (shape, name) in TYPES:
            return name
    return "non-round"


def _round_along(points: Array, axis: int) -> bool:
    from scipy.spatial import ConvexHull

    flat = np.delete(points, axis, axis=1)
    centre, half = (flat.min(0) + flat.max(0)) / 2, np.ptp(flat, axis=0) / 2
    unit = (flat - centre) / half
    fill = ConvexHull(unit).volume / np.pi  # Area of the hull, 1 for a circle.
    return bool(abs(fill - 1) < ROUND_FILL and np.linalg.norm(unit, axis=1).max() < 1 + ROUND_FILL)


def middle_box(mesh: trimesh.Trimesh, com: Array) -> tuple[Array, Array]:
    """Centre and extents (3,) [m] of what a hand closes on: the length, and the middle's width.

    The data set measures the portion that people grasp. Of an object that nobody labelled it is
    taken to be where the planner aims: two fingers' breadth about the centre of mass along x, the
    longest axis. A glass is as wide there as its stem, a pair of headphones as its band.

    Args:
        mesh: in the object frame.
        com: (3,) [m] centre of mass.
    """
    ends = com[0] - HALF_HAND, com[0] + HALF_HAND
    x = mesh.vertices[:, 0]
    within = mesh.vertices[(x >= ends[0]) & (x <= ends[1])]
    edges = mesh.vertices[mesh.edges_unique]
    middle = np.concatenate([within, *(_crossings(edges, end) for end in ends)])
    low, high = mesh.bounds.copy()
    if len(middle):
        low[1:], high[1:] = middle[:, 1:].min(0), middle[:, 1:].max(0)
    return (low + high) / 2, high - low


def _crossings(edges: Array, x: float) -> Array:
    """(k, 3) points at which edges (n, 2, 3) pass through the plane at x."""
    start, end = edges[:, 0], edges[:, 1]
    passing = (start[:, 0] - x) * (end[:, 0] - x) < 0
    start, way = start[passing], (end - start)[passing]
    return start + way * ((x - start[:, 0]) / way[:, 0])[:, None]


def describe(name: str, extents: Sequence[float], mass: float, points: Array) -> Affordance:
    """Affordance from extents [m] where the object is grasped and all its surface points (n, 3)."""
    extents = sorted((float(extent) for extent in extents), reverse=True)
    shape = zingg_shape(extents)
    round_about = roundness(points, shape)
    kind, grasped = TYPES[shape, round_about]
    a, b, c = (min(extent, CAP_LENGTH) for extent in extents)
    if b > WIDE:
        grasped = "c"
    return Affordance(
        name=name,
        dimensions_m=(a, b, c),
        mass_kg=min(mass, CAP_MASS),
        grasped_dimension=grasped,
        rigidity="rigid",
        roundness=round_about,
        shape=shape,
        type=kind,
    )
