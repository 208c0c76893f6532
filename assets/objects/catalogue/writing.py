"""Pens, pencils and the brushes of painters."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    BRASS,
    GREEN,
    RED,
    STEEL,
    WHITE,
    WOOD,
    YELLOW,
    band,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    convex,
    rod,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item

DESK = "stationery"


@item("pen", DESK, "plastic")
def pen(a: float, b: float, c: float) -> list[Piece]:
    """Ball pen: barrel, metal tip, push button and clip within its width."""
    r = b / 2
    barrel = turned([(-a * 0.36, r), (a * 0.42, r), (a * 0.43, r * 0.7)], BLUE)
    tip = turned([(-a / 2, 0.0006), (-a * 0.46, r * 0.45), (-a * 0.36, r * 0.9)], STEEL)
    button = rod(r * 0.5, a * 0.07, STEEL).at(a * 0.465)
    clip = box(0.036, 0.0022, 0.0008, STEEL).seen_only().at(a * 0.28, 0, r)
    return [barrel, tip, button, clip, band(r, 0.004, STEEL).at(0)]


@item("pencil", DESK, "wood", length=0.18)
def pencil(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = rod(r * 0.97, a - 0.04, YELLOW).at(-0.001)
    cone = turned([(-a / 2, 0.0007), (-a / 2 + 0.004, 0.0013), (-a / 2 + 0.019, r * 0.95)], WOOD)
    lead = turned([(-a / 2 - 0.0002, 0.0007), (-a / 2 + 0.004, 0.0016)], BLACK).seen_only()
    ferrule = rod(r, 0.011, STEEL).at(a / 2 - 0.0155)
    eraser = turned(
        [(a / 2 - 0.01, r * 0.95), (a / 2 - 0.001, r * 0.95), (a / 2, r * 0.8)], "#e58a9a"
    )
    edges = [
        box(a - 0.05, 0.0006, 0.0006, "#c99a1e")
        .seen_only()
        .turn((0, 0, 1), 0)
        .at(-0.002, 0, r * 0.97)
        .turn((1, 0, 0), 60 * i)
        for i in range(6)
    ]
    return [body, cone, lead, ferrule, eraser, *edges]


@item("marker", DESK, "plastic")
def marker(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = rod(r * 0.96, a * 0.64, WHITE).at(-a * 0.17)
    cap = turned([(a * 0.14, r), (a * 0.46, r), (a / 2, r * 0.75)], RED)
    end = rod(r * 0.97, a * 0.03, RED).at(-a * 0.485)
    return [
        body,
        cap,
        end,
        band(r * 0.96, 0.03, RED).at(-a * 0.1),
        box(0.03, 0.0025, 0.0006, "#a3231b").seen_only().at(a * 0.28, 0, r),
    ]


@item("writing utensil", DESK, "metal")
def writing_utensil(a: float, b: float, c: float) -> list[Piece]:
    """Fountain pen."""
    r = b / 2
    barrel = turned(
        [
            (-a * 0.3, r * 0.75),
            (-a * 0.28, r * 0.9),
            (a * 0.1, r * 0.95),
            (a * 0.4, r * 0.8),
            (a / 2, r * 0.4),
        ],
        "#1e1f24",
    )
    grip = turned([(-a * 0.38, r * 0.6), (-a * 0.3, r * 0.72)], BLACK)
    nib = convex(
        [(-a * 0.38, s * 0.0032, z) for s in (-1, 1) for z in (-0.0005, 0.0012)]
        + [(-a / 2, 0, 0), (-a * 0.43, 0.003, 0.0006), (-a * 0.43, -0.003, 0.0006)],
        BRASS,
    )
    return [
        barrel,
        grip,
        nib,
        rod(r, 0.004, BRASS).at(-a * 0.1),
        band(r * 0.92, 0.002, BRASS).at(a * 0.2),
    ]


@item("paint brush", DESK, "wood", length=0.19)
def paint_brush(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    handle = turned([(-a / 2, r * 0.3), (-a * 0.1, r * 0.75), (a * 0.12, r * 0.6)], "#b23a2e")
    ferrule = turned([(a * 0.12, r * 0.6), (a * 0.28, r * 0.9)], STEEL)
    hair = turned(
        [(a * 0.28, r * 0.9), (a * 0.34, r), (a * 0.42, r * 0.7), (a / 2, 0.0004)], "#5a3a1f"
    )
    return [handle, ferrule, hair, band(r * 0.66, 0.002, BRASS).at(a * 0.09)]


@item("brush", DESK, "wood")
def fine_brush(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    handle = turned([(-a / 2, r * 0.5), (0, r), (a * 0.2, r * 0.8)], GREEN)
    return [
        handle,
        turned([(a * 0.2, r * 0.8), (a * 0.34, r * 0.9)], BRASS),
        turned([(a * 0.34, r * 0.9), (a * 0.4, r), (a / 2, 0.0003)], "#3b2a1a"),
    ]
