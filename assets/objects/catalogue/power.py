"""Things with a motor, a plug, a flame or a light, and what is put into machines."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    DARK_STEEL,
    ORANGE,
    RED,
    STEEL,
    YELLOW,
    band,
    disc,
)
from maniskill_taskgrasp.assets.objects.pieces import (
    Piece,
    box,
    rod,
    slab,
    turned,
)
from maniskill_taskgrasp.assets.objects.recipe import item


def pistol(a: float, b: float, c: float, body: str, reach: float, battery: bool) -> list[Piece]:
    """Pistol-shaped drill; its grip, a x b x c along -y, is what people hold."""
    r = 0.03
    motor = turned([(-0.075, r * 0.8), (-0.07, r), (0.045, r), (0.06, r * 0.75)], body)
    chuck = turned([(0.06, 0.02), (0.08, 0.02), (0.1, 0.012)], BLACK)
    bit = rod(0.0035, reach, STEEL).at(0.1 + reach / 2)
    grip = turned([(-a / 2, b / 2), (a / 2, b / 2)], body, c / b).along((0, -1, 0))
    grip = grip.at(-0.03, -0.012 - a / 2).held()
    trigger = box(0.012, 0.025, 0.014, RED, 0.002).at(-0.03 + b / 2 + 0.003, -0.045)
    foot = box(0.09, 0.03, 0.06, BLACK, 0.003).at(-0.02, -0.012 - a - 0.012)
    cord = (
        turned([(0, 0.008), (0.03, 0.006)], BLACK).along((0, -1, 0)).at(-0.03, -0.012 - a + 0.001)
    )
    vents = [band(r, 0.003, BLACK).at(x) for x in (-0.055, -0.045, -0.035)]
    pieces = [motor, chuck, bit, grip, trigger, foot if battery else cord, *vents]
    return [piece.turn((0, 0, 1), -90) for piece in pieces]  # +y was up.


@item("drill", "power tools", "plastic", shown="lying")
def drill(a: float, b: float, c: float) -> list[Piece]:
    return pistol(a, b, c, "#2e6f57", 0.05, battery=False)


@item("power drill", "power tools", "plastic", shown="standing")
def power_drill(a: float, b: float, c: float) -> list[Piece]:
    return pistol(a, b, c, YELLOW, 0.02, battery=True)


@item("dremel", "power tools", "plastic", length=0.22)
def dremel(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [(0, r * 0.85), (0.008, r), (0.11, r), (0.14, r * 0.7), (0.165, r * 0.42)], "#3a4149"
    )
    nose = turned([(0.165, r * 0.36), (0.18, r * 0.36), (0.182, r * 0.2), (0.19, r * 0.2)], STEEL)
    tool = rod(0.0016, a - 0.2, STEEL).at((a + 0.18) / 2)
    stone = turned([(a - 0.012, 0.005), (a, 0.005)], ORANGE)
    return [
        body,
        nose,
        tool,
        stone,
        band(r, 0.02, BLUE).at(0.035),
        band(r, 0.003, BLACK).at(0.06),
        box(0.014, 0.008, 0.001, RED).seen_only().at(0.085, 0, r),
    ]


@item("electric tool", "power tools", "plastic", length=0.26)
def electric_tool(a: float, b: float, c: float) -> list[Piece]:
    """Oscillating multi-tool: straight body with a blade across its nose."""
    r = b / 2
    body = turned(
        [(0, r * 0.8), (0.01, r * 0.95), (0.07, r * 0.86), (0.14, r), (0.19, r), (0.22, r * 0.7)],
        ORANGE,
    )
    nose = turned([(0.22, r * 0.6), (0.245, r * 0.5)], DARK_STEEL)
    blade = slab([(0.225, -0.011), (0.225, 0.011), (a, 0.016), (a, -0.016)], 0.003, STEEL).at(
        0, 0, -0.018
    )
    switch = box(0.03, 0.014, 0.004, BLACK).at(0.09, 0, r * 0.89)
    return [
        body,
        nose,
        blade,
        switch,
        band(r, 0.016, BLACK).at(0.165),
        band(r * 0.93, 0.004, BLACK).at(0.016),
    ]


@item("torch", "power tools", "plastic")
def torch(a: float, b: float, c: float) -> list[Piece]:
    """Hand lantern: a wide head on a can-shaped battery case."""
    r = b / 2
    case = turned([(0, r * 0.72), (0.08, r * 0.72), (0.1, r), (a - 0.006, r)], YELLOW)
    lens = turned([(a - 0.006, r * 0.97), (a, r * 0.9)], BLACK, hollow=(0.001, r * 0.82))
    return [
        case,
        lens,
        disc(r * 0.74, "#dff1fb").at(a - 0.0008),
        band(r * 0.72, 0.012, BLACK).at(0.02),
        box(0.02, 0.016, 0.004, RED).at(0.055, 0, r * 0.73),
    ]


@item("flashlight", "power tools", "metal")
def flashlight(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    body = turned(
        [(-a / 2, r * 0.8), (a * 0.22, r * 0.8), (a * 0.3, r), (a / 2, r)],
        "#2b2e33",
        hollow=(0.0008, r * 0.88),
    )
    grips = [
        band(r * 0.8, 0.003, "#55595f").at(x)
        for x in (-0.05, -0.042, -0.034, -0.026, -0.018, -0.01)
    ]
    return [
        body,
        *grips,
        disc(r * 0.8, "#e8f6ff").at(a / 2 - 0.0006),
        disc(r * 0.3, YELLOW).at(a / 2 - 0.0004),
        box(0.008, 0.006, 0.0016, RED).seen_only().at(0.012, 0, r * 0.8),
    ]
