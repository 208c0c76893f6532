"""Plates, bowls, trays and cutlery."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    DARK_STEEL,
    RED,
    STEEL,
    WHITE,
    disc,
    ellipse,
    open_box,
    rounded,
    shell,
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


@item("plate", "kitchen", "ceramic", length=0.2, width=0.2)
def plate(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    body = turned(
        [(-c / 2, r * 0.62), (-c / 4, r * 0.75), (c / 2, r)], "#f4f3ee", hollow=(0.001, r * 0.72)
    )
    rim = ring(r * 0.96, r * 0.9, 0.0003, BLUE).at(c / 2).seen_only()
    return [body, rim]


@item("dish", "kitchen", "ceramic")
def dish(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    body = turned([(-c / 2, r * 0.72), (c / 2, r)], WHITE, hollow=(0.0008, r * 0.86))
    rims = [("#3b6ea5", 0.8), (WHITE, 0.74), ("#8fb3d9", 0.5), (WHITE, 0.46)]
    discs = [
        disc(r * share, colour).at(c / 2 - 0.0007 + 1e-4 * i)
        for i, (colour, share) in enumerate(rims)
    ]
    return [body, *discs]


@item("bowl", "kitchen", "ceramic")
def bowl(a: float, b: float, c: float) -> list[Piece]:
    r, wall = a / 2, 0.009
    body = shell([(0, r * 0.6), (0.055, r)], wall, "#e9e4d8")
    rim = ring(r, r - wall, c, "#3b6ea5").at(0.055 - c / 2 + 0.0002).seen_only().held()
    return [body, rim]


@item("eating utensil", "kitchen", "metal")
def eating_utensil(a: float, b: float, c: float) -> list[Piece]:
    grip = convex(
        [
            (x, s * y, t * c / 2)
            for x, y in ((0, b / 2), (a * 0.55, b / 3), (a, b / 4))
            for s in (-1, 1)
            for t in (-1, 1)
        ],
        STEEL,
    ).held()
    bowl_ = convex([(x, y, z) for x, y in ellipse(0.055, 0.036) for z in (-0.0028, 0.0028)], STEEL)
    hollow = convex([(x, y, z) for x, y in ellipse(0.044, 0.026) for z in (0, 0.0004)], DARK_STEEL)
    return [grip, bowl_.at(a + 0.024), hollow.seen_only().at(a + 0.024, 0, 0.0028)]


@item("cooking spoon dish", "kitchen", "ceramic")
def cooking_spoon_dish(a: float, b: float, c: float) -> list[Piece]:
    big = slab(ellipse(a * 0.56, b), c, "#e0703c").at(a * 0.22)
    grip = slab([(-a / 2, 0.005), (-a / 2, -0.005), (0, -0.007), (0, 0.007)], c * 0.8, "#e0703c")
    hollow = slab(ellipse(a * 0.47, b * 0.76), 0.0006, "#f0b58f").seen_only().at(a * 0.22, 0, c / 2)
    groove = box(a * 0.42, 0.006, 0.0006, "#f0b58f").seen_only().at(-a * 0.26, 0, c * 0.4)
    return [big, grip.at(z=-c * 0.1), hollow, groove.at(z=-c * 0.1)]


@item("coaster", "kitchen", "wood")
def coaster(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    body = turned(
        [(-c / 2, r * 0.98), (-c / 4, r), (c / 4, r), (c / 2, r * 0.98)],
        "#c69c6d",
        hollow=(0.0005, r * 0.85),
    )
    return [
        body,
        disc(r * 0.5, "#8c5f37").at(c / 2 - 0.0005),
        disc(r * 0.4, "#c69c6d").at(c / 2 - 0.0003),
    ]


@item("tongs", "kitchen", "metal")
def tongs(a: float, b: float, c: float) -> list[Piece]:
    pieces = [box(0.012, 0.011, c, RED).at(-a / 2 + 0.006)]
    for s in (-1, 1):
        pieces.append(
            convex(
                [
                    (x, s * y, z)
                    for x, y, z in (
                        (-a / 2 + 0.004, 0.001, c / 2),
                        (-a / 2 + 0.004, 0.0045, c / 2),
                        (-a / 2 + 0.004, 0.001, -c / 2),
                        (-a / 2 + 0.004, 0.0045, -c / 2),
                        (a / 2 - 0.025, 0.0065, c * 0.35),
                        (a / 2 - 0.025, 0.01, c * 0.35),
                        (a / 2 - 0.025, 0.0065, -c * 0.35),
                        (a / 2 - 0.025, 0.01, -c * 0.35),
                    )
                ],
                STEEL,
            )
        )
        pieces.append(
            convex(
                [
                    (x, s * y, z)
                    for z in (-c / 2, c / 2)
                    for x, y in (
                        (a / 2 - 0.026, 0.0062),
                        (a / 2 - 0.026, b / 2),
                        (a / 2, 0.007),
                        (a / 2, 0.0035),
                    )
                ],
                STEEL,
            )
        )
    return pieces


@item("tray", "kitchen", "plastic", length=0.26, width=0.18)
def tray(a: float, b: float, c: float) -> list[Piece]:
    slots = [
        box(0.012, 0.06, 0.0003, BLACK)
        .seen_only()
        .at(s * (a / 2 - 0.014), 0, 0.0001 - c / 2 + 0.005)
        for s in (-1, 1)
    ]
    centre = box(a * 0.6, b * 0.6, 0.0003, "#b07a4c").seen_only().at(0, 0, 0.0001 - c / 2 + 0.005)
    return [*open_box(a, b, c, 0.005, "#8c5a34"), *slots, centre]


@item("small tray", "kitchen", "plastic")
def small_tray(a: float, b: float, c: float) -> list[Piece]:
    return open_box(a, b, c, 0.004, "#4aa3a0")


@item("food", "kitchen", "food")
def food(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    cookie = turned([(-c / 2, r * 0.9), (-c * 0.2, r), (c * 0.2, r), (c / 2, r * 0.75)], "#c58b4b")
    chips = [
        disc(0.0015, "#3b2213").at(c / 2, y, z)
        for y, z in ((0, 0.001), (0.005, 0.002), (-0.004, 0.004), (-0.003, -0.005), (0.003, -0.004))
    ]
    return [cookie, *chips]


@item("small food", "kitchen", "food")
def small_food(a: float, b: float, c: float) -> list[Piece]:
    leaf = turned([(0, 0.0045), (0.0008, 0.0035)], "#3f8a3a", sides=5).seen_only()
    stem = rod(0.0007, 0.0012, "#3f8a3a").seen_only()
    return [ball(a / 2, "#d2362a"), leaf.at(a / 2 - 0.0011), stem.at(a / 2 - 0.0004)]


@item("food container lid", "kitchen", "plastic")
def food_container_lid(a: float, b: float, c: float) -> list[Piece]:
    lid = slab(rounded(a, b, 0.02), c, "#2f78c4")
    inset = slab(rounded(a * 0.84, b * 0.84, 0.016), 0.0006, "#5e9bdc").seen_only().at(z=c / 2)
    return [lid, inset]
