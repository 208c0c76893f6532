"""Bottles, cans and their caps. All stand along +x with the base at x = 0."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    STEEL,
    WHITE,
    YELLOW,
    band,
    disc,
    patch,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    bent,
    box,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


def bottle_body(
    height: float,
    r: float,
    shoulder: float,
    neck: float,
    neck_height: float,
    colour: str,
    flat: float = 1.0,
) -> Piece:
    """Straight body, sloping shoulder of that height, straight neck; `height` over all."""
    top = height - neck_height
    return turned(
        [
            (0, r * 0.93),
            (0.004, r),
            (top - shoulder, r),
            (top - shoulder * 0.55, r * 0.88),
            (top, neck),
            (height, neck),
        ],
        colour,
        flat,
    )


def ribbed_cap(r: float, height: float, colour: str) -> Piece:
    """Screw cap with a polygon's grip, base at x = 0."""
    return turned([(0, r), (height * 0.85, r), (height, r * 0.86)], colour, sides=14)


@item("aerosol can", "bottles", "metal", length=0.19)
def aerosol_can(a: float, b: float, c: float) -> list[Piece]:
    r, top = b / 2, a - 0.032
    body = turned(
        [
            (0, r * 0.92),
            (0.004, r),
            (top, r),
            (top + 0.008, r * 0.8),
            (top + 0.012, r * 0.5),
            (top + 0.016, r * 0.5),
        ],
        STEEL,
    )
    nozzle = turned([(0, 0.0085), (0.012, 0.0085), (0.016, 0.007)], WHITE).at(a - 0.016)
    return [
        body,
        band(r, top * 0.86, BLUE).at(top * 0.5),
        band(r + 0.0001, 0.03, WHITE).at(top * 0.6),
        nozzle,
        disc(0.002, RED).turn((0, 0, 1), 90).at(a - 0.008, 0.0086),
    ]


@item("air freshener", "bottles", "plastic", shown="standing")
def air_freshener(a: float, b: float, c: float) -> list[Piece]:
    r, flat = b / 2, c / b
    base = turned([(0, r), (0.02, r), (0.024, r * 0.82)], WHITE, flat)
    cone = turned(
        [(0.024, r * 0.8), (a * 0.8, r * 0.62), (a * 0.95, r * 0.45), (a, r * 0.2)], "#7cc6a4", flat
    )
    slots = [
        turned([(x, r * k), (x + 0.004, r * (k - 0.012))], "#2f6b52", flat).seen_only()
        for x, k in ((0.034, 0.795), (0.044, 0.77), (0.054, 0.75))
    ]
    return [base, cone, *slots]


@item("bottle", "bottles", "plastic", length=0.22)
def bottle(a: float, b: float, c: float) -> list[Piece]:
    flat = c / b
    return [
        bottle_body(a - 0.018, b / 2, 0.05, 0.014, 0.014, "#2f9aa0", flat),
        band(b / 2, 0.07, WHITE, flat).at(0.08),
        ribbed_cap(0.017, 0.024, WHITE).at(a - 0.024),
    ]


@item("dish washing soap bottle", "bottles", "plastic", length=0.24)
def dish_washing_soap_bottle(a: float, b: float, c: float) -> list[Piece]:
    r, flat, top = b / 2, c / b, a - 0.035
    body = turned(
        [
            (0, r * 0.86),
            (0.01, r * 0.95),
            (0.09, r),
            (top - 0.05, r * 0.74),
            (top - 0.02, r * 0.5),
            (top, 0.016),
        ],
        "#3aa95a",
        flat,
    )
    label = turned([(0.04, r * 0.975), (0.09, r * 1.005), (0.13, r * 0.9)], WHITE, flat)
    cap = turned([(0, 0.0155), (0.014, 0.0155), (0.018, 0.008), (0.035, 0.006)], BLUE)
    return [body, label.seen_only(), cap.at(top)]


@item("large round plastic bottle", "bottles", "plastic", length=0.27)
def large_round_plastic_bottle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [
            (0, r * 0.8),
            (0.012, r),
            (0.15, r),
            (0.18, r * 0.9),
            (0.22, r * 0.45),
            (a - 0.022, r * 0.36),
        ],
        "#6b3d22",
    )
    return [
        body,
        band(r, 0.06, RED).at(0.1),
        band(r + 0.0001, 0.012, WHITE).at(0.1),
        ribbed_cap(r * 0.42, 0.022, RED).at(a - 0.022),
    ]


@item("laundry detergent bottle", "bottles", "plastic")
def laundry_detergent_bottle(a: float, b: float, c: float) -> list[Piece]:
    half = b / 2
    lower = box(a * 0.48, b, c, ORANGE, 0.003).at(a * 0.24)
    upper = slab(
        [
            (a * 0.48, -half + 0.026),
            (a * 0.48, half),
            (a * 0.62, half),
            (a * 0.8, half * 0.6),
            (a * 0.8, -half + 0.03),
        ],
        c * 0.82,
        ORANGE,
    )
    grip = bent(
        [
            (a * 0.46, -half + 0.008, 0),
            (a * 0.66, -half + 0.008, 0),
            (a * 0.755, -half + 0.024, 0),
            (a * 0.755, -half + 0.036, 0),
        ],
        0.008,
        ORANGE,
    )
    cap = rod(0.018, a * 0.2, BLUE).at(a * 0.9, 0.007)
    return [
        lower,
        upper,
        grip,
        cap,
        patch(a * 0.34, b * 0.7, YELLOW).at(a * 0.25, 0, c / 2),
        patch(a * 0.12, b * 0.5, BLUE).at(a * 0.25, 0, c / 2 + 0.0002),
    ]


@item("lysol bottle", "bottles", "plastic", length=0.24)
def lysol_bottle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [
            (0, r * 0.93),
            (0.004, r),
            (0.13, r),
            (0.145, r * 0.93),
            (0.19, r * 0.5),
            (a - 0.03, r * 0.42),
        ],
        "#7a4a1e",
    )
    return [
        body,
        band(r, 0.1, YELLOW).at(0.07),
        band(r + 0.0002, 0.03, BLUE).at(0.085),
        ribbed_cap(r * 0.5, 0.034, WHITE).at(a - 0.034),
    ]


@item("oil bottle", "bottles", "plastic")
def oil_bottle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned([(0, r * 0.94), (0.003, r), (a * 0.5, r), (a * 0.58, r * 0.5)], YELLOW)
    spout = turned([(0, r * 0.5), (0.006, r * 0.5), (0.008, r * 0.3), (a * 0.42, r * 0.1)], RED)
    return [body, spout.at(a * 0.58), band(r, a * 0.22, BLACK).at(a * 0.26)]


@item("plastic squeeze bottle", "bottles", "plastic")
def plastic_squeeze_bottle(a: float, b: float, c: float) -> list[Piece]:
    r, flat = b / 2, c / b
    body = turned(
        [(0, r * 0.85), (0.006, r), (a * 0.55, r * 0.94), (a * 0.66, r * 0.55)], RED, flat
    )
    cap = turned([(0, 0.0135), (0.012, 0.0135), (0.014, 0.008), (a * 0.34, 0.003)], WHITE)
    return [
        body,
        cap.at(a * 0.66),
        turned([(a * 0.18, r * 0.992), (a * 0.42, r * 0.97)], WHITE, flat).seen_only(),
    ]


@item("small bottle", "bottles", "plastic")
def small_bottle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        bottle_body(a - 0.016, r, 0.016, r * 0.5, 0.006, "#8c4a2a"),
        band(r, a * 0.4, WHITE).at(a * 0.36),
        ribbed_cap(r * 0.72, 0.02, WHITE).at(a - 0.02),
    ]


@item("small plastic squeeze bottle", "bottles", "plastic")
def small_plastic_squeeze_bottle(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned([(0, r * 0.94), (0.003, r), (a * 0.58, r), (a * 0.64, r * 0.8)], "#f0d040")
    cap = turned(
        [(0, r * 0.75), (0.01, r * 0.75), (0.012, r * 0.45), (a * 0.36, 0.0025)], "#f0d040"
    )
    return [body, cap.at(a * 0.64), band(r * 0.78, 0.002, "#b5992a").at(a * 0.642)]


@item("thin bottle", "bottles", "plastic", length=0.26)
def thin_bottle(a: float, b: float, c: float) -> list[Piece]:
    flat = c / b
    return [
        bottle_body(a - 0.02, b / 2, 0.06, 0.028, 0.016, "#5aa06a", flat),
        band(b / 2, 0.1, WHITE, flat).at(0.1),
        band(b / 2 + 0.0002, 0.03, GREEN, flat).at(0.11),
        ribbed_cap(0.02, 0.028, WHITE).at(a - 0.028),
    ]


@item("deoderant", "bathroom", "plastic")
def deoderant(a: float, b: float, c: float) -> list[Piece]:
    flat = c / b
    base = turned([(0, b / 2 * 0.96), (a * 0.1, b / 2 * 0.96)], GREY, flat)
    body = turned([(a * 0.1, b / 2), (a * 0.62, b / 2)], "#234f7d", flat)
    cap = turned(
        [
            (a * 0.62, b / 2 * 0.96),
            (a * 0.88, b / 2 * 0.94),
            (a * 0.97, b / 2 * 0.8),
            (a, b / 2 * 0.5),
        ],
        WHITE,
        flat,
    )
    return [base, body, cap, band(b / 2, a * 0.12, "#6fb1d9", flat).at(a * 0.4)]
