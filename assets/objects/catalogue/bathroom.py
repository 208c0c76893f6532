"""Soap, brushes and holders of a bathroom."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLUE,
    GREY,
    RED,
    STEEL,
    WHITE,
    WOOD,
    band,
    brush_grip,
    disc,
    dots,
    egg,
    patch,
    rounded,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    convex,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("hair brush", "bathroom", "plastic")
def hair_brush(a: float, b: float, c: float) -> list[Piece]:
    back = convex(
        [
            (x, y * k, z)
            for x, y in rounded(0.1, 0.055, 0.026)
            for z, k in ((-0.01, 0.9), (0.004, 1.0))
        ],
        "#7b2d5b",
    ).at(a + 0.044)
    pad = slab(rounded(0.085, 0.042, 0.02), 0.004, GREY).at(a + 0.044, 0, 0.006)
    pins = [box(0.072, 0.002, 0.014, "#3a3a3a").at(a + 0.044, y, 0.014) for y in (-0.012, 0, 0.012)]
    return [brush_grip(a, b, c, "#7b2d5b").held(), back, pad, *pins]


@item("shower brush", "bathroom", "wood")
def shower_brush(a: float, b: float, c: float) -> list[Piece]:
    back = convex(
        [
            (x * k, y * k, z)
            for x, y in rounded(a, b, 0.019)
            for z, k in ((-c / 2, 0.85), (-c * 0.2, 1.0), (0, 1.0))
        ],
        WOOD,
    )
    tuft = box(a * 0.86, b * 0.74, c * 0.5, "#ece5cf").at(z=c * 0.25)
    lines = [
        box(0.0015, b * 0.74, 0.0006, "#c9bf9f").seen_only().at(x, 0, c / 2)
        for x in (-0.026, -0.013, 0, 0.013, 0.026)
    ]
    strap = box(0.022, b * 0.87, 0.0008, "#3a3a3a").seen_only().at(0, 0, -c / 2)
    return [back, tuft, *lines, strap]


@item("toothbrush", "bathroom", "plastic", length=0.18)
def toothbrush(a: float, b: float, c: float) -> list[Piece]:
    low = -c / 2 + 0.0026
    handle = box(a * 0.55, b * 0.8, 0.0052, BLUE, 0.002).at(-a * 0.225, 0, low)
    neck = box(a * 0.3, b * 0.45, 0.0048, BLUE, 0.001).at(a * 0.18, 0, low)
    head = box(0.034, b, 0.0045, BLUE, 0.001).at(a / 2 - 0.017, 0, low - 0.0002)
    tufts = box(0.028, b * 0.9, c - 0.0046, WHITE).at(a / 2 - 0.018, 0, 0.0023)
    stripe = box(0.008, b * 0.9, 0.0003, RED).seen_only().at(a / 2 - 0.018, 0, c / 2)
    grip_ = box(0.03, b * 0.5, 0.0003, WHITE).seen_only().at(-a * 0.2, 0, low + 0.0026)
    return [handle, neck, head, tufts, stripe, grip_]


def soap_bar(a: float, b: float, c: float, colour: str, mark: str) -> list[Piece]:
    """Bar of soap with a pressed mark."""
    return [egg(a, b, c, colour, 4.0), patch(a * 0.4, b * 0.16, mark).at(0, 0, c / 2 - 0.0001)]


@item("bar soap", "bathroom", "soap")
def bar_soap(a: float, b: float, c: float) -> list[Piece]:
    return soap_bar(a, b, c, "#f2e6d0", "#cdb98f")


@item("soap", "bathroom", "soap")
def soap(a: float, b: float, c: float) -> list[Piece]:
    body = box(a, b, c, "#e9a8b8", 0.003)
    bubbles = [
        *dots([(a * 0.1, -b * 0.12)], b * 0.15, WHITE),
        *dots([(a * 0.22, b * 0.14), (-a * 0.04, b * 0.16)], b * 0.1, WHITE),
        *dots([(a * 0.34, -b * 0.05), (-a * 0.12, -b * 0.2)], b * 0.06, WHITE),
    ]
    bands = [patch(a * 0.07, b, "#c2577a").at(x, 0, c / 2) for x in (-a * 0.3, a * 0.44)]
    return [body, *(bubble.at(0, 0, c / 2) for bubble in bubbles), *bands]


@item("soap dish", "bathroom", "ceramic")
def soap_dish(a: float, b: float, c: float) -> list[Piece]:
    dish = convex(
        [
            (x * k, y * k, z)
            for x, y in rounded(a, b, 0.025)
            for z, k in ((-c / 2, 0.8), (-c * 0.02, 1.0))
        ],
        "#cfe3ea",
    )
    rest = (
        slab(rounded(a * 0.86, b * 0.84, 0.022), 0.0006, "#a9c7d2").seen_only().at(0, 0, -c * 0.02)
    )
    bar = egg(a * 0.68, b * 0.62, c * 0.62, "#f2e6d0", 4.0).at(0, 0, c / 2 - c * 0.31)
    return [dish, rest, bar]


@item("toothbrush holder", "bathroom", "ceramic", shown="lying")
def toothbrush_holder(a: float, b: float, c: float) -> list[Piece]:
    holes = dots([(-0.028, 0), (0, 0), (0.028, 0)], 0.007, "#39424a")
    stripe = slab(rounded(a + 2e-4, b + 2e-4, 0.012), 0.004, BLUE).seen_only()
    return [
        slab(rounded(a, b, 0.012), c, "#dfe7ee"),
        *(hole.at(0, 0, c / 2) for hole in holes),
        *(stripe.at(0, 0, z) for z in (-0.009, 0.009)),
    ]


@item("toilet brushholder", "bathroom", "ceramic")
def toilet_brushholder(a: float, b: float, c: float) -> list[Piece]:
    flat, low = c / b, a * 0.62
    pot = turned([(0, b / 2), (low, b / 2 * 0.86)], "#e6eaec", flat)
    rim = turned([(low, b / 2 * 0.9), (low + 0.006, b / 2 * 0.9)], "#c4cdd1", flat)
    brush = [
        rod(0.008, a - low - 0.006, WHITE).at((a + low + 0.006) / 2),
        band(0.008, 0.012, BLUE).at(a - 0.02),
    ]
    return [pot, rim, *brush]


@item("shower head", "bathroom", "metal")
def shower_head(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    handle = turned(
        [(-a / 2, r * 0.7), (-a / 2 + 0.01, r), (a * 0.2, r), (a / 2, r * 0.8)], STEEL
    ).held()
    head = turned([(-0.018, 0.018), (0.0, 0.038), (0.012, 0.04)], STEEL).along((0.35, 0, 1))
    spots = [
        p.along((0.35, 0, 1))
        for p in (
            disc(0.034, "#2f3338").at(0.0123),
            *(
                disc(0.0018, WHITE).at(0.0128, y, z)
                for y in (-0.02, -0.007, 0.007, 0.02)
                for z in (-0.014, 0, 0.014)
            ),
        )
    ]
    return [handle, *(p.at(a / 2 + 0.022, 0, 0.0) for p in (head, *spots))]
