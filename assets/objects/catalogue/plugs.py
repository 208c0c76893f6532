"""Plugs, hoses and batteries."""

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
    band,
    disc,
    patch,
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


@item("air hose", "power tools", "rubber", length=0.18)
def air_hose(a: float, b: float, c: float) -> list[Piece]:
    """Blow gun at the end of an air hose: a flat body with a lever and a brass tip."""
    body = turned([(-a / 2 + 0.05, c / 2 * 0.9), (0.03, c / 2), (0.04, c * 0.3)], BLUE).at(
        0, -0.006
    )
    tip = rod(0.0035, 0.052, BRASS).at(a / 2 - 0.026, -0.006)
    hose = rod(0.0065, 0.05, BLACK).at(-a / 2 + 0.025, -0.006)
    lever = slab(
        [(0.03, 0.002), (0.03, 0.008), (-0.045, b - 0.006 - c / 2), (-0.045, b - 0.01 - c / 2)],
        0.01,
        RED,
    )
    nut = turned([(-0.046, 0.008), (-0.036, 0.008)], BRASS, sides=6).at(0, -0.006)
    return [body, tip, hose, lever, nut]


def prongs(x: float, gap: float) -> list[Piece]:
    """Two flat pins of a plug, pointing to +x from x."""
    return [box(0.017, 0.0016, 0.0064, STEEL).at(x + 0.0085, s * gap / 2) for s in (-1, 1)]


@item("electrical plug", "electronics", "plastic")
def electrical_plug(a: float, b: float, c: float) -> list[Piece]:
    half = a / 2
    body = convex(
        [
            (x, s * y, t * z)
            for x, y, z in (
                (half - 0.017, b / 2, c / 2),
                (-0.004, b / 2, c / 2),
                (-half + 0.01, b * 0.3, c * 0.3),
            )
            for s in (-1, 1)
            for t in (-1, 1)
        ],
        BLACK,
    )
    cable = rod(0.004, 0.014, BLACK).at(-half + 0.007)
    return [body, cable, *prongs(half - 0.017, 0.0127)]


@item("plug", "electronics", "plastic")
def plug(a: float, b: float, c: float) -> list[Piece]:
    """Plug with the first centimetres of its cable, which are stiffened against kinks."""
    half = a / 2
    body = convex(
        [
            (x, s * y, t * z)
            for x, y, z in (
                (half - 0.017, b / 2, c / 2),
                (half - 0.04, b / 2, c / 2),
                (half - 0.05, b * 0.32, c * 0.35),
            )
            for s in (-1, 1)
            for t in (-1, 1)
        ],
        WHITE,
    )
    relief = turned([(-half, 0.0028), (0.0, 0.003), (0.002, 0.0035)], WHITE)
    rings = [band(0.0031, 0.0015, GREY).at(x) for x in (-0.02, -0.014, -0.008)]
    return [body, relief, *rings, *prongs(half - 0.017, 0.0105)]


@item("end of hose", "machine shop", "rubber")
def end_of_hose(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    rubber = turned([(-a / 2, r * 0.74), (a * 0.1, r * 0.74)], "#2e6e3c")
    nut = turned([(a * 0.1, r / 0.966), (a * 0.3, r / 0.966)], BRASS, sides=12)
    nozzle = turned([(a * 0.3, r * 0.8), (a * 0.36, r * 0.8), (a / 2, r * 0.4)], BRASS)
    ribs = [band(r * 0.74, 0.002, "#235430").at(x) for x in (-0.045, -0.03, -0.015)]
    return [rubber, nut, nozzle, *ribs, disc(r * 0.24, BLACK).at(a / 2)]


@item("battery", "electronics", "metal")
def battery(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        rod(r, a - 0.0015, BLACK).at(-0.00075),
        rod(r * 0.38, 0.0015, STEEL).at(a / 2 - 0.00075),
        band(r, a * 0.3, BRASS).at(a * 0.33),
        band(r, 0.002, WHITE).at(a * 0.17),
        disc(r * 0.9, STEEL).at(-a / 2 + 0.0001),
    ]


@item("combination lock", "household", "metal")
def combination_lock(a: float, b: float, c: float) -> list[Piece]:
    half = a / 2
    body = slab(
        [
            (x * 0.9, y * 0.999)
            for x, y in (
                (half * 0.2, b / 2),
                (-half, b / 2),
                (-half * 1.11, b * 0.4),
                (-half * 1.11, -b * 0.4),
                (-half, -b / 2),
                (half * 0.2, -b / 2),
            )
        ],
        c,
        BRASS,
    )
    path = [
        (half * 0.1, -b * 0.3, 0.0),
        (half * 0.6, -b * 0.3, 0.0),
        (half - 0.0035, -b * 0.14, 0.0),
        (half - 0.0035, b * 0.14, 0.0),
        (half * 0.6, b * 0.3, 0.0),
        (half * 0.1, b * 0.3, 0.0),
    ]
    shackle = bent(path, 0.0035, STEEL)
    dials = [
        box(0.006, b * 0.16, 0.001, BLACK).seen_only().at(-half * 0.55, y, c / 2)
        for y in (-b * 0.3, -b * 0.1, b * 0.1, b * 0.3)
    ]
    return [
        body,
        shackle,
        *dials,
        *(
            patch(0.003, 0.0015, WHITE).at(-half * 0.55, y, c / 2 + 0.0004)
            for y in (-b * 0.3, -b * 0.1, b * 0.1, b * 0.3)
        ),
        patch(b * 0.08, b * 0.4, GREEN).at(-half * 0.1, 0, c / 2),
    ]
