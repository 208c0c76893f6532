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
    WOOD,
    YELLOW,
    band,
    brush_head,
    disc,
    dots,
    egg,
    open_box,
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


def grip(a: float, b: float, c: float, colour: str) -> Piece:
    """Round handle along x from 0 to a, thickest at its end, b x c across."""
    r = b / 2
    return turned([(0, r * 0.8), (0.006, r), (a * 0.3, r), (a, r * 0.75)], colour, c / b)


@item("cleaning brush", "cleaning", "plastic")
def cleaning_brush(a: float, b: float, c: float) -> list[Piece]:
    head = [p.at(a + 0.032, 0, 0.004) for p in brush_head(0.075, 0.05, 0.034, BLUE, WHITE)]
    return [grip(a, b, c, BLUE).held(), *head]


@item("dish washing brush", "cleaning", "plastic")
def dish_washing_brush(a: float, b: float, c: float) -> list[Piece]:
    back = turned([(-0.006, 0.02), (0, 0.027), (0.006, 0.027)], GREEN)
    tuft = turned([(0.006, 0.024), (0.026, 0.028)], WHITE)
    head = [p.along((0, 0, 1)).at(a + 0.022) for p in (back, tuft)]
    return [grip(a, b, c, GREEN).held(), *head]


@item("scrubber", "cleaning", "plastic")
def scrubber(a: float, b: float, c: float) -> list[Piece]:
    pad = egg(0.06, 0.075, 0.04, GREY, 2.6).at(a + 0.022)
    return [grip(a, b, c, RED).held(), pad, rod(0.012, 0.014, RED).at(a - 0.004)]


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
    return [grip(a, b, c, YELLOW).held(), tuft.at(a - 0.004), *tips]


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
    return [grip(a, b, c, "#7b2d5b").held(), back, pad, *pins]


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


@item("small brush", "cleaning", "plastic")
def small_brush(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned([(-a / 2, r * 0.7), (-a / 2 + 0.004, r), (0, r * 0.8)], "#d23f6f"),
        rod(r * 0.4, a * 0.12, STEEL).at(a * 0.05),
        turned([(a * 0.1, r * 0.75), (a * 0.15, r), (a * 0.42, r), (a / 2, r * 0.5)], "#efe9d6"),
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


def soap_bar(a: float, b: float, c: float, colour: str, mark: str) -> list[Piece]:
    """Bar of soap with a pressed mark."""
    return [egg(a, b, c, colour, 4.0), patch(a * 0.4, b * 0.16, mark).at(0, 0, c / 2 - 0.0001)]


@item("bar soap", "bathroom", "soap")
def bar_soap(a: float, b: float, c: float) -> list[Piece]:
    return soap_bar(a, b, c, "#f2e6d0", "#cdb98f")


@item("soap", "bathroom", "soap")
def soap(a: float, b: float, c: float) -> list[Piece]:
    body = box(a, b, c, "#e9a8b8", 0.003)
    return [body, patch(a * 0.55, b * 0.4, "#d07f95").at(0, 0, c / 2)]


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
