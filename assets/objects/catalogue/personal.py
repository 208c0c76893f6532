"""What people carry in pockets and bags, and glasses."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BRASS,
    STEEL,
    WHITE,
    disc,
    dots,
    ellipse,
    patch,
    rounded,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    arc,
    box,
    convex,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("coin", "household", "metal")
def coin(a: float, b: float, c: float) -> list[Piece]:
    r, face = a / 2, c / 2 - 1e-4
    beads = [
        disc(r * 0.05, "#a5822f").at(face, y, z) for _, y, z in arc(r * 0.78, 0, 345, 23, "yz")
    ]
    one = [
        box(4e-4, r * 0.14, r * 0.8, "#7d5f1c").seen_only().at(face),
        box(4e-4, r * 0.14, r * 0.3, "#7d5f1c")
        .turn((1, 0, 0), -40)
        .seen_only()
        .at(face, -r * 0.11, r * 0.31),
        box(4e-4, r * 0.5, r * 0.12, "#7d5f1c").seen_only().at(face, 0, -r * 0.4),
    ]
    return [
        turned([(-c / 2, r), (c / 2, r)], BRASS, hollow=(0.0001, r * 0.9)),
        disc(r * 0.45, "#a5822f").at(-face),
        *beads,
        *one,
    ]


@item("money", "household", "paper")
def money(a: float, b: float, c: float) -> list[Piece]:
    """Folded wad of notes."""
    notes = box(a, b, c, "#8fb08a")
    edges = [
        box(a + 2e-4, b + 2e-4, 3e-4, "#e6eadc").seen_only().at(0, 0, z)
        for z in (-0.0025, -0.0012, 0, 0.0012, 0.0025)
    ]
    return [
        notes,
        *edges,
        patch(a * 0.86, b * 0.76, "#6d946a").at(0, 0, c / 2),
        *(p.at(0, 0, c / 2 + 2e-4) for p in dots([(0, 0)], 0.0065, "#dfe6cf")),
        patch(0.006, b, "#f3efe0").at(a * 0.34, 0, c / 2 + 2e-4),
    ]


@item("contact case", "bathroom", "plastic")
def contact_case(a: float, b: float, c: float) -> list[Piece]:
    """One screw cup of a contact lens case."""
    r = a / 2
    cup = turned([(-c / 2, r * 0.8), (-c * 0.1, r * 0.95)], WHITE)
    lid = turned([(-c * 0.1, r), (c * 0.4, r), (c / 2, r * 0.9)], "#49a1d6", sides=20)
    letter = [
        box(6e-4, 0.0015, 0.008, WHITE).seen_only().at(c / 2, -0.0025),
        box(6e-4, 0.006, 0.0015, WHITE).seen_only().at(c / 2, 0, -0.0035),
    ]
    return [cup, lid, *letter]


@item("guitar pick", "household", "plastic")
def guitar_pick(a: float, b: float, c: float) -> list[Piece]:
    outline = [
        (a * 0.42, b * 0.4),
        (a / 2, b * 0.2),
        (a / 2, -b * 0.2),
        (a * 0.42, -b * 0.4),
        (a * 0.3, -b / 2),
        (0, -b * 0.42),
        (-a * 0.4, -b * 0.14),
        (-a / 2, -b * 0.04),
        (-a / 2, b * 0.04),
        (-a * 0.4, b * 0.14),
        (0, b * 0.42),
        (a * 0.3, b / 2),
    ]
    return [
        slab(outline, c, "#b5532a"),
        *(p.at(0, 0, c / 2) for p in dots([(a * 0.2, 0)], 0.004, "#e7b27c")),
    ]


def frame(
    x: float, y: float, lens: float, height: float, thick: float, colour: str, glass: str
) -> list[Piece]:
    """One lens of a pair of glasses in the xy plane with its rim."""
    return [
        slab(ellipse(lens, height), thick, colour).at(x, y),
        slab(ellipse(lens * 0.84, height * 0.8), thick + 6e-4, glass).seen_only().at(x, y),
    ]


@item("glasses", "household", "plastic")
def glasses(a: float, b: float, c: float) -> list[Piece]:
    """Reading glasses with folded arms."""
    lens = a * 0.42
    fronts = [
        p
        for s in (-1, 1)
        for p in frame(s * (a / 2 - lens / 2), 0, lens, b, c * 0.45, "#4b2e20", "#cfe6ee")
    ]
    bridge = box(a * 0.18, 0.004, c * 0.45, "#4b2e20").at(0, b * 0.14)
    arms = [
        box(a * 0.9, 0.004, c * 0.24, "#4b2e20")
        .at(s * a * 0.03, b * (0.2 - 0.1 * i), -c * (0.34 - 0.0 * i))
        .at(0, 0, c * 0.0 if i else 0)
        for i, s in ((0, 1), (1, -1))
    ]
    return [
        *(p.at(0, 0, c * 0.275) for p in (*fronts, bridge)),
        arms[0].at(0, 0, -c * 0.04),
        arms[1].at(0, 0, c * 0.2),
    ]


@item("safety glasses", "household", "plastic", shown="standing")
def safety_glasses(a: float, b: float, c: float) -> list[Piece]:
    """Open glasses; people take them by one arm, 12.5 x 1 x 0.75 cm."""
    shield_ = [
        slab(
            [
                (-0.068, -0.02),
                (-0.06, -0.024),
                (-0.012, -0.024),
                (0, -0.008),
                (0.012, -0.024),
                (0.06, -0.024),
                (0.068, -0.02),
                (0.068, 0.024),
                (-0.068, 0.024),
            ],
            0.004,
            "#cfe8ee",
        )
    ]
    brow = box(0.136, 0.006, 0.0065, "#e07a2a").at(0, 0.022)
    arm = box(b, c, a, "#2d3136").at(-0.066, 0.018, -a / 2).held()
    other = box(b, c, a, "#2d3136").at(0.066, 0.018, -a / 2)
    # The lenses were in the xy plane: now they stand up along x and the arms lie level.
    return [p.turn((0, 0, 1), -90) for p in (*shield_, brow, arm, other)]


@item("goggles", "household", "plastic")
def goggles(a: float, b: float, c: float) -> list[Piece]:
    """Swimming goggles lying flat."""
    eyes = [
        p for s in (-1, 1) for p in frame(s * a * 0.16, 0, a * 0.24, b, c, "#2a5fa8", "#8fd0e8")
    ]
    bridge = box(a * 0.12, 0.005, c * 0.6, "#2a5fa8")
    straps = [
        slab(
            [
                (s * a * 0.26, -b * 0.25),
                (s * a * 0.26, b * 0.25),
                (s * a / 2, b * 0.14),
                (s * a / 2, -b * 0.14),
            ],
            c * 0.6,
            BLACK,
        )
        for s in (-1, 1)
    ]
    return [*eyes, bridge, *straps]


@item("nail clippers", "bathroom", "metal")
def nail_clippers(a: float, b: float, c: float) -> list[Piece]:
    lower = box(a, b * 0.86, 0.0022, STEEL).at(0, 0, -c / 2 + 0.0032)
    jaw = convex(
        [
            (x, s * b / 2, z)
            for s in (-1, 1)
            for x, z in (
                (a / 2 - 0.007, -c / 2),
                (a / 2, -c * 0.18),
                (a / 2, -c * 0.04),
                (a / 2 - 0.012, -c / 2 + 0.002),
                (a / 2 - 0.012, -c * 0.05),
            )
        ],
        STEEL,
    )
    lever = convex(
        [
            (x, s * b * 0.4, z)
            for s in (-1, 1)
            for x, z in (
                (a * 0.36, c * 0.02),
                (a * 0.36, c * 0.16),
                (-a * 0.46, c * 0.3),
                (-a * 0.46, c / 2),
                (-a * 0.3, c * 0.42),
            )
        ],
        "#9aa0a8",
    )
    post = rod(0.0025, c * 0.62, STEEL).along((0, 0, 1)).at(a * 0.3, 0, -c * 0.1)
    return [lower, jaw, lever, post]


@item("razor", "bathroom", "plastic")
def razor(a: float, b: float, c: float) -> list[Piece]:
    handle = turned(
        [(-a / 2, b * 0.36), (-a * 0.42, b / 2), (0, b * 0.42), (a / 2, b * 0.3)], "#2a63a8", c / b
    ).held()
    grips = [
        turned([(x, b * 0.475), (x + 0.003, b * 0.473)], BLACK, c / b).seen_only()
        for x in (-0.03, -0.022, -0.014)
    ]
    head = (
        box(0.012, 0.042, 0.009, "#30343b", 0.002).turn((0, 1, 0), 35).at(a / 2 + 0.005, 0, 0.002)
    )
    blade = (
        box(0.0085, 0.038, 6e-4, STEEL)
        .seen_only()
        .at(0, 0, 0.0045)
        .turn((0, 1, 0), 35)
        .at(a / 2 + 0.005, 0, 0.002)
    )
    return [handle, *grips, head, blade]


@item("zipper", "household", "metal")
def zipper_pull(a: float, b: float, c: float) -> list[Piece]:
    slider = slab(
        [
            (a / 2, -b * 0.34),
            (a / 2, b * 0.34),
            (a * 0.34, b / 2),
            (a * 0.12, b * 0.3),
            (a * 0.12, -b * 0.3),
            (a * 0.34, -b / 2),
        ],
        c,
        "#8f959d",
    )
    neck = box(a * 0.3, b * 0.24, c * 0.4, STEEL).at(a * 0.06, 0, c * 0.2)
    tab = slab(rounded(a * 0.5, b * 0.6, b * 0.2), c * 0.45, STEEL).at(-a * 0.25, 0, c * 0.2)
    hole = [p.at(-a * 0.36, 0, c * 0.43) for p in dots([(0, 0)], 0.0011, BLACK)]
    return [slider, neck, tab, *hole]
