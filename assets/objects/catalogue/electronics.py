"""Clocks, phones, keys to press."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    GREY,
    RED,
    WHITE,
    disc,
    dome,
    dots,
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


def keys(
    columns: int, rows: int, pitch_x: float, pitch_y: float, size: float, colour: str
) -> list[Piece]:
    """Drawn square keys in a grid about the origin, facing +z."""
    return [
        patch(size, size, colour).at(
            (i - (columns - 1) / 2) * pitch_x, (j - (rows - 1) / 2) * pitch_y
        )
        for i in range(columns)
        for j in range(rows)
    ]


@item("alarm clock", "electronics", "plastic")
def alarm_clock(a: float, b: float, c: float) -> list[Piece]:
    """Round clock that lies on its back or stands on its rim."""
    r = a / 2
    case = turned(
        [(-c / 2, r * 0.9), (-c * 0.3, r), (c * 0.42, r), (c / 2, r * 0.96)],
        "#c23b34",
        hollow=(0.0012, r * 0.9),
    )
    face = disc(r * 0.84, WHITE).at(c / 2 - 0.001)
    z = c / 2 - 0.0006
    hands = [
        box(6e-4, 0.006, 0.045, BLACK).seen_only().at(z, 0, 0.018),
        box(6e-4, 0.032, 0.006, BLACK).seen_only().at(z, 0.014),
    ]
    marks = [
        box(6e-4, 0.003, 0.01, BLACK).seen_only().at(z, 0, r * 0.74).turn((1, 0, 0), 30 * i)
        for i in range(12)
    ]
    return [p.along((0, 0, 1)) for p in (case, face, *hands, *marks, disc(0.005, RED).at(z))]


@item("calculator", "electronics", "plastic")
def calculator(a: float, b: float, c: float) -> list[Piece]:
    z = c / 2
    grid = [k.at(-a * 0.12, 0, z) for k in keys(5, 4, 0.022, 0.026, 0.017, "#e6e6e0")]
    return [
        slab(rounded(a, b, 0.008), c, "#3b4148"),
        patch(a * 0.2, b * 0.84, "#b9c9a6").at(a * 0.36, 0, z),
        *grid,
        patch(0.017, 0.017, RED).at(-a * 0.12 + 0.044, 0.039, z + 1e-4),
    ]


@item("cell phone", "electronics", "plastic")
def cell_phone(a: float, b: float, c: float) -> list[Piece]:
    z = c / 2
    icons = [
        k.at(-0.004, 0, z + 2e-4)
        for (k,) in ((k,) for k in keys(4, 3, 0.016, 0.014, 0.008, "#f0b33c"))
    ]
    return [
        slab(rounded(a, b, 0.008), c, "#1f2227"),
        patch(a * 0.8, b * 0.88, "#3f78b8").at(0, 0, z),
        *icons,
        *(p.at(0, 0, z) for p in dots([(-a * 0.45, 0)], 0.003, GREY)),
        patch(0.0015, 0.012, GREY).at(a * 0.45, 0, z),
    ]


@item("phone", "electronics", "plastic")
def phone(a: float, b: float, c: float) -> list[Piece]:
    """Key phone with a small screen."""
    z = c / 2
    body = slab(rounded(a, b, 0.012), c, "#3a3f49")
    return [
        body,
        patch(a * 0.32, b * 0.74, "#a7c4a0").at(a * 0.22, 0, z),
        *(k.at(-a * 0.2, 0, z) for k in keys(4, 3, 0.0115, 0.0145, 0.009, WHITE)),
        patch(0.0015, 0.014, GREY).at(a * 0.45, 0, z),
    ]


@item("telephone", "electronics", "plastic")
def telephone(a: float, b: float, c: float) -> list[Piece]:
    """Receiver: a bar with ear and mouth piece, which face -z."""
    bar = convex(
        [
            (s * x, t * y, z)
            for s in (-1, 1)
            for t in (-1, 1)
            for x, y, z in (
                (a * 0.46, b * 0.36, c * 0.2),
                (a * 0.3, b * 0.34, c / 2),
                (a * 0.3, b * 0.34, c * 0.08),
                (a * 0.46, b * 0.36, c * 0.06),
            )
        ],
        "#25272c",
    )
    cups = [
        turned([(-c / 2, b * 0.42), (c * 0.0, b / 2), (c * 0.2, b * 0.42)], "#25272c")
        .along((0, 0, 1))
        .at(s * (a / 2 - b / 2))
        for s in (-1, 1)
    ]
    vents = [
        disc(0.0018, GREY).turn((0, 1, 0), -90).at(s * (a / 2 - b / 2) + dx, dy, -c / 2)
        for s in (-1, 1)
        for dx, dy in ((0, 0), (0.008, 0), (-0.008, 0), (0, 0.008), (0, -0.008))
    ]
    return [bar, *cups, *vents]


@item("remote", "electronics", "plastic", length=0.18)
def remote(a: float, b: float, c: float) -> list[Piece]:
    z = c / 2
    body = slab(rounded(a, b, 0.012), c, "#2b2e34")
    grid = [k.at(-0.01, 0, z) for k in keys(5, 3, 0.018, 0.016, 0.01, "#c9ccd2")]
    ring_ = [*dots([(0.058, 0)], 0.013, GREY), *dots([(0.058, 0)], 0.006, BLACK)]
    return [
        body,
        *grid,
        *(p.at(0, 0, z + i * 2e-4) for i, p in enumerate(ring_)),
        *(p.at(0, 0, z) for p in dots([(a * 0.45, b * 0.3)], 0.004, RED)),
        patch(0.02, 0.012, BLUE).at(-a * 0.4, 0, z),
    ]


@item("mouse", "electronics", "plastic")
def mouse(a: float, b: float, c: float) -> list[Piece]:
    body = dome(a, b, c, "#e3e5e8", 2.8).at(0, 0, -c / 2)
    split = [
        convex(
            [
                (x, s, z)
                for s in (-4e-4, 4e-4)
                for x, z in (
                    (a * 0.1, c * 0.4),
                    (a * 0.1, c * 0.485),
                    (a * 0.3, c * 0.415),
                    (a * 0.42, c * 0.2),
                    (a * 0.42, 0),
                )
            ],
            GREY,
        ).seen_only()
    ]
    wheel = rod(0.007, 0.006, BLACK).along((0, 1, 0)).at(a * 0.27, 0, c * 0.36)
    return [body, *split, wheel.seen_only()]


@item("cassette", "electronics", "plastic")
def cassette(a: float, b: float, c: float) -> list[Piece]:
    z = c / 2
    label = [
        patch(a * 0.88, b * 0.6, "#f0e6cf").at(0, b * 0.1, z),
        patch(a * 0.88, 0.006, RED).at(0, b * 0.3, z + 1e-4),
        patch(a * 0.42, b * 0.2, BLACK).at(0, b * 0.04, z + 2e-4),
    ]
    reels = [
        p.at(0, 0, z + 3e-4)
        for p in dots([(-a * 0.21, b * 0.04), (a * 0.21, b * 0.04)], 0.006, WHITE)
    ]
    foot = slab(
        [(-a * 0.34, -b / 2), (a * 0.34, -b / 2), (a * 0.3, -b * 0.32), (-a * 0.3, -b * 0.32)],
        c,
        "#1d1f22",
    )
    return [
        box(a, b, c * 0.85, "#2c2f33"),
        foot,
        *(p.at(0, 0, -c * 0.075) for p in (*label, *reels)),
    ]
