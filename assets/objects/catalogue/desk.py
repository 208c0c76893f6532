"""What lies on a desk: pens, paper things, boxes, tape."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    BRASS,
    GREEN,
    GREY,
    ORANGE,
    RED,
    STEEL,
    WHITE,
    WOOD,
    YELLOW,
    band,
    disc,
    dots,
    open_box,
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


@item("command strip package", DESK, "paper")
def command_strip_package(a: float, b: float, c: float) -> list[Piece]:
    z = c / 2
    strips = [
        patch(0.012, 0.045, WHITE).at(x, -b * 0.12, z + 1e-4)
        for x in (-0.035, -0.012, 0.012, 0.035)
    ]
    return [
        box(a, b, c, "#d8322e"),
        patch(a * 0.84, b * 0.6, "#5b6570").at(0, -b * 0.12, z),
        *strips,
        patch(a * 0.6, b * 0.14, WHITE).at(0, b * 0.34, z),
        *(p.at(0, 0, z + 3e-4) for p in dots([(a * 0.44, b * 0.4)], 0.004, WHITE)),
    ]


@item("game", "toys", "paper")
def game(a: float, b: float, c: float) -> list[Piece]:
    """Folded board of squares."""
    z, n = c / 2, 6
    squares = [
        patch(a / n * 0.98, b / n * 0.98, "#2b2b2b" if (i + j) % 2 else RED).at(
            (i - (n - 1) / 2) * a / n, (j - (n - 1) / 2) * b / n, z
        )
        for i in range(n)
        for j in range(n)
    ]
    return [box(a, b, c, "#3a2a20"), *squares]


@item("cosmetic box", "bathroom", "paper")
def cosmetic_box(a: float, b: float, c: float) -> list[Piece]:
    lid = box(a, b, c * 0.4, "#e7b9c9").at(0, 0, c * 0.3)
    body = box(a * 0.985, b * 0.98, c * 0.6, "#f5dfe7").at(0, 0, -c * 0.2)
    flower = [
        *dots([(0.012, 0), (-0.012, 0), (0, 0.012), (0, -0.012)], 0.009, "#c9587c"),
        *dots([(0, 0)], 0.007, YELLOW),
    ]
    return [
        lid,
        body,
        *(p.at(0, 0, c / 2 + 1e-4 * i) for i, p in enumerate(flower)),
        box(0.02, 0.0012, 0.008, BRASS).seen_only().at(0, -b / 2, c * 0.08),
    ]


@item("jewelry box", "bathroom", "wood")
def jewelry_box(a: float, b: float, c: float) -> list[Piece]:
    base = box(a, b, c * 0.62, "#6b2f2a").at(0, 0, -c * 0.19)
    lid = convex(
        [
            (s * x, t * y, z)
            for s in (-1, 1)
            for t in (-1, 1)
            for x, y, z in (
                (a / 2, b / 2, c * 0.13),
                (a / 2, b / 2, c * 0.36),
                (a * 0.47, b * 0.38, c / 2),
            )
        ],
        "#84423a",
    )
    return [
        base,
        lid,
        box(0.012, 0.0016, 0.01, BRASS).seen_only().at(0, -b / 2, c * 0.1),
        *(patch(a * 0.8, 0.002, BRASS).at(0, s * b * 0.28, c / 2) for s in (-1, 1)),
        *(patch(0.002, b * 0.56, BRASS).at(s * a * 0.4, 0, c / 2) for s in (-1, 1)),
    ]


@item("top of box", "household", "paper")
def top_of_box(a: float, b: float, c: float) -> list[Piece]:
    """Lid of a box, lying open side up."""
    return open_box(a, b, c, 0.006, "#b98d5f")


@item("tool box compartment", "tools", "plastic")
def tool_box_compartment(a: float, b: float, c: float) -> list[Piece]:
    divider = box(0.003, b - 0.008, c - 0.005, RED).at(-a * 0.15, 0, 0.001)
    return [*open_box(a, b, c, 0.004, RED), divider]


@item("tool stand", "tools", "metal")
def tool_stand(a: float, b: float, c: float) -> list[Piece]:
    """Block with bores and three tools in it."""
    block = box(a, b, c * 0.62, "#3f5a7a", 0.002).at(0, 0, -c * 0.19)
    shanks = [
        turned([(0, 0.006), (c * 0.38, 0.006)], k).along((0, 0, 1)).at(x, 0, c * 0.12)
        for x, k in ((-0.05, STEEL), (0.0, BRASS), (0.05, STEEL))
    ]
    bores = dots([(-0.025, 0.018), (0.025, 0.018), (-0.025, -0.018), (0.025, -0.018)], 0.005, BLACK)
    return [block, *shanks, *(p.at(0, 0, c * 0.12) for p in bores)]


@item("tissue box", "bathroom", "paper")
def tissue_box(a: float, b: float, c: float) -> list[Piece]:
    """Pocket pack of tissues."""
    body = box(a, b, c * 0.8, "#6aa7d8", 0.003).at(0, 0, -c * 0.1)
    return [
        body,
        slab(
            [
                (x * a * 0.25, y * b * 0.16)
                for x, y in ((-1, 0), (-0.7, 1), (0.7, 1), (1, 0), (0.7, -1), (-0.7, -1))
            ],
            0.0006,
            WHITE,
        )
        .seen_only()
        .at(0, 0, c * 0.3),
        convex(
            [
                (-0.018, -0.001, c * 0.29),
                (0.018, -0.001, c * 0.29),
                (-0.018, 0.001, c * 0.29),
                (0.018, 0.001, c * 0.29),
                (0.01, 0.004, c / 2),
                (-0.012, -0.003, c / 2),
            ],
            WHITE,
        ),
        patch(a * 0.14, b * 0.8, ORANGE).at(-a * 0.4, 0, c * 0.3),
    ]


@item("tissue holder", "bathroom", "wood")
def tissue_holder(a: float, b: float, c: float) -> list[Piece]:
    body = box(a, b, c * 0.72, "#5d4330", 0.002).at(0, 0, -c * 0.14)
    slot = (
        slab(
            [
                (x * a * 0.3, y * b * 0.14)
                for x, y in ((-1, 0), (-0.8, 1), (0.8, 1), (1, 0), (0.8, -1), (-0.8, -1))
            ],
            6e-4,
            BLACK,
        )
        .seen_only()
        .at(0, 0, c * 0.22)
    )
    sheet = convex(
        [
            (-0.022, -0.001, c * 0.2),
            (0.022, -0.001, c * 0.2),
            (-0.022, 0.001, c * 0.2),
            (0.022, 0.001, c * 0.2),
            (0.012, 0.005, c / 2),
            (-0.015, -0.004, c / 2),
        ],
        WHITE,
    )
    return [body, slot, sheet]
