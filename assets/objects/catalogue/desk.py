"""What lies on a desk: pens, paper things, boxes, tape."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    BRASS,
    GREEN,
    GREY,
    RED,
    STEEL,
    WHITE,
    YELLOW,
    disc,
    dots,
    patch,
    rounded,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    bent,
    box,
    convex,
    ring,
    rod,
    slab,
)
from maniskill_taskgrasp.assets.objects.recipe import item

DESK = "stationery"


@item("book", DESK, "paper", length=0.21)
def book(a: float, b: float, c: float) -> list[Piece]:
    pages = box(a - 0.006, b - 0.005, c - 0.006, "#efe8d4").at(0, 0.0025)
    covers = [box(a, b, 0.003, "#7a2430").at(0, 0, s * (c - 0.003) / 2) for s in (-1, 1)]
    spine = box(a, 0.003, c, "#7a2430").at(0, -(b - 0.003) / 2)
    title = [
        patch(a * 0.5, 0.016, BRASS).at(0, b * 0.2, c / 2),
        patch(a * 0.3, 0.006, BRASS).at(0, b * 0.05, c / 2),
    ]
    return [pages, *covers, spine, *(t.turn((0, 0, 1), 0) for t in title)]


@item("cards", DESK, "paper")
def playing_cards(a: float, b: float, c: float) -> list[Piece]:
    card = slab(rounded(a, b, 0.004), c, WHITE)
    heart = [
        *dots([(0.002, 0.0055), (0.002, -0.0055)], 0.0068, RED),
        slab([(0.004, 0.0115), (0.004, -0.0115), (-0.014, 0)], 6e-4, RED).seen_only(),
    ]
    pips = [p for x in (-1, 1) for p in dots([(x * a * 0.4, x * b * 0.36)], 0.003, RED)]
    return [card, *(p.at(0, 0, c / 2) for p in (*heart, *pips))]


@item("picture", DESK, "paper", length=0.15)
def picture(a: float, b: float, c: float) -> list[Piece]:
    z = c / 2
    return [
        box(a, b, c, WHITE),
        patch(a * 0.9, b * 0.86, "#8fc3ea").at(0, 0, z),
        patch(a * 0.9, b * 0.36, GREEN).at(0, -b * 0.25, z + 0.0001),
        *(p.at(0, 0, z + 0.0002) for p in dots([(a * 0.28, b * 0.26)], 0.011, YELLOW)),
        slab([(-0.055, -0.012), (0.01, -0.012), (-0.022, 0.026)], 6e-4, "#6d7f95")
        .seen_only()
        .at(0, 0, z + 0.0003),
    ]


@item("stack of paper", DESK, "paper", length=0.21)
def stack_of_paper(a: float, b: float, c: float) -> list[Piece]:
    sheets = box(a, b, c, "#fafaf5")
    edges = [
        box(a + 2e-4, b + 2e-4, 3e-4, "#c9c9c2").seen_only().at(0, 0, z)
        for z in (-0.0075, -0.005, -0.0025, 0, 0.0025, 0.005, 0.0075)
    ]
    lines = [
        patch(a * 0.012, b * 0.8, GREY).at(x, 0, c / 2)
        for x in (-0.07, -0.05, -0.03, -0.01, 0.01, 0.03, 0.05)
    ]
    return [sheets, *edges, *lines, patch(0.006, b * 0.5, BLACK).at(0.085, -b * 0.12, c / 2)]


@item("post-it note", DESK, "paper")
def post_it_note(a: float, b: float, c: float) -> list[Piece]:
    lines = [patch(a * 0.7, 0.0014, BLUE).at(-0.004, y, c / 2) for y in (0.018, 0.006, -0.006)]
    return [
        box(a, b, c, "#f7e463"),
        *lines,
        patch(a * 0.4, 0.0014, BLUE).at(-0.016, -0.018, c / 2),
        patch(a, b * 0.13, "#e8cf3c").at(0, b * 0.433, c / 2),
    ]


@item("binder clip", DESK, "metal")
def binder_clip(a: float, b: float, c: float) -> list[Piece]:
    body = convex(
        [
            (x, s * y, z)
            for s in (-1, 1)
            for x, y, z in (
                (-a / 2, b / 2, -c / 2),
                (-a / 2, b / 2, c / 2),
                (a * 0.02, b / 2, 0.0006),
                (a * 0.02, b / 2, -0.0006),
            )
        ],
        BLACK,
    )
    loop = [
        (a * 0.0, -b * 0.32, 0),
        (a * 0.32, -b * 0.22, 0),
        (a / 2 - 0.001, -b * 0.1, 0),
        (a / 2 - 0.001, b * 0.1, 0),
        (a * 0.32, b * 0.22, 0),
        (a * 0.0, b * 0.32, 0),
    ]
    return [body, bent(loop, 0.001, STEEL)]


@item("safety pin", DESK, "metal")
def safety_pin(a: float, b: float, c: float) -> list[Piece]:
    wire = c * 0.36
    return [
        bent([(-a * 0.4, b * 0.38, 0), (a * 0.38, b * 0.4, 0)], wire, STEEL),
        bent([(-a * 0.4, -b * 0.36, 0), (a * 0.38, -b * 0.3, 0)], wire, STEEL),
        ring(b * 0.42, b * 0.2, c, STEEL, 6).along((0, 0, 1)).at(-a / 2 + b * 0.42),
        slab(
            [
                (a * 0.32, -b / 2),
                (a * 0.32, b / 2),
                (a * 0.46, b / 2),
                (a / 2, b * 0.3),
                (a / 2, -b * 0.3),
                (a * 0.46, -b / 2),
            ],
            c,
            BRASS,
        ),
    ]


@item("ruler", DESK, "wood")
def ruler(a: float, b: float, c: float) -> list[Piece]:
    ticks = [
        patch(0.0006, b * (0.4 if i % 5 == 0 else 0.22), BLACK).at(
            -a / 2 + 0.005 + 0.005 * i, b / 2 - b * (0.2 if i % 5 == 0 else 0.11), c / 2
        )
        for i in range(29)
    ]
    return [box(a, b, c, "#e0b866"), *ticks]


@item("protractor", DESK, "plastic")
def protractor(a: float, b: float, c: float) -> list[Piece]:
    def half(radius: float, rise: float) -> list[tuple[float, float]]:
        return [
            (radius * float(np.cos(t)), -b / 2 + rise * float(np.sin(t)))
            for t in np.linspace(0, np.pi, 15)
        ]

    body = slab(half(a / 2, b), c, "#9fd0ea")
    marks = [
        patch(0.0006, 0.006, BLACK)
        .turn((0, 0, 1), angle - 90)
        .at(
            (a / 2 - 0.006) * float(np.cos(np.radians(angle))),
            -b / 2 + 0.003 + (b - 0.012) * float(np.sin(np.radians(angle))),
            c / 2,
        )
        for angle in range(10, 180, 10)
    ]
    window = slab(half(a * 0.26, b * 0.4), 6e-4, "#e4f3fa").seen_only().at(0, 0.01, c / 2)
    return [body, *marks, window]


@item("roll of tape", DESK, "plastic")
def roll_of_tape(a: float, b: float, c: float) -> list[Piece]:
    core = ring(a * 0.312, a * 0.27, c * 0.98, "#b58c5a").seen_only()
    return [ring(a / 2, a * 0.29, c, "#9aa3ab"), core]


@item("tape roll", DESK, "plastic")
def tape_roll(a: float, b: float, c: float) -> list[Piece]:
    """Desk tape with its cutter: a roll 5 cm across in a holder 6 cm long."""
    r, shift = b / 2, -(a - b) / 2
    hub = [disc(r * 0.42, "#2f5f9f").turn((0, 1, 0), -90).at(shift, 0, s * c / 2) for s in (-1, 1)]
    rims = [
        disc(r * 0.6, WHITE).turn((0, 1, 0), -90).at(shift, 0, s * (c / 2 - 1e-4)) for s in (-1, 1)
    ]
    cutter = box(0.03, 0.012, c * 0.9, "#2f5f9f").at(a / 2 - 0.016, -r + 0.008)
    return [
        rod(r, c, "#d9cf8a").along((0, 0, 1)).at(shift),
        *rims,
        *hub,
        cutter,
        box(0.002, 0.014, c * 0.9, STEEL).at(a / 2 - 0.001, -r + 0.009),
    ]
