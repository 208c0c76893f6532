"""What stands on a kitchen table: cups, plates, pots and cutlery."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    GREY,
    RED,
    STEEL,
    WHITE,
    WOOD,
    band,
    disc,
    dots,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    bent,
    box,
    convex,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item

COFFEE, GLASS = "#4a2c18", "#bcd9df"


@item("mug", "kitchen", "ceramic")
def mug(a: float, b: float, c: float) -> list[Piece]:
    r, thick, blue = 0.042, c / 2, "#3f7fb5"
    body = turned([(-0.055, r * 0.94), (-0.052, r), (0.055, r)], blue, hollow=(0.0018, r - 0.004))
    out, high = r + 0.028, a / 2 - thick
    grip = bent([(-high, out, 0), (high, out, 0)], thick, blue).held()
    arms = [bent([(s * high, r - 0.006, 0), (s * high, out, 0)], thick, blue) for s in (-1, 1)]
    return [body, disc(r - 0.005, COFFEE).at(0.0536), grip, *arms]


@item("cup", "kitchen", "plastic")
def cup(a: float, b: float, c: float) -> list[Piece]:
    r, rim = b / 2, a - 0.03
    body = turned([(0, r * 0.7), (rim - 0.006, r * 0.96)], "#e23b3b")
    lid = turned([(0, r), (0.006, r), (0.007, r * 0.9), (0.012, r * 0.86)], WHITE).at(rim - 0.006)
    straw = rod(0.003, 0.026, "#3a7bd0").at(a - 0.013, 0.008)
    stripe = turned([(rim * 0.35, r * 0.797), (rim * 0.55, r * 0.851)], WHITE).seen_only()
    return [body, lid, straw, stripe]


@item("paper cup", "kitchen", "paper")
def paper_cup(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned([(0, r * 0.68), (a - 0.014, r * 0.94)], WHITE)
    sleeve = turned([(a * 0.22, r * 0.76), (a * 0.62, r * 0.87)], "#a9794a").seen_only()
    lid = turned(
        [(0, r), (0.005, r), (0.006, r * 0.9), (0.014, r * 0.84)],
        "#2e2a28",
        hollow=(0.001, r * 0.7),
    )
    return [body, sleeve, lid.at(a - 0.014)]


@item("plastic cup", "kitchen", "plastic")
def plastic_cup(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [(0, r * 0.68), (a * 0.3, r * 0.76), (a * 0.31, r * 0.79), (a - 0.006, r * 0.96)], RED
    )
    rim = turned([(0, r), (0.006, r)], RED, hollow=(0.0015, r * 0.93)).at(a - 0.006)
    return [body, rim, disc(r * 0.86, WHITE).at(a - 0.0013)]


@item("coffee pot", "kitchen", "glass")
def coffee_pot(a: float, b: float, c: float) -> list[Piece]:
    r = 0.06
    jug = turned([(0, r * 0.8), (0.012, r), (0.05, r), (0.09, r * 0.84), (0.115, r * 0.66)], COFFEE)
    glass = turned([(0.115, r * 0.66), (0.135, r * 0.62)], GLASS)
    lid = turned([(0.135, r * 0.66), (0.147, r * 0.6), (0.152, r * 0.25)], BLACK)
    spout = slab([(0.11, -r * 0.5), (0.135, -r * 0.5), (0.137, -r * 0.86)], 0.03, GLASS)
    grip = box(a, b, c, BLACK, 0.003).at(0.08, r + 0.03).held()
    arms = [
        box(0.014, 0.05, c * 0.8, BLACK).at(0.13, r + 0.002),
        box(0.014, 0.03, c * 0.8, BLACK).at(0.03, r + 0.012),
    ]
    return [jug, glass, lid, spout, grip, *arms]


@item("tea kettle", "kitchen", "metal")
def tea_kettle(a: float, b: float, c: float) -> list[Piece]:
    r = 0.085
    body = turned(
        [(0, r * 0.95), (0.01, r), (0.045, r * 0.95), (0.08, r * 0.66), (0.09, r * 0.45)], "#b5332c"
    )
    lid = turned([(0.088, r * 0.42), (0.098, r * 0.36), (0.1, 0.012), (0.116, 0.012)], BLACK)
    spout = turned([(0, 0.02), (0.07, 0.011)], "#b5332c").along((0.75, 1, 0)).at(0.045, r * 0.72)
    grip = box(a, b, c, BLACK, 0.003).along((0, 1, 0)).at(0.165).held()
    posts = [
        bent([(0.055, s * r * 0.8, 0), (0.163, s * a * 0.44, 0)], 0.006, STEEL) for s in (-1, 1)
    ]
    return [body, lid, spout, grip, *posts]


@item("measuring cup", "kitchen", "plastic")
def measuring_cup(a: float, b: float, c: float) -> list[Piece]:
    r = 0.042
    body = turned([(0, r * 0.8), (0.062, r)], "#d8ecf2", hollow=(0.0018, r * 0.92))
    grip = box(b, a, c, RED, 0.003).at(0.045, r + a / 2 - 0.004).held()
    marks = [
        turned(
            [
                (x, r * (0.8 + 0.2 * x / 0.062) + 0.0003),
                (x + 0.0015, r * (0.8 + 0.2 * (x + 0.0015) / 0.062) + 0.0003),
            ],
            RED,
        ).seen_only()
        for x in (0.015, 0.03, 0.045)
    ]
    return [body, grip, *marks]


@item("salt shaker", "kitchen", "glass")
def salt_shaker(a: float, b: float, c: float) -> list[Piece]:
    r, top = b / 2, a - 0.035
    body = turned([(0, r), (top * 0.5, r * 0.78), (top, r * 0.82)], "#e8f0f0", sides=8)
    base = turned([(0, r), (0.006, r)], "#cfdcdc")
    lid = turned([(0, r * 0.92), (0.018, r * 0.92), (0.028, r * 0.75), (0.035, r * 0.4)], STEEL)
    holes = [
        disc(0.0016, BLACK).at(a - 0.0001, y, z)
        for y, z in ((0, 0), (0.005, 0), (-0.005, 0), (0, 0.005), (0, -0.005))
    ]
    return [base, body, lid.at(top), *holes]


@item("knife holder", "kitchen", "wood")
def knife_holder(a: float, b: float, c: float) -> list[Piece]:
    block = box(a - 0.045, b, c, WOOD).at(-0.0225)
    slots = [
        box(0.0006, 0.014, 0.003, BLACK).seen_only().at(a / 2 - 0.045, y)
        for y in (-0.026, 0, 0.026)
    ]
    grips = [
        box(0.047, 0.015, 0.012, BLACK, 0.002).at(a / 2 - 0.0235, y) for y in (-0.026, 0, 0.026)
    ]
    return [block, *slots, *grips]


@item("knife rack", "kitchen", "wood")
def knife_rack(a: float, b: float, c: float) -> list[Piece]:
    block = convex(
        [
            (x, s * b / 2, z)
            for s in (-1, 1)
            for x, z in ((-a / 2, -c / 2), (-a / 2, c / 2), (0.03, c / 2), (0.005, -c / 2))
        ],
        "#8a5a33",
    )
    grips = [
        box(0.065, 0.018, 0.014, BLACK, 0.002).at(a / 2 - 0.0325, y, 0.018)
        for y in (-0.042, -0.014, 0.014, 0.042)
    ]
    rivets = [
        patch_.at(a / 2 - x, y, 0.0252)
        for x in (0.015, 0.032)
        for y in (-0.042, -0.014, 0.014, 0.042)
        for patch_ in dots([(0, 0)], 0.0018, STEEL)
    ]
    return [block, *grips, *rivets]


def jar(a: float, r: float, filling: str, lid: str) -> list[Piece]:
    """Preserving jar filled to the shoulder, standing on x = 0."""
    body = turned(
        [(0, r * 0.92), (0.005, r), (a * 0.72, r), (a * 0.8, r * 0.86), (a * 0.84, r * 0.84)], GLASS
    )
    content = band(r, a * 0.55, filling).at(a * 0.34)
    top = turned([(a * 0.84, r * 0.93), (a * 0.98, r * 0.93), (a, r * 0.88)], lid)
    return [body, content, top]


@item("glass jar", "kitchen", "glass")
def glass_jar(a: float, b: float, c: float) -> list[Piece]:
    return [*jar(a, b / 2, "#a3263a", "#d8c15a"), band(b / 2 + 0.0002, a * 0.2, WHITE).at(a * 0.36)]


@item("glass container", "kitchen", "glass")
def glass_container(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned([(0, r * 0.97), (0.004, r), (a * 0.86, r)], GLASS)
    wood = turned([(a * 0.86, r * 0.97), (a * 0.94, r * 0.97)], WOOD)
    knob = turned([(a * 0.94, 0.009), (a * 0.97, 0.012), (a, 0.01)], WOOD)
    return [body, band(r, a * 0.5, "#e2cf9b").at(a * 0.27), wood, knob]


@item("metal can", "kitchen", "metal")
def metal_can(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = rod(r * 0.985, a, STEEL)
    rims = [band(r - 0.0003, 0.004, STEEL).at(s * (a / 2 - 0.002)) for s in (-1, 1)]
    label = [
        band(r * 0.985, a * 0.8, "#2f7d4f"),
        band(r * 0.985 + 0.0002, a * 0.22, WHITE).at(a * 0.1),
    ]
    return [
        body,
        *rims,
        *label,
        disc(r * 0.86, GREY).at(a / 2),
        disc(r * 0.8, STEEL).at(a / 2 + 0.0002),
    ]
