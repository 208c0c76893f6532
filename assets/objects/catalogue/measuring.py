"""What measures and marks."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    DARK_STEEL,
    RED,
    STEEL,
    WHITE,
    YELLOW,
    band,
    disc,
    dots,
    ellipse,
    patch,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    arc,
    bent,
    box,
    convex,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("calipers", "tools", "metal", length=0.2)
def calipers(a: float, b: float, c: float) -> list[Piece]:
    beam = box(a, 0.011, 0.0034, STEEL).at(0, 0.004)
    fixed = slab(
        [
            (-a / 2, -0.002),
            (-a / 2 + 0.012, -0.002),
            (-a / 2 + 0.012, -0.0125),
            (-a / 2 + 0.008, -0.0125),
        ],
        0.0034,
        STEEL,
    )
    fixed_up = slab(
        [(-a / 2, 0.009), (-a / 2 + 0.012, 0.009), (-a / 2 + 0.012, 0.0125)], 0.0034, STEEL
    )
    slide = box(0.05, 0.017, c, "#43474e", 0.0015).at(-a / 2 + 0.055, 0.003)
    jaw = slab(
        [
            (-a / 2 + 0.03, -0.004),
            (-a / 2 + 0.044, -0.004),
            (-a / 2 + 0.034, -0.0125),
            (-a / 2 + 0.03, -0.0125),
        ],
        0.0034,
        STEEL,
    )
    screen = patch(0.024, 0.01, "#b7c7a4").at(-a / 2 + 0.056, 0.003, c / 2)
    ticks = [
        patch(0.0005, 0.004, BLACK).at(-a / 2 + 0.09 + 0.008 * i, 0.006, 0.0017) for i in range(13)
    ]
    return [beam, fixed, fixed_up, slide, jaw, screen, *ticks]


@item("micrometer", "tools", "metal")
def micrometer(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    barrel = turned(
        [
            (0, r * 0.55),
            (a * 0.4, r * 0.55),
            (a * 0.41, r),
            (a * 0.84, r),
            (a * 0.86, r * 0.6),
            (a, r * 0.6),
        ],
        STEEL,
    ).held()
    marks = [band(r, 0.0008, BLACK).at(a * x) for x in (0.5, 0.55, 0.6)]
    spindle = rod(0.0035, 0.03, DARK_STEEL).at(-0.014)
    frame = bent([(x - 0.03, y, 0) for x, y, _ in arc(0.036, 15, -200, 6)], 0.006, "#30548c")
    anvil = rod(0.0035, 0.022, DARK_STEEL).at(-0.0565)
    return [barrel, *marks, spindle, frame, anvil]


@item("tape measure", "tools", "plastic")
def tape_measure(a: float, b: float, c: float) -> list[Piece]:
    case = slab(
        [
            (-a / 2 + 0.002, -b / 2),
            (a / 2, -b / 2),
            (a / 2, 0),
            (a * 0.38, b * 0.34),
            (a * 0.2, b / 2),
            (-a * 0.2, b / 2),
            (-a * 0.38, b * 0.38),
            (-a / 2, b * 0.2),
            (-a / 2, -b * 0.4),
        ],
        c,
        YELLOW,
    )
    faces = [disc(a * 0.36, BLACK).turn((0, 1, 0), -90).at(0, 0, s * c / 2) for s in (-1, 1)]
    label = disc(a * 0.26, YELLOW).turn((0, 1, 0), -90).at(0, 0, c / 2 + 0.0002)
    blade = box(0.0022, 0.002, 0.013, WHITE).at(a / 2, -b / 2 + 0.003)
    return [case, *faces, label, blade.seen_only()]


@item("thin parallel", "tools", "metal")
def thin_parallel(a: float, b: float, c: float) -> list[Piece]:
    bar = box(a, b, c, STEEL)
    holes = dots([(-a * 0.3, 0), (0, 0), (a * 0.3, 0)], 0.005, BLACK)
    return [bar, *(h.at(0, 0, s * c / 2) for h in holes for s in (-1, 1))]


@item("compass", "stationery", "metal")
def drawing_compass(a: float, b: float, c: float) -> list[Piece]:
    legs = [
        convex(
            [
                (x, s * y, z)
                for x, y in (
                    (a * 0.34, 0.0006),
                    (a * 0.34, b * 0.4),
                    (-a * 0.2, b / 2),
                    (-a * 0.2, b * 0.22),
                    (-a / 2, b * 0.3),
                    (-a / 2, b * 0.36),
                )
                for z in (-c * 0.3, c * 0.3)
            ],
            STEEL,
        )
        for s in (-1, 1)
    ]
    head = turned(
        [(a * 0.34, c / 2), (a * 0.38, c / 2), (a * 0.4, c * 0.3), (a / 2, c * 0.3)], BLACK
    )
    hinge = slab(ellipse(b * 0.7, b * 0.7), c, DARK_STEEL).at(a * 0.31)
    lead = rod(0.0012, 0.012, RED).at(-a / 2 + 0.006, b * 0.33)
    return [*legs, head, hinge, lead.seen_only()]
