"""Hand tools without a motor."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    DARK_STEEL,
    RED,
    STEEL,
    WHITE,
    WOOD,
    band,
    disc,
    patch,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    arc,
    box,
    convex,
    ring,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


@item("screwdriver", "tools", "plastic", length=0.21)
def screwdriver(a: float, b: float, c: float) -> list[Piece]:
    r, grip = b / 2, 0.1
    handle = turned(
        [
            (0, r * 0.7),
            (0.004, r * 0.92),
            (0.012, r),
            (0.06, r * 0.95),
            (0.075, r * 0.72),
            (0.085, r * 0.72),
            (0.095, r * 0.85),
            (grip, r * 0.6),
        ],
        RED,
    )
    shaft = rod(r * 0.2, a - grip - 0.014, STEEL).at((a - 0.014 + grip) / 2)
    blade = convex(
        [
            (x, y, z)
            for x, y, z in (
                (a - 0.014, 0.0035, 0.003),
                (a - 0.014, -0.0035, 0.003),
                (a - 0.014, 0.0035, -0.003),
                (a - 0.014, -0.0035, -0.003),
                (a, 0.004, 0.0006),
                (a, -0.004, 0.0006),
                (a, 0.004, -0.0006),
                (a, -0.004, -0.0006),
            )
        ],
        DARK_STEEL,
    )
    return [handle, shaft, blade, band(r, 0.012, BLACK).at(0.02)]


@item("hammer", "tools", "wood", length=0.3)
def hammer(a: float, b: float, c: float) -> list[Piece]:
    handle = box(a, b, c, WOOD, 0.003).held()
    x = a / 2 - 0.016
    head = box(0.026, 0.046, 0.026, "#4b5057", 0.002).at(x)
    face = turned([(0, 0.0105), (0.014, 0.0105), (0.016, 0.0145), (0.032, 0.0145)], STEEL).along(
        (0, 1, 0)
    )
    claws = [
        convex(
            [
                (px, -py, z + dz)
                for px, py, dz in (
                    (0.012, 0.0, 0.0),
                    (-0.012, 0.0, 0.0),
                    (0.012, 0.0, s * 0.01),
                    (-0.012, 0.0, s * 0.01),
                    (0.007, 0.022, s * 0.002),
                    (-0.009, 0.024, s * 0.002),
                    (0.007, 0.022, s * 0.011),
                    (-0.009, 0.024, s * 0.011),
                    (-0.016, 0.042, s * 0.005),
                    (-0.013, 0.043, s * 0.011),
                )
            ],
            STEEL,
        ).at(x, -0.02)
        for s, z in ((1, 0.002), (-1, -0.002))
    ]
    return [handle, head, face.at(x, 0.02), *claws]


@item("mallet", "tools", "rubber", length=0.3)
def mallet(a: float, b: float, c: float) -> list[Piece]:
    handle = turned(
        [(-a / 2, b / 2), (-0.02, b / 2 * 0.8), (a / 2, b / 2 * 0.8)], WOOD, c / b
    ).held()
    head = turned([(-0.055, 0.028), (-0.05, 0.03), (0.05, 0.03), (0.055, 0.028)], "#2d2f33")
    return [handle, head.along((0, 1, 0)).at(a / 2 - 0.034)]


@item("pliers", "tools", "metal")
def pliers(a: float, b: float, c: float) -> list[Piece]:
    pieces = [rod(0.008, c * 1.0, DARK_STEEL).along((0, 0, 1)).at(a * 0.2)]
    for s in (-1, 1):
        jaw = slab(
            [
                (a * 0.14, s * 0.001),
                (a * 0.14, s * 0.011),
                (a * 0.3, s * 0.009),
                (a / 2, s * 0.0035),
                (a / 2, s * 0.0008),
            ],
            c,
            STEEL,
        )
        neck = slab(
            [
                (a * 0.22, -s * 0.006),
                (a * 0.2, s * 0.008),
                (a * 0.02, s * 0.0175),
                (a * 0.04, s * 0.0065),
            ],
            c,
            STEEL,
        )
        grip = slab(
            [
                (a * 0.06, s * 0.008),
                (a * 0.04, s * 0.018),
                (-a * 0.24, s * b / 2),
                (-a / 2, s * b * 0.46),
                (-a / 2, s * b * 0.32),
                (-a * 0.2, s * b * 0.29),
            ],
            c,
            RED,
        )
        pieces += [jaw, neck, grip]
    return pieces


@item("saw", "tools", "wood")
def saw(a: float, b: float, c: float) -> list[Piece]:
    """Back saw; people hold the block of its handle, 10 x 4 x 2.5 cm."""
    grip = convex(
        [
            (x, y, z)
            for x, y in (
                (-0.05, -b / 2),
                (-0.042, b / 2),
                (0.05, b / 2),
                (0.05, -b * 0.1),
                (0.02, -b / 2),
            )
            for z in (-c / 2, c / 2)
        ],
        WOOD,
    ).held()
    blade = slab([(0.04, 0.018), (0.04, -0.045), (0.33, -0.025), (0.33, 0.018)], 0.003, STEEL)
    back = box(0.28, 0.008, 0.008, "#8f7433").at(0.19, 0.018)
    teeth = [
        slab([(x, 0.0), (x + 0.012, 0.0), (x + 0.006, -0.0018)], 0.0028, DARK_STEEL)
        .seen_only()
        .at(0, -0.045 + 0.02 * (x + 0.004 - 0.04) / 0.29)
        for x in (0.041 + 0.012 * i for i in range(24))
    ]
    bolts = [disc(0.004, "#c9a24a").turn((0, 1, 0), -90).at(x, 0.004, c / 2) for x in (-0.02, 0.02)]
    return [grip, blade, back, *teeth, *bolts]


@item("metal clamp", "tools", "metal")
def metal_clamp(a: float, b: float, c: float) -> list[Piece]:
    """Screw clamp: a C of 3 cm depth, its screw along the C with a 3 cm tommy bar."""
    spine = box(a * 0.66, 0.008, 0.009, "#3d6f9c").at(-a * 0.17, -b / 2 + 0.004)
    arms = [box(0.008, b, 0.009, "#3d6f9c").at(x) for x in (-a / 2 + 0.004, a * 0.16 - 0.004)]
    screw = rod(0.0035, a * 0.62, STEEL).at(a * 0.19, 0.009)
    foot = rod(0.006, 0.005, DARK_STEEL).at(-a * 0.12, 0.009)
    bar = rod(0.0025, c, STEEL).along((0, 0, 1)).at(a / 2 - 0.006, 0.009)
    return [spine, *arms, screw, foot, bar]


@item("swiss army knife", "tools", "plastic")
def swiss_army_knife(a: float, b: float, c: float) -> list[Piece]:
    scales = [slab(_stadium(a, b), c * 0.28, "#b8232a").at(0, 0, s * c * 0.36) for s in (-1, 1)]
    core = slab(_stadium(a * 0.97, b * 0.92), c * 0.44, STEEL)
    lines = [
        slab(_stadium(a * 0.975, b * 0.93), 0.0006, DARK_STEEL).seen_only().at(0, 0, z)
        for z in (-0.0025, 0, 0.0025)
    ]
    cross = [
        patch(0.008, 0.0025, WHITE).at(0.008, 0, c / 2),
        patch(0.0025, 0.008, WHITE).at(0.008, 0, c / 2),
    ]
    return [*scales, core, *lines, *cross]


def _stadium(x: float, y: float) -> list[tuple[float, float]]:
    r = y / 2
    return [
        (px + (x / 2 - r if px > 0 else r - x / 2), py)
        for px, py in (
            (0.0001, -r),
            *((p[0], p[1]) for p in arc(r, -80, 80, 6)),
            (0.0001, r),
            (-0.0001, r),
            *((p[0], p[1]) for p in arc(r, 100, 260, 6)),
            (-0.0001, -r),
        )
    ]


@item("tweezer", "tools", "metal")
def tweezer(a: float, b: float, c: float) -> list[Piece]:
    gap = [(-a * 0.4, 0), (0, b * 0.27), (a / 2, 0.0002), (0, -b * 0.27)]
    legs = [
        convex(
            [
                (x, s * y, z)
                for x, y, h in (
                    (-a / 2, 0.0, 0.5),
                    (-a / 2, 0.0012, 0.5),
                    (0, b * 0.27, 0.5),
                    (0, b / 2, 0.5),
                    (a / 2, 0.0002, 0.14),
                    (a / 2, 0.0012, 0.14),
                )
                for z in (-c * h, c * h)
            ],
            colour,
        )
        for s, colour in ((-1, DARK_STEEL), (1, STEEL))
    ]
    return [*legs, slab(gap, c * 0.1, BLACK).seen_only()]


@item("round handle", "tools", "metal")
def round_handle(a: float, b: float, c: float) -> list[Piece]:
    """Handwheel with four spokes."""
    rim = ring(a / 2, a / 2 - 0.014, c * 0.8, "#b3352c", 10)
    hub = rod(0.016, c, DARK_STEEL)
    spokes = [box(c * 0.5, a - 0.02, 0.01, "#b3352c").turn((1, 0, 0), angle) for angle in (45, 135)]
    return [rim, hub, *spokes, disc(0.006, STEEL).at(c / 2)]
