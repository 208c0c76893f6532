"""Brushes, sponges and other things to clean with; soap."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLUE,
    DARK_STEEL,
    GREEN,
    GREY,
    RED,
    STEEL,
    WHITE,
    YELLOW,
    band,
    brush_grip,
    brush_head,
    disc,
    dots,
    egg,
    open_box,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    rod,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("cleaning brush", "cleaning", "plastic")
def cleaning_brush(a: float, b: float, c: float) -> list[Piece]:
    head = [p.at(a + 0.032, 0, 0.004) for p in brush_head(0.075, 0.05, 0.034, BLUE, WHITE)]
    return [brush_grip(a, b, c, BLUE).held(), *head]


@item("dish washing brush", "cleaning", "plastic")
def dish_washing_brush(a: float, b: float, c: float) -> list[Piece]:
    back = turned([(-0.006, 0.02), (0, 0.027), (0.006, 0.027)], GREEN)
    tuft = turned([(0.006, 0.024), (0.026, 0.028)], WHITE)
    head = [p.along((0, 0, 1)).at(a + 0.022) for p in (back, tuft)]
    return [brush_grip(a, b, c, GREEN).held(), *head]


@item("scrubber", "cleaning", "plastic")
def scrubber(a: float, b: float, c: float) -> list[Piece]:
    pad = egg(0.06, 0.075, 0.04, GREY, 2.6).at(a + 0.022)
    return [brush_grip(a, b, c, RED).held(), pad, rod(0.012, 0.014, RED).at(a - 0.004)]


@item("toilet brush", "cleaning", "plastic", length=0.26)
def toilet_brush(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    handle = turned([(0, r), (0.1, r), (0.12, r * 0.6), (a, r * 0.6)], WHITE).held()
    head = turned([(0, 0.02), (0.012, 0.037), (0.06, 0.037), (0.075, 0.028)], "#d5dde0")
    rings = [band(0.037, 0.004, "#aab6bb").at(a + x) for x in (0.02, 0.034, 0.048)]
    return [handle, head.at(a - 0.004), *rings]


@item("duster", "cleaning", "plastic")
def duster(a: float, b: float, c: float) -> list[Piece]:
    tuft = turned([(0, 0.02), (0.03, 0.05), (0.09, 0.058), (0.15, 0.045), (0.18, 0.02)], "#8e6bb8")
    tips = [
        band(r, 0.006, "#a98ccb").at(a + x)
        for x, r in ((0.05, 0.0525), (0.1, 0.0572), (0.13, 0.0505))
    ]
    return [brush_grip(a, b, c, YELLOW).held(), tuft.at(a - 0.004), *tips]


@item("small brush", "cleaning", "plastic")
def small_brush(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    rows = [
        band(r, a * 0.012, "#5d4a36").at(a * x) for x in (0.17, 0.21, 0.25, 0.29, 0.33, 0.37, 0.41)
    ]
    return [
        turned([(-a / 2, r * 0.7), (-a / 2 + 0.004, r), (0, r * 0.8)], "#d23f6f"),
        rod(r * 0.4, a * 0.12, STEEL).at(a * 0.05),
        turned([(a * 0.1, r * 0.75), (a * 0.15, r), (a * 0.42, r), (a / 2, r * 0.5)], "#efe9d6"),
        *rows,
    ]


@item("wiper handle", "cleaning", "plastic", length=0.17)
def wiper_handle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    bar = turned([(0, r * 0.8), (0.006, r), (a * 0.8, r), (a, r * 0.7)], "#30343b").held()
    rings = [band(r, 0.004, YELLOW).at(x) for x in (0.03, 0.045, 0.06)]
    head = box(0.022, 0.24, 0.016, YELLOW, 0.002).at(a + 0.009)
    rubber = box(0.018, 0.24, 0.006, "#26282c").at(a + 0.029)
    return [bar, *rings, head, rubber]


@item("sponge", "cleaning", "foam")
def sponge(a: float, b: float, c: float) -> list[Piece]:
    soft = box(a, b, c * 0.72, "#f3d44a", 0.002).at(z=c * 0.14)
    rough = box(a, b, c * 0.28, "#3c7a3f").at(z=-c * 0.36)
    pores = dots(
        [
            (-0.04, 0.02),
            (-0.028, -0.016),
            (-0.015, 0.012),
            (0.0, -0.02),
            (0.006, 0.005),
            (0.02, 0.018),
            (0.026, -0.01),
            (0.04, 0.008),
            (0.04, -0.022),
            (-0.042, -0.006),
        ],
        0.002,
        "#d4b02c",
    )
    return [soft, rough, *(p.at(0, 0, c / 2) for p in pores)]


@item("sponge holder", "cleaning", "plastic")
def sponge_holder(a: float, b: float, c: float) -> list[Piece]:
    caddy = open_box(a, b, c * 0.7, 0.004, "#c9d3d8")
    soft = box(a * 0.8, b * 0.5, c - 0.01, "#f3d44a").at(z=-0.001)
    rough = box(a * 0.8, b * 0.5, 0.006, "#3c7a3f").at(z=c / 2 - 0.003)
    return [*(p.at(z=-c * 0.15) for p in caddy), soft, rough]


@item("sandpaper", "tools", "paper")
def sandpaper(a: float, b: float, c: float) -> list[Piece]:
    grains = [
        (-0.03, 0.02),
        (-0.02, -0.015),
        (-0.01, 0.01),
        (0.0, -0.02),
        (0.01, 0.018),
        (0.02, -0.008),
        (0.03, 0.012),
        (0.033, -0.02),
        (-0.033, -0.003),
        (0.005, 0.002),
        (-0.018, 0.023),
    ]
    return [
        box(a, b, c, "#9a6a3c"),
        *(p.at(0, 0, c / 2) for p in dots(grains, 0.0012, "#5c3a1c")),
        box(0.008, b, 0.0004, "#d9c7a4").seen_only().at(a / 2 - 0.004, 0, c / 2),
    ]


@item("paper towel roll", "kitchen", "paper", length=0.26)
def paper_towel_roll(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    ends = [
        d.at(s * a / 2)
        for s in (-1, 1)
        for d in (disc(0.022, "#a57c52"), disc(0.02, "#3b2d22").at(s * 0.0002))
    ]
    seam = box(a, 0.0012, 0.0012, "#d6d6d2").seen_only().at(0, 0, r - 0.0003)
    rings = [band(r, 0.001, "#dcdcd8").at(x) for x in (-0.065, 0, 0.065)]
    return [rod(r, a, "#fbfbf8"), *ends, seam, *rings]


@item("sink hose", "kitchen", "metal")
def sink_hose(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    stem = turned(
        [
            (-a / 2, r * 0.6),
            (-a / 2 + 0.012, r * 0.6),
            (-a / 2 + 0.014, r * 0.75),
            (a * 0.2, r * 0.8),
            (a * 0.36, r),
            (a / 2, r),
        ],
        STEEL,
    )
    face = disc(r * 0.85, "#33373d").at(a / 2)
    lever = box(0.035, 0.008, 0.004, "#33373d", 0.001).at(0.01, 0, r * 0.78)
    return [
        stem,
        face,
        lever,
        *(band(r * 0.62, 0.002, DARK_STEEL).at(-a / 2 + x) for x in (0.003, 0.007)),
    ]
