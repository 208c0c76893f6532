"""Bits, drills and cutters that go into machines."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BRASS,
    DARK_STEEL,
    STEEL,
    band,
    disc,
    patch,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    convex,
    rod,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


def twist(r: float, start: float, end: float, colour: str, step: float) -> list[Piece]:
    """Drill flutes: a straight core with drawn rings."""
    rings, x = [], start + step
    while x < end - step / 2:
        rings.append(band(r, step * 0.35, "#5c626a").at(x))
        x += step
    return [rod(r, end - start, colour).at((start + end) / 2), *rings]


@item("drill bit", "machine shop", "metal")
def drill_bit(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    point = turned([(a / 2 - 0.004, r * 0.99), (a / 2, 0.0)], STEEL)
    return [
        rod(r * 0.99, a * 0.38, STEEL).at(-a * 0.31),
        *twist(r, -a * 0.12, a / 2 - 0.004, "#9aa0a8", 0.005),
        point,
    ]


@item("drill part", "machine shop", "metal")
def drill_part(a: float, b: float, c: float) -> list[Piece]:
    """Taper arbor of a drill chuck."""
    r = b / 2
    return [
        turned(
            [
                (-a / 2, r * 0.55),
                (-a * 0.1, r * 0.85),
                (-a * 0.08, r),
                (0.002, r),
                (0.004, r * 0.7),
                (a / 2, r * 0.5),
            ],
            STEEL,
        ),
        band(r, 0.002, DARK_STEEL).at(-0.002),
    ]


@item("chuck", "machine shop", "metal")
def chuck(a: float, b: float, c: float) -> list[Piece]:
    """Square tool blank with a ground edge, 10 x 1 x 1 cm, as held in a lathe's chuck."""
    shank = box(a * 0.86, b, c, DARK_STEEL).at(-a * 0.07)
    tip = convex(
        [(a * 0.36, s * b / 2, t * c / 2) for s in (-1, 1) for t in (-1, 1)]
        + [(a / 2, -b / 2, c / 2), (a * 0.45, b / 2, c / 2), (a * 0.46, -b / 2, -c / 2)],
        BRASS,
    )
    return [shank, tip, patch(a * 0.3, b * 0.4, STEEL).at(-a * 0.2, 0, c / 2)]


@item(
    "end mill",
    "machine shop",
    "metal",
)
def end_mill(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    flat = box(0.012, b * 0.5, 0.0006, DARK_STEEL).seen_only().at(-a * 0.25, 0, r * 0.97)
    return [
        rod(r, a * 0.55, STEEL).at(-a * 0.225),
        flat,
        *twist(r * 0.96, a * 0.05, a / 2, BRASS, 0.0065),
    ]


@item("end mill holder", "machine shop", "metal")
def end_mill_holder(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned([(-a / 2, r * 0.42), (0, r * 0.86)], STEEL),
        turned(
            [(0, r), (0.008, r), (0.008, r * 0.82), (0.014, r * 0.82), (0.014, r), (0.022, r)],
            DARK_STEEL,
        ),
        turned([(0.022, r * 0.7), (a / 2, r * 0.7)], STEEL),
        disc(r * 0.3, BLACK).at(a / 2),
        disc(0.004, BLACK).along((0, 0, 1)).at(a * 0.32, 0, r * 0.7),
    ]


@item("endmill part", "machine shop", "metal")
def endmill_part(a: float, b: float, c: float) -> list[Piece]:
    """Collet chuck with a cutter in it."""
    r = b / 2
    return [
        turned([(-a / 2, r * 0.55), (-0.02, r * 0.55), (-0.018, r), (0.002, r)], STEEL),
        turned([(0.002, r * 0.95), (0.026, r * 0.95), (0.03, r * 0.75)], DARK_STEEL, sides=16),
        *twist(r * 0.24, 0.03, a / 2, BRASS, 0.008),
    ]
