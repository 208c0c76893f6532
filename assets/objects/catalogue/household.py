"""Electronics, small change, glasses, toys and the rest of a household."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BRASS,
    RED,
    STEEL,
    band,
    dots,
    patch,
    rounded,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("symbol", "household", "metal")
def symbol(a: float, b: float, c: float) -> list[Piece]:
    """Finger cymbal with a knob."""
    r = a / 2
    disc_ = turned([(-c / 2, r), (-c * 0.3, r), (-c * 0.05, r * 0.45), (c * 0.1, r * 0.2)], BRASS)
    return [disc_, turned([(c * 0.1, 0.003), (c * 0.3, 0.004), (c / 2, 0.003)], RED)]


@item("candle", "household", "wax")
def candle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    wax = turned(
        [(0, r), (a - 0.014, r), (a - 0.012, r * 0.94)], "#efe3c0", hollow=(0.0015, r * 0.8)
    )
    return [
        wax,
        turned([(a - 0.012, 0.0012), (a, 0.001)], BLACK),
        band(r, 0.02, "#c9a96a").at(0.02),
    ]


@item("placemat", "kitchen", "fabric", length=0.28, width=0.2)
def placemat(a: float, b: float, c: float) -> list[Piece]:
    stripes = [patch(0.006, b, "#e3d7b4").at(x, 0, c / 2) for x in (-0.12, -0.1, 0.1, 0.12)]
    return [box(a, b, c, "#5d7c8c"), *stripes, patch(a * 0.5, b * 0.7, "#6f8f9f").at(0, 0, c / 2)]


@item("scale", "kitchen", "plastic", length=0.22, width=0.16)
def kitchen_scale(a: float, b: float, c: float) -> list[Piece]:
    """Flat kitchen scale with a steel plate and a display."""
    low = c * 0.72
    body = slab(rounded(a, b, 0.012), low, "#e4e6e8").at(0, 0, (low - c) / 2)
    plate = slab(rounded(a * 0.62, b * 0.86, 0.012), c - low, STEEL).at(a * 0.15, 0, low / 2)
    screen = patch(a * 0.1, b * 0.5, "#9fb38f").at(-a * 0.36, 0, low - c / 2)
    return [
        body,
        plate,
        screen,
        *(
            p.at(-a * 0.36, s * b * 0.36, low - c / 2)
            for s in (-1, 1)
            for p in dots([(0, 0)], 0.006, RED)
        ),
    ]
