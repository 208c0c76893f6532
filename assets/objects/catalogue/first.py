"""First few objects of other kinds."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.pieces import Piece, arc, ball, bent, box, rod, turned
from maniskill_taskgrasp.assets.objects.recipe import item


@item("mug", "kitchen", "ceramic")
def mug(a: float, b: float, c: float) -> list[Piece]:
    body = rod(0.04, 0.1, "#3f7fb5")
    path = [(x * 1.15, y * 0.95, z) for x, y, z in arc(0.035, -90, 90, 4)]
    return [body, bent(path, c / 2.6, "#3f7fb5").at(0, 0.04).turn((1, 0, 0), 0).held()]


@item("ball", "toys", "rubber")
def a_ball(a: float, b: float, c: float) -> list[Piece]:
    return [ball(a / 2, "#c8d93a")]


@item("rectangular block", "workshop", "wood")
def block(a: float, b: float, c: float) -> list[Piece]:
    return [box(a, b, c, "#c79a5b", 0.001)]


@item("plate", "kitchen", "ceramic", length=0.18, width=0.18)
def plate(a: float, b: float, c: float) -> list[Piece]:
    r = a / 2
    return [turned([(-c / 2, r * 0.6), (c / 2, r)], "#f2f0ea")]


@item("marker", "stationery", "plastic")
def marker(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [rod(r, a * 0.65, "#f5f5f5").at(-a * 0.175), rod(r, a * 0.35, "#1a4fa0").at(a * 0.325)]


@item("cell phone", "electronics", "plastic")
def cell_phone(a: float, b: float, c: float) -> list[Piece]:
    return [box(a, b, c, "#22252a", 0.003)]


@item("bottle", "bottles", "plastic", length=0.22)
def bottle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned(
            [(0, r * 0.95), (0.004, r), (0.15, r), (0.19, r * 0.35), (a - 0.02, r * 0.35)],
            "#3aa0a0",
            flat=c / b,
        ),
        rod(r * 0.4, 0.02, "#eeeeee").at(a - 0.01),
    ]


@item("spray bottle", "bottles", "plastic", length=0.22)
def spray_bottle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [(0, r * 0.95), (0.004, r), (0.11, r), (0.155, r * 0.35), (0.175, r * 0.35)],
        "#5bb7d6",
        flat=c / b,
    )
    head = box(a - 0.175, 0.052, 0.022, "#e8542f", 0.002).at((a + 0.175) / 2, -0.004)
    trigger = box(0.04, 0.008, 0.014, "#e8542f").at(0.16, -0.024)
    return [body, head, trigger]


@item("rod", "workshop", "metal", length=0.2)
def a_rod(a: float, b: float, c: float) -> list[Piece]:
    return [rod(b / 2, a, "#b8bcc4")]


@item("paper cup", "kitchen", "paper")
def paper_cup(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [turned([(-a / 2, r * 0.72), (a / 2, r)], "#e9e2d3")]


@item("tape measure", "tools", "plastic")
def tape_measure(a: float, b: float, c: float) -> list[Piece]:
    return [box(a, b, c, "#f0c020", 0.003)]


@item("wrench", "tools", "metal")
def wrench(a: float, b: float, c: float) -> list[Piece]:
    return [
        box(a * 0.8, b * 0.6, c * 0.8, "#b8bcc4"),
        box(a * 0.15, b, c, "#b8bcc4").at(a * 0.425),
        box(a * 0.15, b, c, "#b8bcc4").at(-a * 0.425),
    ]
