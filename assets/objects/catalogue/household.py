"""Electronics, small change, glasses, toys and the rest of a household."""

from __future__ import annotations

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
    band,
    disc,
    dome,
    dots,
    egg,
    ellipse,
    patch,
    rounded,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    ball,
    box,
    convex,
    ring,
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


@item("coin", "household", "metal")
def coin(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    return [
        turned([(-c / 2, r), (c / 2, r)], BRASS, hollow=(0.0001, r * 0.9)),
        disc(r * 0.45, "#a5822f").at(c / 2 - 1e-4),
        disc(r * 0.45, "#a5822f").at(-c / 2 + 1e-4),
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


@item("symbol", "household", "metal")
def symbol(a: float, b: float, c: float) -> list[Piece]:
    """Finger cymbal with a knob."""
    r = a / 2
    disc_ = turned([(-c / 2, r), (-c * 0.3, r), (-c * 0.05, r * 0.45), (c * 0.1, r * 0.2)], BRASS)
    return [disc_, turned([(c * 0.1, 0.003), (c * 0.3, 0.004), (c / 2, 0.003)], RED)]


@item("candle", "household", "wax")
def candle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    wax = turned(
        [(0, r), (a - 0.014, r), (a - 0.012, r * 0.94)], "#efe3c0", hollow=(0.0015, r * 0.8)
    )
    return [
        wax,
        turned([(a - 0.012, 0.0012), (a, 0.001)], BLACK),
        band(r, 0.02, "#c9a96a").at(0.02),
    ]


@item("ceramic fish", "toys", "ceramic")
def ceramic_fish(a: float, b: float, c: float) -> list[Piece]:
    body = egg(a * 0.74, b * 0.84, c, "#e0752d", 2.2).at(a * 0.13)
    tail = [
        slab(
            [
                (-a * 0.2, 0.0),
                (-a * 0.24, -s * 0.006),
                (-a / 2, s * b * 0.2),
                (-a / 2, s * b / 2),
                (-a * 0.42, s * b / 2),
            ],
            c * 0.45,
            "#c4541c",
        )
        for s in (-1, 1)
    ]
    fin = slab(
        [(0, b * 0.36), (a * 0.2, b * 0.36), (0.0, b / 2), (-a * 0.06, b / 2)], c * 0.4, "#c4541c"
    )
    eyes = [
        p
        for s in (-1, 1)
        for p in (
            *(d.at(a * 0.36, b * 0.1, s * c * 0.375) for d in dots([(0, 0)], 0.0045, WHITE)),
            *(
                d.at(a * 0.36, b * 0.1, s * (c * 0.375 + 2e-4))
                for d in dots([(0, 0)], 0.0022, BLACK)
            ),
        )
    ]
    stripes = [
        egg(0.005, b * 0.7, c * 0.98, WHITE, 2.0).seen_only().at(a * x) for x in (0.18, 0.02)
    ]
    return [body, *tail, fin, *eyes, *stripes]


@item("small toy", "toys", "plastic")
def small_toy(a: float, b: float, c: float) -> list[Piece]:
    """Turtle."""
    shell_ = dome(a * 0.68, b * 0.7, c * 0.86, GREEN, 2.2).at(-a * 0.06, 0, -c * 0.36)
    belly = slab(ellipse(a * 0.7, b * 0.72), c * 0.2, "#c9d98a").at(-a * 0.06, 0, -c * 0.36)
    head = ball(c * 0.26, "#8fbf5a").at(a / 2 - c * 0.26, 0, -c * 0.12)
    legs = [
        slab(ellipse(a * 0.26, b * 0.2), c * 0.24, "#8fbf5a")
        .turn((0, 0, 1), 40 * s * t)
        .at(-a * 0.06 + s * a * 0.3, t * (b / 2 - 0.008), -c * 0.38)
        for s in (-1, 1)
        for t in (-1, 1)
    ]
    eyes = [
        ball(0.0022, BLACK).seen_only().at(a / 2 - c * 0.11, s * c * 0.13, -c * 0.02)
        for s in (-1, 1)
    ]
    tail = box(0.012, 0.006, 0.005, "#8fbf5a").at(-a / 2 + 0.006, 0, -c * 0.4)
    spots = [
        disc(0.006, "#2a6637").along((0, 0, 1)).at(-a * 0.06 + x, y, c * z)
        for x, y, z in ((0, 0, 0.5),)
    ]
    return [shell_, belly, head, *legs, *eyes, tail, *spots]


@item("stuffed animal", "toys", "fabric", shown="standing")
def stuffed_animal(a: float, b: float, c: float) -> list[Piece]:
    """Sitting teddy bear, 11.5 cm high and wide, 9 cm deep; +x up, +z ahead."""
    fur, light = "#9a6a3c", "#d3ae7c"
    body = egg(a * 0.52, b * 0.56, c * 0.69, fur).at(-a * 0.2, 0, -c * 0.155)
    head = ball(0.028, fur).at(a / 2 - 0.034, 0, 0)
    ears = [ball(0.011, fur).at(a / 2 - 0.011, s * 0.023, 0) for s in (-1, 1)]
    arms = [egg(0.026, 0.036, 0.03, fur).at(-a * 0.1, s * (b / 2 - 0.018), 0.008) for s in (-1, 1)]
    legs = [
        egg(0.032, 0.036, 0.05, fur).at(-a / 2 + 0.016, s * (b / 2 - 0.025), c / 2 - 0.025)
        for s in (-1, 1)
    ]
    snout = egg(0.018, 0.022, 0.012, light).seen_only().at(a / 2 - 0.04, 0, 0.0245)
    face = [
        ball(0.003, BLACK).seen_only().at(a / 2 - 0.04, 0, 0.03),
        *(ball(0.003, BLACK).seen_only().at(a / 2 - 0.024, s * 0.01, 0.0235) for s in (-1, 1)),
    ]
    soles = [
        disc(0.011, light).along((0, 0, 1)).at(-a / 2 + 0.016, s * (b / 2 - 0.025), c / 2 - 0.0004)
        for s in (-1, 1)
    ]
    return [body, head, *ears, *arms, *legs, snout, *face, *soles]


@item("toy car", "toys", "metal")
def toy_car(a: float, b: float, c: float) -> list[Piece]:
    wheel_r = c * 0.22
    body = convex(
        [
            (x, s * y, z)
            for s in (-1, 1)
            for x, y, z in (
                (-a / 2, b * 0.46, -c * 0.3),
                (-a / 2, b * 0.46, 0.0),
                (a / 2, b * 0.46, -c * 0.3),
                (a / 2, b * 0.44, -c * 0.1),
                (a * 0.2, b * 0.46, 0.001),
            )
        ],
        RED,
    )
    cabin = convex(
        [
            (x, s * y, z)
            for s in (-1, 1)
            for x, y, z in (
                (-a * 0.34, b * 0.43, -0.001),
                (a * 0.16, b * 0.43, -0.001),
                (-a * 0.26, b * 0.36, c / 2),
                (a * 0.02, b * 0.36, c / 2),
            )
        ],
        "#9cc7e0",
    )
    roof = box(a * 0.27, b * 0.7, 6e-4, RED).seen_only().at(-a * 0.12, 0, c / 2)
    axles = [
        rod(wheel_r, b, BLACK).along((0, 1, 0)).at(x, 0, -c / 2 + wheel_r)
        for x in (-a * 0.3, a * 0.3)
    ]
    hubs = [
        disc(wheel_r * 0.55, STEEL).along((0, s, 0)).at(x, s * b / 2, -c / 2 + wheel_r)
        for x in (-a * 0.3, a * 0.3)
        for s in (-1, 1)
    ]
    lamps = [disc(0.003, YELLOW).at(a / 2, s * b * 0.3, -c * 0.2) for s in (-1, 1)]
    return [body, cabin, roof, *axles, *hubs, *lamps]


@item("ball", "toys", "rubber")
def tennis_ball(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    seams = [
        ring(r * 0.62, r * 0.56, 0.002, WHITE)
        .along(axis)
        .at(*(k * r * 0.802 for k in axis))
        .seen_only()
        for axis in ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
    ]
    return [ball(r, "#cfe04a"), *seams]


@item("small ball", "toys", "rubber")
def small_ball(a: float, b: float, c: float) -> list[Piece]:
    return [ball(a / 2, RED), band(a / 2 - 2e-4, 0.004, WHITE)]


@item("placemat", "kitchen", "fabric", length=0.28, width=0.2)
def placemat(a: float, b: float, c: float) -> list[Piece]:
    stripes = [patch(0.006, b, "#e3d7b4").at(x, 0, c / 2) for x in (-0.12, -0.1, 0.1, 0.12)]
    return [box(a, b, c, "#5d7c8c"), *stripes, patch(a * 0.5, b * 0.7, "#6f8f9f").at(0, 0, c / 2)]


@item("scale", "kitchen", "plastic", length=0.22, width=0.16)
def kitchen_scale(a: float, b: float, c: float) -> list[Piece]:
    """Flat kitchen scale with a steel plate and a display."""
    low = c * 0.72
    body = slab(rounded(a, b, 0.012), low, "#e4e6e8").at(0, 0, (low - c) / 2)
    plate = slab(rounded(a * 0.62, b * 0.86, 0.012), c - low, STEEL).at(a * 0.15, 0, low / 2)
    screen = patch(a * 0.1, b * 0.5, "#9fb38f").at(-a * 0.36, 0, low - c / 2)
    return [
        body,
        plate,
        screen,
        *(
            p.at(-a * 0.36, s * b * 0.36, low - c / 2)
            for s in (-1, 1)
            for p in dots([(0, 0)], 0.006, RED)
        ),
    ]
