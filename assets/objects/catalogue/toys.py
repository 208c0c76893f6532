"""Toys and balls."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    GREEN,
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
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    ball,
    box,
    convex,
    ring,
    rod,
    slab,
)
from maniskill_taskgrasp.assets.objects.recipe import item


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
