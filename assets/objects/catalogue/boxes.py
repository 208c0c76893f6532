"""Boxes, open ones too, and what is drawn out of them."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BRASS,
    ORANGE,
    RED,
    STEEL,
    WHITE,
    YELLOW,
    dots,
    open_box,
    patch,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    convex,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item

DESK = "stationery"


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
