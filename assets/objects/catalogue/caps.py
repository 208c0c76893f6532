"""Caps, sprayers and nozzles of bottles and cans."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLUE,
    GREY,
    RED,
    WHITE,
    band,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("aerosol can cap", "bottles", "plastic")
def aerosol_can_cap(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned([(0, r), (c * 0.72, r * 0.96), (c * 0.9, r * 0.86), (c, r * 0.6)], RED)
    return [body, band(r, c * 0.08, WHITE).at(c * 0.06)]


@item("bottle cap", "bottles", "plastic")
def bottle_cap(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    return [
        turned(
            [(0, r), (c * 0.8, r * 0.97), (c, r * 0.88)], BLUE, sides=20, hollow=(0.0006, r * 0.7)
        ),
        band(r * 0.985, c * 0.1, WHITE).at(c * 0.12),
    ]


def spray_head(colour: str, trim: str) -> list[Piece]:
    """Trigger sprayer in the xy plane: collar about the origin, nozzle towards -y."""
    body = slab(
        [
            (0.016, 0.015),
            (0.034, 0.022),
            (0.044, 0.02),
            (0.046, -0.028),
            (0.024, -0.028),
            (0.016, -0.012),
        ],
        0.018,
        colour,
    )
    trigger = slab(
        [(0.026, -0.019), (0.02, -0.0265), (-0.016, -0.0295), (-0.017, -0.025)], 0.011, trim
    )
    return [
        rod(0.014, 0.02, trim).at(0.008),
        body,
        rod(0.0065, 0.008, trim).along((0, 1, 0)).at(0.035, -0.0295),
        trigger,
    ]


@item("spray bottle", "bottles", "plastic", length=0.24)
def spray_bottle(a: float, b: float, c: float) -> list[Piece]:
    r, flat, top = b / 2, c / b, a - 0.05
    body = turned(
        [
            (0, r * 0.93),
            (0.005, r),
            (0.1, r),
            (0.125, r * 0.75),
            (top - 0.015, r * 0.36),
            (top, r * 0.36),
        ],
        "#6fc3e0",
        flat,
    )
    head = [p.at(top + 0.004, 0.0036) for p in spray_head(RED, WHITE)]
    return [body, *head, band(r, 0.06, WHITE, flat).at(0.058)]


@item("spray bottle cap", "bottles", "plastic", shown="standing")
def spray_bottle_cap(a: float, b: float, c: float) -> list[Piece]:
    collar = turned([(0, c / 2), (0.016, c / 2), (0.02, c * 0.36)], WHITE, sides=16).along(
        (0, 1, 0)
    )
    body = slab(
        [(-0.018, 0.018), (-0.03, 0.034), (-0.028, b), (0.03, b), (0.03, 0.026), (0.014, 0.018)],
        0.019,
        BLUE,
    )
    nozzle = rod(0.008, 0.012, WHITE).at(a - 0.03 - 0.006, 0.036)
    trigger = slab([(0.018, 0.028), (0.026, 0.028), (0.037, 0.0005), (0.032, 0.002)], 0.012, WHITE)
    pieces = [collar, body, nozzle, trigger]
    return [piece.turn((0, 0, 1), -90) for piece in pieces]  # +y was up.


@item("can nozzle", "bottles", "plastic")
def can_nozzle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    button = turned([(0, r), (0.012, r), (0.015, r * 0.8)], WHITE)
    return [
        button,
        rod(r * 0.35, a - 0.015, RED).at((a + 0.015) / 2),
        turned([(0, r * 0.6), (0.006, r * 0.6)], GREY).at(0.015),
    ]


@item("plastic top", "bottles", "plastic")
def plastic_top(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned(
            [(0, r), (a * 0.2, r), (a * 0.22, r * 0.93), (a * 0.9, r * 0.86), (a, r * 0.78)],
            "#3b7fc4",
            hollow=(0.0015, r * 0.7),
        ),
        *(
            band(r * k, 0.002, "#2a5d94").at(x)
            for x, k in ((a * 0.35, 0.918), (a * 0.5, 0.902), (a * 0.65, 0.886))
        ),
    ]
