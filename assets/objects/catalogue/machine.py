"""Parts, blanks, handles and knobs of a machine shop."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BRASS,
    DARK_STEEL,
    GREY,
    STEEL,
    WOOD,
    band,
    disc,
    dots,
    patch,
    rounded,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    ring,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item

SHOP = "machine shop"
ALUMINIUM = "#cfd3d8"


def holes(points: list[tuple[float, float]], radius: float, z: float) -> list[Piece]:
    """Drawn bores in the +z and -z faces of a plate whose faces are at +-z."""
    return [p.at(0, 0, s * z) for p in dots(points, radius, BLACK) for s in (-1, 1)]


@item("aluminum bar", SHOP, "metal")
def aluminum_bar(a: float, b: float, c: float) -> list[Piece]:
    saw_cut = box(2e-4, b * 0.9, c * 0.9, GREY).seen_only()
    return [
        box(a, b, c, ALUMINIUM, 0.001),
        saw_cut.at(a / 2),
        saw_cut.at(-a / 2),
        *(
            patch(0.0006, b * 0.96, "#b4b9c0").at(x, 0, c / 2)
            for x in (-0.04, -0.02, 0, 0.02, 0.04)
        ),
    ]


@item("metal rectangle", SHOP, "metal")
def metal_rectangle(a: float, b: float, c: float) -> list[Piece]:
    corners = [(s * a * 0.42, t * b * 0.38) for s in (-1, 1) for t in (-1, 1)]
    return [box(a, b, c, STEEL, 0.0008), *holes(corners, 0.004, c / 2)]


@item("metal slab", SHOP, "metal", length=0.17)
def metal_slab(a: float, b: float, c: float) -> list[Piece]:
    lines = [
        patch(a * 0.98, 0.0008, "#565b62").at(0, y, c / 2) for y in (-0.06, -0.03, 0, 0.03, 0.06)
    ]
    return [box(a, b, c, DARK_STEEL, 0.001), *lines]


@item("plexiglas rectangle", SHOP, "plastic")
def plexiglas_rectangle(a: float, b: float, c: float) -> list[Piece]:
    film = patch(a * 0.6, b * 0.98, "#7fb4d8").at(-a * 0.19, 0, c / 2)
    return [box(a, b, c, "#bfe3ee"), film]


@item("rectangular block", SHOP, "metal")
def rectangular_block(a: float, b: float, c: float) -> list[Piece]:
    return [
        box(a, b, c, "#a9b4a0", 0.001),
        *holes([(-a * 0.3, 0), (a * 0.3, 0)], 0.004, c / 2),
        patch(a * 0.2, b * 0.4, "#7d8876").at(0, 0, c / 2),
    ]


@item("wooden block", SHOP, "wood")
def wooden_block(a: float, b: float, c: float) -> list[Piece]:
    grain = [
        patch(a * 0.97, 0.0012, "#9c7242").at(0, y, s * c / 2)
        for s in (-1, 1)
        for y in (-0.06, -0.043, -0.02, 0.004, 0.022, 0.05, 0.063)
    ]
    return [box(a, b, c, WOOD, 0.001), *grain]


@item("disk", SHOP, "metal")
def metal_disk(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    return [
        turned([(-c / 2, r), (c / 2, r)], STEEL, hollow=(0.0004, r * 0.86)),
        disc(r * 0.2, BLACK).at(c / 2 - 0.0003),
    ]


@item("washer", SHOP, "metal")
def washer(a: float, b: float, c: float) -> list[Piece]:
    return [ring(a / 2, a * 0.24, c, STEEL)]


@item("screw", SHOP, "metal")
def screw(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    head = turned([(a / 2 - 0.004, r), (a / 2 - 0.0008, r), (a / 2, r * 0.86)], DARK_STEEL)
    shaft = turned([(-a / 2, r * 0.35), (-a / 2 + 0.001, r * 0.5), (a / 2 - 0.004, r * 0.5)], STEEL)
    threads = [band(r * 0.5, 0.0004, "#5c626a").at(-a / 2 + 0.002 + 0.0011 * i) for i in range(8)]
    slot = box(4e-4, b * 0.8, 0.0012, BLACK).seen_only().at(a / 2)
    return [head, shaft, *threads, slot]


@item("metal cylinder", SHOP, "metal")
def metal_cylinder(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned(
            [(-a / 2, r * 0.96), (-a / 2 + 0.001, r), (a / 2 - 0.001, r), (a / 2, r * 0.96)], STEEL
        ),
        *(band(r, 0.0006, "#9096a0").at(x) for x in (-0.02, -0.01, 0, 0.01, 0.02)),
    ]


@item("cylindrical part on machine", SHOP, "metal")
def cylindrical_part_on_machine(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [
            (-a / 2, r),
            (-a * 0.3, r),
            (-a * 0.3, r * 0.8),
            (a * 0.3, r * 0.8),
            (a * 0.3, r * 0.55),
            (a / 2, r * 0.55),
        ],
        "#6f8296",
    )
    return [
        body,
        disc(r * 0.3, BLACK).at(a / 2),
        *(
            disc(0.003, BLACK).at(-a * 0.3 + 1e-4, y, z)
            for y, z in ((r * 0.9, 0), (-r * 0.9, 0), (0, r * 0.9), (0, -r * 0.9))
        ),
    ]


@item("part on machine", SHOP, "metal")
def part_on_machine(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [
            (-a / 2, r),
            (-a * 0.25, r),
            (-a * 0.25, r * 0.7),
            (a * 0.2, r * 0.7),
            (a * 0.2, r * 0.9),
            (a / 2, r * 0.9),
        ],
        "#51708a",
    )
    return [
        body,
        disc(r * 0.5, BLACK).at(a / 2),
        *(band(r * 0.7, 0.004, "#3c5468").at(x) for x in (-0.02, -0.008, 0.004, 0.016)),
    ]


@item("mill part", SHOP, "metal")
def mill_part(a: float, b: float, c: float) -> list[Piece]:
    """Face mill: arbor with a cutter head and inserts."""
    r = b / 2
    arbor = turned(
        [(-a / 2, r * 0.4), (a * 0.05, r * 0.55), (a * 0.08, r * 0.9), (a * 0.2, r * 0.9)], STEEL
    )
    head = turned([(a * 0.2, r * 0.8), (a * 0.28, r), (a / 2, r)], DARK_STEEL)
    inserts = [
        box(0.012, 0.01, 0.002, BRASS).seen_only().turn((1, 0, 0), t).at(a / 2 - 0.006, 0, 0)
        for t in (0, 60, 120)
    ]
    teeth = [
        box(0.012, 2 * r - 0.002, 0.008, BRASS).seen_only().turn((1, 0, 0), t).at(a / 2 - 0.0055)
        for t in (0, 60, 120)
    ]
    return [arbor, head, *inserts, *teeth]


@item("medium part", SHOP, "metal")
def medium_part(a: float, b: float, c: float) -> list[Piece]:
    """Flange with a hub."""
    r = a / 2
    flange = turned(
        [(-c / 2, r), (-c * 0.08, r), (-c * 0.08, r * 0.6), (c / 2, r * 0.6)], "#8d99a6"
    )
    return [
        flange,
        disc(r * 0.36, BLACK).at(c / 2),
        *(
            disc(0.004, BLACK).at(-c * 0.08 + 1e-4, y, z)
            for y, z in ((r * 0.8, 0), (-r * 0.8, 0), (0, r * 0.8), (0, -r * 0.8))
        ),
    ]


@item("medium drum-like part", SHOP, "metal")
def medium_drum_like_part(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    return [
        turned([(-c / 2, r), (c / 2, r)], "#7b8a6a", hollow=(0.0018, r * 0.8)),
        *(band(r, 0.006, "#5a6650").at(s * c * 0.3) for s in (-1, 1)),
        disc(r * 0.15, BLACK).at(c / 2 - 0.0016),
    ]


@item("small drum-like part", SHOP, "metal")
def small_drum_like_part(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned([(-a / 2, r), (a / 2, r)], "#a06a4a", hollow=(0.0018, r * 0.8)),
        *(band(r, 0.005, "#744a32").at(x) for x in (-a * 0.32, 0, a * 0.32)),
        disc(r * 0.2, BLACK).at(a / 2 - 0.0016),
    ]


@item("machine shield", SHOP, "plastic", length=0.22)
def machine_shield(a: float, b: float, c: float) -> list[Piece]:
    """Clear guard with a metal edge that carries its hinge."""
    return [
        box(a * 0.9, b, c * 0.7, "#bcd9df").at(a * 0.05),
        box(a * 0.1, b, c, DARK_STEEL).at(-a * 0.45),
        *(patch(0.008, 0.02, BLACK).at(-a * 0.45, s * b * 0.3, c / 2) for s in (-1, 1)),
    ]


@item("plastic machine cover", SHOP, "plastic", length=0.24)
def plastic_machine_cover(a: float, b: float, c: float) -> list[Piece]:
    louvres = [
        patch(0.005, b * 0.5, BLACK).at(x, 0, c / 2) for x in (-0.05, -0.035, -0.02, -0.005, 0.01)
    ]
    screws = holes([(s * a * 0.46, t * b * 0.45) for s in (-1, 1) for t in (-1, 1)], 0.003, c / 2)
    return [slab(rounded(a, b, 0.012), c, "#d9d4c3"), *louvres, *screws]


@item("plastic shield", SHOP, "plastic", length=0.22)
def plastic_shield(a: float, b: float, c: float) -> list[Piece]:
    return [
        slab(rounded(a, b, 0.03), c, "#a8d3e6"),
        box(a * 0.5, 0.012, 0.0006, "#f28c28").seen_only().at(0, -b * 0.42, c / 2),
        patch(a * 0.7, 0.004, "#d6eef7").at(0, b * 0.2, c / 2),
    ]


@item("shield", SHOP, "metal", length=0.2)
def shield(a: float, b: float, c: float) -> list[Piece]:
    """Sheet guard with warning stripes."""
    stripes = [
        slab(
            [(x, -b * 0.4), (x + 0.012, -b * 0.4), (x + 0.03, -b * 0.26), (x + 0.018, -b * 0.26)],
            0.0006,
            BLACK,
        )
        .seen_only()
        .at(0, 0, c / 2)
        for x in (-0.09, -0.06, -0.03, 0, 0.03, 0.06)
    ]
    return [
        box(a, b, c, "#e8c52e", 0.001),
        *stripes,
        *holes([(s * a * 0.45, b * 0.42) for s in (-1, 1)], 0.004, c / 2),
    ]
