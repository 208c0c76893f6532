"""What the AR10 looks like: the visible shapes of each hand link, in millimetres.

Sizes are those of the parts in Active8Robots/AR10; the shapes are our own. Where a hand touches
things (pads, palm face, sides of the fingers) the surface lies on the collision primitives, so that
pictures show contact where the physics has it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from maniskill_taskgrasp.agents.sawyer_ar10.ar10 import KNUCKLES, THUMB_PAD_PITCH
from maniskill_taskgrasp.agents.sawyer_ar10.look_sawyer import TO_LEFT, TO_X, Look
from maniskill_taskgrasp.agents.sawyer_ar10.shapes import (
    Soup,
    cylinder,
    loft,
    place,
    plate,
    rounded_box,
)

CMC_TILT = 0.2808  # [rad] about y: turns z to the thumb's first axis.
INNER, OUTER = 4.1, 5.55  # Half distance of a segment's two plates; neighbours nest.
SHEET = 1.3


def _twin(discs: list[tuple[float, float, float]], half: float, axis: str = "x") -> Look:
    """Two parallel plates, `half` to either side."""
    offsets = {"x": (half, 0.0, 0.0), "y": (0.0, half, 0.0)}[axis]
    sheet = plate(discs, SHEET, axis)
    return [("sheet", place(sheet, [side * way for way in offsets])) for side in (-1, 1)]


def _pin(y: float, z: float, length: float = 13.0) -> Look:
    """Steel pin of a finger joint, along x."""
    return [("steel", place(cylinder(2.2, length, 0.5, 20), (0, y, z), TO_X))]


def _rod_end(y: float, z: float, towards: tuple[float, float]) -> Look:
    """Light-blue eye between the plates, its shank pointing to `towards` (y, z)."""
    eye = plate([(y, z, 3.7)], 4.0, "x", 0.5, 28)
    shank = plate([(y, z, 1.8), (*towards, 1.8)], 3.4, "x", 0.8, 24)
    return [("rod_end", eye), ("rod_end", shank)]


def thimble(half_x: float, half_y: float, length: float) -> Soup:
    """Rubber fingertip on z = 0..length: a rounded block with a lip at its mouth."""
    x, y = half_x, half_y
    return loft(
        [
            (0.0, x - 0.9, y - 0.9, 2.5),
            (0.5, x - 0.2, y - 0.2, 3.0),
            (1.2, x, y, 3.0),
            (2.6, x, y, 3.0),
            (2.9, x - 0.5, y - 0.5, 2.8),
            (3.7, x - 0.5, y - 0.5, 2.8),
            (4.0, x, y, 3.0),
            (length - 4.2, x, y, 3.0),
            (length - 2.6, x - 0.35, y - 0.35, 3.0),
            (length - 1.3, x - 1.05, y - 1.05, 3.0),
            (length - 0.4, x - 2.1, y - 2.1, 2.8),
            (length, x - 3.6, y - 3.6, 2.2),
        ],
        6,
    )


def proximal() -> Look:
    """Twin plates from knuckle to pip, with a lever behind the knuckle."""
    return [
        *_twin([(-0.8, 0, 4.9), (-0.8, 45, 4.8), (-3.6, -9.2, 4.2)], INNER),
        *_pin(0, 0),
        *_rod_end(-3.6, -9.2, (-4.2, -1.5)),
        ("steel", place(cylinder(1.8, 2 * INNER, 0.2, 16), (0, -1, 20), TO_X)),
        ("steel", place(cylinder(1.8, 2 * INNER, 0.2, 16), (0, -1, 33), TO_X)),
    ]


def middle() -> Look:
    """Twin plates from pip to dip, and the link rod that drags the distal segment along."""
    rod = plate([(-3.4, 1, 2.3), (-3.4, 29, 2.3)], 4.4, "x", 0.8)
    return [
        *_twin([(-0.8, 0, 4.6), (-0.8, 30, 4.4), (-5.6, 8, 3.4)], OUTER),
        *_pin(0, 0),
        *_pin(0, 30),
        ("steel", rod),
        *_rod_end(-5.6, 8, (-4.4, 15)),
    ]


def distal() -> Look:
    """Neck plates and rubber thimble."""
    return [
        *_twin([(-0.5, 0, 4.2), (-0.3, 13, 4.2)], INNER),
        ("black", place(rounded_box((6.6, 6.5, 9), 1), (0, -0.5, 8))),
        ("rubber", place(thimble(8.75, 6.75, 23.5), (0, 0.6, 10.75))),
    ]


def metacarpal() -> Look:
    """Bracket from the thumb's first axis to its second."""
    web = place(rounded_box((30, 16, 1.5), 0.6, 2), (-18, 0, -0.8))
    hinge = place(cylinder(5.0, 17, 0.8, 28), (0, 0, 0), (0, CMC_TILT, 0))
    axle = place(cylinder(2.4, 19.4, 0.5, 20), (-36.6, 0, 4.8), TO_LEFT)
    return [
        *_twin([(3.8, -5, 5.2), (4.6, -35.4, 4.7)], 7.8, "y"),
        ("sheet", web),
        ("rod_end", hinge),
        ("steel", axle),
    ]


def thumb() -> Look:
    """Bent twin plates and the same rubber thimble."""
    pad = place(thimble(7.5, 9.5, 25.0), (0, 0, -12.5))
    return [
        *_twin([(0, 0, 4.9), (7.8, -19, 4.6)], 4.6, "y"),
        *_twin([(7.8, -19, 4.6), (14.8, -33.5, 4.6)], 4.6, "y"),
        ("black", place(rounded_box((12, 7, 7), 1), (-30, 0, 12.6), (0, 0.45, 0))),
        ("rod_end", place(cylinder(3.7, 6.5, 0.5, 28), (-19, 0, 7.8), TO_LEFT)),
        ("rubber", place(pad, (-39.3, 0.1, 19.2), (0, THUMB_PAD_PITCH, 0))),
    ]


def palm() -> Look:
    """Wrist plate, electronics, bent palm sheet, servos and the ears that hold the knuckles."""
    return [*_wrist(), *_electronics(), *_sheet(), *_servos(), *_knuckles(), *_thumb_base()]


def _wrist() -> Look:
    wrist = plate([(x, y, 13) for x in (-23.4, 23.4) for y in (-18.9, 15.9)], 2, bevel=0.5)
    look: Look = [("dark", place(wrist, (0, 0, 1.2)))]
    for x, y in ((-29, 11), (29, 11), (-29, -14), (29, -14)):
        look.append(("steel", place(cylinder(3, 3, 0.5, 12), (x, y, 3))))
    return look


def _electronics() -> Look:
    """Block with air slots at the sides, sockets at the back and a label towards the palm side."""
    look: Look = [("black", place(rounded_box((49.6, 49.6, 47.6), 3), (0, 0, 26)))]
    for side in (-1, 1):
        for row in range(5):
            rib = rounded_box((1.6, 36, 3), 0.7, 2)
            look.append(("dark", place(rib, (side * 24.6, 0, 14 + 6 * row))))
    look += [
        ("dark", place(rounded_box((34, 1.4, 26), 0.6, 2), (0, 24.6, 27))),
        ("grey", place(rounded_box((26, 1.2, 5), 0.5, 2), (0, 25.0, 33))),
        ("rod_end", place(rounded_box((26, 1.2, 2), 0.5, 2), (0, 25.0, 27))),
        ("steel", place(rounded_box((13, 2, 11), 0.8, 2), (-9, -24.8, 16))),
        ("orange", place(rounded_box((10, 2, 7), 0.8, 2), (10, -24.8, 15))),
    ]
    return look


def _sheet() -> Look:
    """Main sheet at y = 9..10.5 with its edges bent towards the palm side."""
    upper = plate([(z, x, 3) for z in (100, 130.5) for x in (-53.5, 24)], 1.5, "y")
    lower = plate([(z, x, 3) for z in (53, 101) for x in (-24.5, 24.5)], 1.5, "y")
    look: Look = [("sheet", place(shape, (0, y, 0))) for shape, y in ((upper, 9.75), (lower, 9.7))]
    edges = ((-55.9, 115.5, 33), (26.4, 115.5, 33), (-27.2, 74, 44), (27.2, 74, 44))
    for x, z, length in edges:
        look.append(("sheet", place(rounded_box((1.5, 18.5, length), 0.6, 2), (x, 10.7, z))))
    return look


def _servos() -> Look:
    """Linear servos: four before and four behind the upper sheet, two across the lower palm."""
    look: Look = []
    for x, _, _ in KNUCKLES.values():
        centre = x * 1e3
        for y, depth in ((15.55, 9.9), (4.85, 8.1)):
            look.append(("black", place(rounded_box((17, depth, 35), 1.5), (centre, y, 115))))
        look.append(("grey", place(rounded_box((10, 0.6, 14), 0.25, 2), (centre, 20.4, 113))))
        rod = cylinder(1.9, 10, 0.3, 16)
        look.append(("steel", place(rod, (centre, 4, 135))))
    for z in (62, 86):
        look.append(("black", place(rounded_box((52, 11.2, 20), 1.5), (0, 16.2, z))))
        look.append(("grey", place(rounded_box((22, 0.6, 9), 0.25, 2), (-6, 21.8, z))))
        look.append(("black", place(rounded_box((50, 8.1, 20), 1.5), (0, 4.9, z))))
    return look


def _knuckles() -> Look:
    """Two ears per finger, rising from the upper sheet to the knuckle pin."""
    look: Look = []
    for x, y, z in np.array(list(KNUCKLES.values())) * 1e3:
        ear = plate([(y - 0.5, z, 4.6), (4, 126, 5), (10, 126, 4)], SHEET, "x")
        for side in (-1, 1):
            look.append(("sheet", place(ear, (x + side * 7.4, 0, 0))))
        look.append(("rod_end", place(cylinder(3.4, 17.4, 0.6, 24), (x, y, z), TO_X)))
    return look


def _thumb_base() -> Look:
    """Two lugs that hold the thumb's first axis beside the lower palm."""
    lug = plate([(0, 0, 5.6), (16, 4, 6.5)], 2.0)
    look: Look = []
    for height in (-10.0, 10.0):
        placed = place(place(lug, (0, 0, height)), (-40.5, 3.5, 71.9), (0, CMC_TILT, 0))
        look.append(("sheet", placed))
    pin = place(cylinder(2.4, 25, 0.5, 20), (-40.5, 3.5, 71.9), (0, CMC_TILT, 0))
    return [*look, ("steel", pin)]


FINGERS = tuple(KNUCKLES)
LOOKS: dict[str, tuple[tuple[str, ...], Callable[[], Look]]] = {
    "hand_base": (("hand_base",), palm),
    "finger_proximal": (tuple(f"{finger}_proximal" for finger in FINGERS), proximal),
    "finger_middle": (tuple(f"{finger}_middle" for finger in FINGERS), middle),
    "finger_distal": (tuple(f"{finger}_distal" for finger in FINGERS), distal),
    "thumb_metacarpal": (("thumb_metacarpal",), metacarpal),
    "thumb_distal": (("thumb_distal",), thumb),
}
"""Mesh -> the links that show it and the function that makes it."""
