"""Handles, knobs, rods and tubes of machines."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BRASS,
    DARK_STEEL,
    GREY,
    RED,
    STEEL,
    WOOD,
    band,
    disc,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    ball,
    rod,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item

SHOP = "machine shop"


@item("handle", SHOP, "wood")
def tool_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned(
            [
                (-a / 2, r * 0.7),
                (-a * 0.46, r * 0.92),
                (-a * 0.3, r),
                (0, r * 0.88),
                (a * 0.3, r * 0.8),
                (a * 0.38, r * 0.7),
            ],
            WOOD,
        ),
        turned([(a * 0.38, r * 0.76), (a * 0.46, r * 0.76)], BRASS),
        rod(r * 0.2, a * 0.04, STEEL).at(a * 0.48),
    ]


@item("base of handle", SHOP, "metal")
def base_of_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned(
            [
                (-a / 2, r),
                (-a * 0.35, r),
                (-a * 0.35, r * 0.72),
                (a * 0.25, r * 0.72),
                (a * 0.3, r * 0.5),
                (a / 2, r * 0.5),
            ],
            DARK_STEEL,
        ),
        *(band(r * 0.5, 0.001, STEEL).at(a * x) for x in (0.34, 0.38, 0.42, 0.46)),
    ]


@item("clamp handle", SHOP, "metal")
def clamp_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [rod(r * 0.7, a - b, STEEL), *(ball(r, BLACK).at(s * (a / 2 - r)) for s in (-1, 1))]


@item("machine handle", SHOP, "plastic")
def machine_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned(
            [
                (-a / 2, r * 0.55),
                (-a * 0.3, r * 0.8),
                (0.004, r),
                (a * 0.25, r * 0.85),
                (a * 0.36, r * 0.55),
            ],
            BLACK,
        ),
        turned([(a * 0.36, r * 0.4), (a / 2, r * 0.4)], STEEL),
    ]


def knob(a: float, r: float, colour: str, sides: int = 40) -> list[Piece]:
    """Grip on a neck, standing on x = 0; r is the grip's radius."""
    neck = turned(
        [(0, r * 0.55), (a * 0.12, r * 0.55), (a * 0.18, r * 0.42), (a * 0.4, r * 0.42)], STEEL
    )
    grip = turned(
        [(a * 0.38, r * 0.7), (a * 0.5, r), (a * 0.8, r), (a, r * 0.66)], colour, sides=sides
    )
    return [neck, grip, disc(r * 0.3, STEEL).at(a)]


@item("knob", SHOP, "plastic")
def round_knob(a: float, b: float, c: float) -> list[Piece]:
    return knob(a, b / 2, BLACK)


@item("small knob", SHOP, "plastic")
def small_knob(a: float, b: float, c: float) -> list[Piece]:
    return knob(a, b / 2, RED)


@item("medium knob", SHOP, "metal")
def medium_knob(a: float, b: float, c: float) -> list[Piece]:
    return knob(a, b / 2 / 0.966, "#7d858f", sides=12)


@item("large knob", SHOP, "metal")
def large_knob(a: float, b: float, c: float) -> list[Piece]:
    return knob(a, b / 2, "#3d4b5c")


@item("door knob", "household", "metal")
def door_knob(a: float, b: float, c: float) -> list[Piece]:
    """Knob on its rosette, 5.5 cm high."""
    r = a / 2
    rosette = turned([(0, r * 0.9), (0.004, r * 0.9), (0.008, r * 0.6)], BRASS)
    neck = rod(r * 0.4, c * 0.4, BRASS).at(c * 0.25)
    grip = turned(
        [
            (c * 0.36, r * 0.55),
            (c * 0.5, r * 0.95),
            (c * 0.68, r),
            (c * 0.88, r * 0.8),
            (c, r * 0.4),
        ],
        BRASS,
    )
    return [rosette, neck, grip]


@item("knob on rod-like handle", SHOP, "plastic")
def knob_on_rod(a: float, b: float, c: float) -> list[Piece]:
    return [
        ball(a / 2, BLACK).at(0.06).held(),
        rod(0.005, 0.12, STEEL).at(-0.008),
        turned([(-0.072, 0.007), (-0.06, 0.007)], DARK_STEEL, sides=6),
    ]


@item("rod", SHOP, "metal", length=0.2)
def plain_rod(a: float, b: float, c: float) -> list[Piece]:
    return [rod(b / 2, a, STEEL)]


@item("thin rod", SHOP, "metal")
def thin_rod(a: float, b: float, c: float) -> list[Piece]:
    return [rod(b / 2, a, BRASS)]


@item("rod-like handle", SHOP, "metal", length=0.18)
def rod_like_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        rod(r * 0.6, a * 0.45, STEEL).at(-a * 0.275),
        turned([(-a * 0.05, r * 0.8), (0, r), (a * 0.44, r), (a / 2, r * 0.7)], BLACK),
        band(r, 0.002, GREY).at(0.01),
    ]


@item("rod-like handle on machine", SHOP, "metal", length=0.18)
def rod_like_handle_on_machine(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned([(-a / 2, r), (-a * 0.42, r)], DARK_STEEL, sides=12),
        rod(r * 0.62, a * 0.88, STEEL).at(0.02 * a),
        ball(r, RED).at(a / 2 - r),
    ]


@item("rod-like part", SHOP, "metal", length=0.16)
def rod_like_part(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned(
            [
                (-a / 2, r * 0.75),
                (-a * 0.2, r * 0.75),
                (-a * 0.2, r),
                (a * 0.2, r),
                (a * 0.2, r * 0.75),
                (a / 2, r * 0.75),
            ],
            "#98a2ac",
        ),
        *(
            band(r * 0.75, 0.001, DARK_STEEL).at(a * x)
            for x in (-0.47, -0.45, -0.43, 0.43, 0.45, 0.47)
        ),
    ]


def pipe(a: float, r: float, colour: str, bore: float) -> list[Piece]:
    """Closed-ended stand-in for a tube: the bore is drawn."""
    return [rod(r, a, colour), *(disc(r * bore, BLACK).at(s * a / 2) for s in (-1, 1))]


@item("plastic tube", SHOP, "plastic", length=0.18)
def plastic_tube(a: float, b: float, c: float) -> list[Piece]:
    return [*pipe(a, b / 2, "#e8e3d2", 0.75), band(b / 2, 0.001, "#b8b19a").at(a * 0.2)]


@item("tube", SHOP, "plastic", length=0.16)
def tube_of_paste(a: float, b: float, c: float) -> list[Piece]:
    return [
        *pipe(a, b / 2, "#5a86b8", 0.7),
        *(band(b / 2, 0.002, "#3f648f").at(a * x) for x in (-0.4, 0.4)),
    ]


@item("thin plastic tube", SHOP, "plastic")
def thin_plastic_tube(a: float, b: float, c: float) -> list[Piece]:
    return pipe(a, b / 2, "#d6ecd2", 0.7)
