"""Wrenches, keys and tools with a cross handle."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    DARK_STEEL,
    GREY,
    RED,
    STEEL,
    band,
    disc,
    patch,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("wrench", "tools", "metal", length=0.17)
def wrench(a: float, b: float, c: float) -> list[Piece]:
    bar = box(a - 0.036, b * 0.52, c * 0.75, STEEL)
    groove = patch(a * 0.5, b * 0.26, GREY).at(0, 0, c * 0.375)
    pieces = [bar, groove]
    for s in (-1, 1):
        base = slab(
            [
                (s * (a / 2 - 0.026), -b * 0.28),
                (s * (a / 2 - 0.018), -b / 2),
                (s * (a / 2 - 0.01), -b / 2),
                (s * (a / 2 - 0.01), b / 2),
                (s * (a / 2 - 0.018), b / 2),
                (s * (a / 2 - 0.026), b * 0.28),
            ],
            c,
            STEEL,
        )
        tips = [
            slab(
                [
                    (s * (a / 2 - 0.0105), t * b * 0.28),
                    (s * (a / 2 - 0.0105), t * b / 2),
                    (s * a / 2, t * b * 0.4),
                    (s * a / 2, t * b * 0.28),
                ],
                c,
                STEEL,
            )
            for t in (-1, 1)
        ]
        pieces += [base, *tips]
    return pieces


def hex_key(a: float, b: float, colour: str) -> list[Piece]:
    """Bent hexagon bar: the long arm along x is what people hold."""
    long = turned([(-a / 2, b / 2), (a / 2, b / 2)], colour, sides=8).held()
    short = turned([(0, b / 2), (0.03, b / 2)], colour, sides=8).along((0, 1, 0)).at(a / 2 - b / 2)
    return [long, short]


@item("allen wrench", "tools", "metal")
def allen_wrench(a: float, b: float, c: float) -> list[Piece]:
    return hex_key(a, b / 0.924, "#34373c")


@item("hex wrench", "tools", "metal")
def hex_wrench(a: float, b: float, c: float) -> list[Piece]:
    key = hex_key(a, b / 0.924, STEEL)
    return [*key, band(b / 2, 0.045, BLUE).at(-a * 0.24)]


def t_handle(x: float, width: float, r: float, colour: str) -> Piece:
    """Sliding bar across the end of a tool."""
    return (
        turned(
            [
                (-width / 2, r * 1.4),
                (-width / 2 + 0.004, r * 1.4),
                (-width / 2 + 0.0045, r),
                (width / 2 - 0.0045, r),
                (width / 2 - 0.004, r * 1.4),
                (width / 2, r * 1.4),
            ],
            colour,
        )
        .along((0, 1, 0))
        .at(x)
    )


@item("chuck key", "tools", "metal")
def chuck_key(a: float, b: float, c: float) -> list[Piece]:
    shaft = turned([(-a / 2, b / 2), (a * 0.3, b / 2)], DARK_STEEL).held()
    gear = turned(
        [(a * 0.3, b / 2), (a * 0.42, b / 2)],
        STEEL,
        sides=12,
    ).held()
    tip = turned([(a * 0.42, b * 0.25), (a / 2, b * 0.25)], STEEL).held()
    square = box(0.012, b, c, DARK_STEEL).at(-a / 2 + 0.006).held()
    return [shaft, gear, tip, square, t_handle(-a / 2 + 0.006, 0.07, 0.003, STEEL)]


@item("lathe key", "tools", "metal")
def lathe_key(a: float, b: float, c: float) -> list[Piece]:
    """Square-ended chuck key without its bar, which is taken out."""
    shaft = turned(
        [(-a / 2, b / 2), (-a * 0.2, b / 2), (-a * 0.18, b * 0.36), (a * 0.3, b * 0.36)], STEEL
    )
    square = box(a * 0.22, b * 0.66, c * 0.66, DARK_STEEL).at(a * 0.39)
    hole = [
        disc(0.0025, BLACK).turn((0, 1, 0), -90).at(-a * 0.36, 0, s * c / 2 * 0.99) for s in (-1, 1)
    ]
    return [shaft, square, *hole]


@item("tap with t-shaped handle", "tools", "metal")
def tap_with_t_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    shaft = turned(
        [(-a / 2, r), (-a * 0.2, r), (-a * 0.17, r * 0.5), (a * 0.1, r * 0.5)], STEEL
    ).held()
    tap = turned([(a * 0.1, r * 0.42), (a * 0.46, r * 0.42), (a / 2, r * 0.25)], "#8a6d2a").held()
    threads = [
        band(r * 0.42, 0.0015, "#5c4718").at(a * x) for x in (0.2, 0.24, 0.28, 0.32, 0.36, 0.4)
    ]
    return [shaft, tap, *threads, t_handle(-a * 0.42, 0.11, 0.005, STEEL)]


@item("tool with t-shaped handle", "tools", "metal")
def tool_with_t_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    shaft = turned(
        [(-a / 2, r), (-a * 0.4, r), (-a * 0.36, r * 0.6), (a * 0.5, r * 0.6)], STEEL
    ).held()
    grip = turned([(-0.045, 0.009), (-0.04, 0.011), (0.04, 0.011), (0.045, 0.009)], RED)
    return [shaft, grip.along((0, 1, 0)).at(-a / 2 + 0.002)]


@item("bit", "tools", "metal")
def screw_bit(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned([(-a / 2, r), (-a * 0.16, r)], DARK_STEEL),
        rod(r * 0.6, a * 0.5, STEEL).at(a * 0.08),
        turned([(a * 0.3, r * 0.8), (a * 0.42, r * 0.8), (a / 2, r * 0.2)], "#c9a24a"),
        band(r, 0.006, RED).at(-a * 0.24),
    ]
