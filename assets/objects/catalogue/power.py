"""Things with a motor, a plug, a flame or a light, and what is put into machines."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.forms import (
    BLACK,
    BLUE,
    BRASS,
    DARK_STEEL,
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
from maniskill_taskgrasp.assets.objects.pieces import Piece, bent, box, convex, rod, slab, turned
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


def twist(r: float, start: float, end: float, colour: str, step: float) -> list[Piece]:
    """Drill flutes: a straight core with drawn rings."""
    rings, x = [], start + step
    while x < end - step / 2:
        rings.append(band(r, step * 0.35, "#5c626a").at(x))
        x += step
    return [rod(r, end - start, colour).at((start + end) / 2), *rings]


@item("drill bit", "machine shop", "metal")
def drill_bit(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    point = turned([(a / 2 - 0.004, r * 0.99), (a / 2, 0.0)], STEEL)
    return [
        rod(r * 0.99, a * 0.38, STEEL).at(-a * 0.31),
        *twist(r, -a * 0.12, a / 2 - 0.004, "#9aa0a8", 0.005),
        point,
    ]


@item("drill part", "machine shop", "metal")
def drill_part(a: float, b: float, c: float) -> list[Piece]:
    """Taper arbor of a drill chuck."""
    r = b / 2
    return [
        turned(
            [
                (-a / 2, r * 0.55),
                (-a * 0.1, r * 0.85),
                (-a * 0.08, r),
                (0.002, r),
                (0.004, r * 0.7),
                (a / 2, r * 0.5),
            ],
            STEEL,
        ),
        band(r, 0.002, DARK_STEEL).at(-0.002),
    ]


@item("chuck", "machine shop", "metal")
def chuck(a: float, b: float, c: float) -> list[Piece]:
    """Square tool blank with a ground edge, 10 x 1 x 1 cm, as held in a lathe's chuck."""
    shank = box(a * 0.86, b, c, DARK_STEEL).at(-a * 0.07)
    tip = convex(
        [(a * 0.36, s * b / 2, t * c / 2) for s in (-1, 1) for t in (-1, 1)]
        + [(a / 2, -b / 2, c / 2), (a * 0.45, b / 2, c / 2), (a * 0.46, -b / 2, -c / 2)],
        BRASS,
    )
    return [shank, tip, patch(a * 0.3, b * 0.4, STEEL).at(-a * 0.2, 0, c / 2)]


@item(
    "end mill",
    "machine shop",
    "metal",
)
def end_mill(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    flat = box(0.012, b * 0.5, 0.0006, DARK_STEEL).seen_only().at(-a * 0.25, 0, r * 0.97)
    return [
        rod(r, a * 0.55, STEEL).at(-a * 0.225),
        flat,
        *twist(r * 0.96, a * 0.05, a / 2, BRASS, 0.0065),
    ]


@item("end mill holder", "machine shop", "metal")
def end_mill_holder(a: float, b: float, c: float) -> list[Piece]:
    r = b / 2
    return [
        turned([(-a / 2, r * 0.42), (0, r * 0.86)], STEEL),
        turned(
            [(0, r), (0.008, r), (0.008, r * 0.82), (0.014, r * 0.82), (0.014, r), (0.022, r)],
            DARK_STEEL,
        ),
        turned([(0.022, r * 0.7), (a / 2, r * 0.7)], STEEL),
        disc(r * 0.3, BLACK).at(a / 2),
        disc(0.004, BLACK).along((0, 0, 1)).at(a * 0.32, 0, r * 0.7),
    ]


@item("endmill part", "machine shop", "metal")
def endmill_part(a: float, b: float, c: float) -> list[Piece]:
    """Collet chuck with a cutter in it."""
    r = b / 2
    return [
        turned([(-a / 2, r * 0.55), (-0.02, r * 0.55), (-0.018, r), (0.002, r)], STEEL),
        turned([(0.002, r * 0.95), (0.026, r * 0.95), (0.03, r * 0.75)], DARK_STEEL, sides=16),
        *twist(r * 0.24, 0.03, a / 2, BRASS, 0.008),
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
