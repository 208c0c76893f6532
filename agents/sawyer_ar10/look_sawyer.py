"""What the Sawyer looks like: the visible shapes of each arm link, in millimetres.

Outer sizes are those of the manufacturer's meshes (RethinkRobotics/sawyer_robot); the shapes are
our own.
"""

from __future__ import annotations

from math import cos, pi, sin

from maniskill_taskgrasp.agents.sawyer_ar10.elbow import Elbow
from maniskill_taskgrasp.agents.sawyer_ar10.shapes import (
    Soup,
    cylinder,
    loft,
    place,
    plate,
    revolve,
    rounded_box,
)

Look = list[tuple[str, Soup]]
"""(material, shape) of one link."""

TO_X = (0.0, pi / 2, 0.0)  # Turns what points along z to point along x,
TO_BACK = (0.0, -pi / 2, 0.0)  # along -x,
TO_LEFT = (-pi / 2, 0.0, 0.0)  # along y.


def _ring(radius: float, low: float, width: float = 13.0) -> tuple[str, Soup]:
    """White band where two tubes meet."""
    high = low + width
    inner = radius - 6.0
    return "white", revolve(
        [
            (inner, low),
            (radius, low),
            (radius + 1.0, low + 1.0),
            (radius + 1.0, high - 1.0),
            (radius, high),
            (inner, high),
        ]
    )


def _tube(elbow: Elbow, xyz: tuple[float, float, float], rpy: tuple[float, float, float]) -> Look:
    """Red tube and dark cap of an elbow whose corner is at `xyz`."""
    tube, cap = elbow.parts()
    look = [("red", place(tube, xyz, rpy))]
    return [*look, ("dark", place(cap, xyz, rpy))] if len(cap) else look


def _knob(xyz: tuple[float, float, float]) -> Look:
    """Navigator: a dial with a light-blue lens, facing -x."""
    dial = revolve([(31, -6), (31, 2), (29, 4), (22, 5), (21, 4)])
    lens = revolve([(20, 3), (20, 5.5), (17, 7), (9, 8)])
    button = revolve([(8, 7), (8, 9), (6.5, 10)], 32)
    shapes = (("dark", dial), ("lens", lens), ("dark", button))
    return [(material, place(shape, xyz, TO_BACK)) for material, shape in shapes]


def pedestal() -> Look:
    """Round column on a cross-shaped wheeled base, the controller's tall box behind it."""
    column = revolve([(126, -640), (126, -628), (105, -612), (105, -30), (112, -26), (112, -10.5)])
    deck = plate([(70, -110, 60), (70, 110, 60), (-400, -150, 40), (-400, 150, 40)], 40, bevel=6)
    look: Look = [
        ("iron", column),
        ("iron", place(deck, (0, 0, -655))),
        ("iron", place(rounded_box((300, 220, 120), 20), (-140, 0, -725))),
    ]
    for x, y in ((215, 295), (215, -297), (-455, 295), (-455, -297)):
        beam = plate([(-125 + x * 0.1, y * 0.15, 60), (x, y, 46)], 52, bevel=8)
        caster = cylinder(43, 34, 5, 40)
        hub = cylinder(18, 40, 2)
        leg = revolve([(30, -832), (30, -812), (22, -806), (22, -780)], 32)
        look += [
            ("iron", place(beam, (0, 0, -770))),
            ("iron", place(leg, (x, y, 0))),
            ("rubber", place(caster, (x, y, -871), TO_LEFT)),
            ("grey", place(hub, (x, y, -871), TO_LEFT)),
            ("iron", place(rounded_box((60, 56, 36), 8), (x, y, -842))),
        ]
    look += _controller()
    return look


def _controller() -> Look:
    """The box that holds the computer: panel, air slots and a status light."""
    box = rounded_box((220, 400, 530), 14)
    look: Look = [("iron", place(box, (-325, 0, -380)))]
    panel = rounded_box((6, 330, 430), 2.5)
    look.append(("dark", place(panel, (-435, 0, -370))))
    for row in range(9):
        slot = rounded_box((4, 200, 8), 1.9, 2)
        look.append(("black", place(slot, (-438, 0, -260 - 20 * row))))
    for side in (-1, 1):
        stripe = rounded_box((130, 3, 14), 1.4, 2)
        look.append(("red", place(stripe, (-325, side * 200, -170))))
    return look


def arm_base() -> Look:
    """Bolt flange and red collar under the first joint."""
    flange = revolve([(101, 0.5), (105, 4), (105, 16), (101, 20), (86, 20)], 64)
    collar = revolve([(90, 18), (90, 24), (82, 40), (76, 66), (74, 79.5)], 64)
    look: Look = [("dark", flange), ("red", collar)]
    for bolt in range(8):
        angle = (bolt + 0.5) * pi / 4
        at = (96 * cos(angle), 96 * sin(angle), 21)
        look.append(("steel", place(cylinder(5.5, 6, 1, 12), at)))
    return look


def shoulder() -> Look:
    """l0: the turning column, the navigator at its back, the elbow towards j1."""
    column = revolve(
        [(66, 8), (71, 13), (70, 120), (68, 230), (66, 270), (61, 289), (52, 301), (46, 304)], 64
    )
    bend = Elbow(
        length_in=81, length_out=55.5, radius_in=60, radius_bend=68, radius_out=68, bend=9, cut=25
    )
    return [
        _ring(72, 0),
        ("red", column),
        *_tube(bend, (81, -6, 237), TO_X),
        *_knob((-69, 0, 220)),
    ]


def head() -> Look:
    """Grey post, wide black screen in a thin red frame, camera pod on top, and the eyes."""
    post = revolve([(41, -7), (41, 4), (37, 11), (30, 20), (27, 32)], 48)
    spine = loft([(20, 16, 30, 8), (60, 16, 44, 10), (170, 16, 44, 10), (190, 14, 36, 9)])
    back = plate([(y, z, 14) for y in (-114, 114) for z in (41, 183)], 24, "x", 4)
    rim = plate([(y, z, 13) for y in (-115, 115) for z in (40, 184)], 7, "x", 1.5)
    glass = plate([(y, z, 11) for y in (-112, 112) for z in (43, 181)], 8, "x", 1.5)
    pod = loft([(0, 22, 34, 12), (30, 22, 34, 12), (36, 19, 31, 10), (38, 15, 27, 9)])
    look: Look = [
        ("grey", post),
        ("grey", place(spine, (-12, 0, 0))),
        ("dark", place(back, (7, 0, 0))),
        ("red", place(rim, (21, 0, 0))),
        ("screen", place(glass, (23.5, 0, 0))),
        ("grey", place(pod, (6, 0, 197))),
        ("orange", place(revolve([(22, 0), (24, 1), (24, 5), (22, 6)], 32), (6, 0, 234))),
        ("black", place(cylinder(11, 6, 1.5, 32), (27, 0, 216), TO_X)),
        ("lens", place(cylinder(5, 8, 1.5, 24), (27.5, 0, 216), TO_X)),
    ]
    for side in (-1, 1):
        white = plate([(side * 48, 104, 27), (side * 48, 118, 27)], 1.2, "x", 0.3)
        pupil = plate([(side * 45, 103, 15), (side * 45, 107, 15)], 1.0, "x", 0.3)
        spark = plate([(side * 45 + 5, 112, 4)], 0.8, "x", 0.2)
        brow = plate([(side * 32, 159, 3.2), (side * 64, 160, 3.2)], 1.2, "x", 0.3)
        look += [
            ("eye", place(white, (27.8, 0, 0))),
            ("screen", place(pupil, (28.6, 0, 0))),
            ("eye", place(spark, (29.1, 0, 0))),
            ("eye", place(brow, (27.8, 0, 0))),
        ]
    return look


def upper_shoulder() -> Look:
    """l1: from the shoulder sideways, then forward."""
    bend = Elbow(
        length_in=134,
        length_out=139.5,
        radius_in=68,
        radius_bend=62,
        radius_out=53.5,
        bend=8,
        fillet=18,
        cut=22,
    )
    return [_ring(68, 1), *_tube(bend, (0, 0, 142.5), (0, 0, pi))]


def upper_arm() -> Look:
    """l2: the long tube to the elbow."""
    bend = Elbow(
        length_in=250, length_out=41.5, radius_in=53, radius_bend=53, radius_out=53.5, bend=30
    )
    return [_ring(53.5, 1), *_tube(bend, (0, 0, 260), (0, 0, pi))]


def elbow() -> Look:
    """l3: sideways, then forward."""
    bend = Elbow(
        length_in=118,
        length_out=124.5,
        radius_in=53.5,
        radius_bend=50,
        radius_out=45,
        bend=7,
        fillet=16,
        cut=18,
    )
    return [_ring(53.5, -14), *_tube(bend, (0, 0, -126.5), (pi, 0, 0))]


def forearm() -> Look:
    """l4: the long tube to the wrist, with the second navigator."""
    bend = Elbow(
        length_in=265, length_out=30.5, radius_in=47, radius_bend=47, radius_out=47.5, bend=24
    )
    return [
        _ring(46.5, 1),
        *_tube(bend, (0, 0, 275), (0, 0, 0)),
        *_knob((-46, 0, 75)),
    ]


def wrist() -> Look:
    """l5: sideways, then towards the hand."""
    bend = Elbow(
        length_in=97,
        length_out=73,
        radius_in=47.5,
        radius_bend=46,
        radius_out=42,
        bend=6,
        fillet=12,
        cut=16,
    )
    return [_ring(47.5, 1), *_tube(bend, (0, 0, 105), (0, 0, pi))]


def cuff() -> Look:
    """l6: short barrel, camera box with lens and buttons, orange accent."""
    barrel = revolve([(39, -27), (42, -24), (42, 17), (41, 21), (40, 24)], 56)
    box = place(rounded_box((62, 56, 51), 11), (0, 40, -7.5))
    accent = revolve([(41, 9), (42.7, 9.6), (42.7, 13.4), (41, 14)], 56)
    look: Look = [
        _ring(41.5, -39, 12),
        ("dark", barrel),
        ("dark", box),
        ("orange", accent),
        ("black", place(cylinder(12, 5, 1.5, 32), (0, 52, 17.5))),
        ("lens", place(cylinder(6.5, 6, 2, 24), (0, 52, 18))),
    ]
    for x in (-16, 16):
        look.append(("grey", place(cylinder(7, 5, 1.5, 24), (x, 67.5, -4), TO_LEFT)))
    look.append(("orange", place(rounded_box((26, 4, 7), 1.9), (0, 67.5, -21))))
    return look


LOOKS = {
    "pedestal": pedestal,
    "arm_base": arm_base,
    "l0": shoulder,
    "head": head,
    "l1": upper_shoulder,
    "l2": upper_arm,
    "l3": elbow,
    "l4": forearm,
    "l5": wrist,
    "l6": cuff,
}
"""Link -> the function that makes its look."""
