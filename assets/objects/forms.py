"""Things that many recipes share: labels, walls, bowls, grips, bristles, clips."""

from __future__ import annotations

import numpy as np

from maniskill_taskgrasp.assets.objects.geometry import MAX_GROWTH, few_corners
from maniskill_taskgrasp.assets.objects.lathe import lathe_mesh
from maniskill_taskgrasp.assets.objects.model import Part
from maniskill_taskgrasp.assets.objects.pieces import (
    SIDES,
    Piece,
    Point2,
    box,
    convex,
    rod,
    turned,
)

SKIN = 0.00012  # [m] by which a drawn label stands out of the surface below it.

STEEL, DARK_STEEL, BRASS = "#b8bcc4", "#6d737b", "#c9a24a"
BLACK, GREY, WHITE = "#26282c", "#8b8f96", "#f2f1ec"
WOOD, DARK_WOOD = "#c1935a", "#7c5230"
RED, BLUE, GREEN, YELLOW, ORANGE = "#c8352b", "#2c62ad", "#3f9150", "#efc52f", "#e5762a"


def band(radius: float, length: float, colour: str, flat: float = 1.0) -> Piece:
    """Drawn sleeve around a round or oval thing about x: a label, a ring, a stripe."""
    r = radius + SKIN
    return turned([(-length / 2, r), (length / 2, r)], colour, flat).seen_only()


def disc(radius: float, colour: str) -> Piece:
    """Drawn spot facing +x, centred on the surface it lies on."""
    return rod(radius, 2 * SKIN, colour).seen_only()


def patch(x: float, y: float, colour: str) -> Piece:
    """Drawn rectangle facing +z, centred on the surface it lies on."""
    return box(x, y, 2 * SKIN, colour).seen_only()


def ellipse(x: float, y: float, count: int = 24) -> list[Point2]:
    """Outline of an ellipse with extents x, y."""
    turns = np.arange(count) * 2 * np.pi / count
    return [(float(x / 2 * np.cos(t)), float(y / 2 * np.sin(t))) for t in turns]


def rounded(x: float, y: float, radius: float) -> list[Point2]:
    """Outline of a rectangle with extents x, y and round corners."""
    points = []
    for sx, sy, start in ((1, 1, 0), (-1, 1, 90), (-1, -1, 180), (1, -1, 270)):
        centre_x, centre_y = sx * (x / 2 - radius), sy * (y / 2 - radius)
        points += [
            (centre_x + radius * float(np.cos(t)), centre_y + radius * float(np.sin(t)))
            for t in np.radians(start + np.linspace(0, 90, 5))
        ]
    return points


def dome(x: float, y: float, z: float, colour: str, power: float = 2.0) -> Piece:
    """Half ellipsoid on the xy plane, its top at +z; a higher power makes it boxier."""
    points = []
    for lift in np.linspace(0, np.pi / 2, 9):
        for t in np.arange(32) * np.pi / 16:
            flat = np.cos(lift) ** (2 / power)
            points.append(
                (
                    x / 2 * flat * _spread(np.cos(t), power),
                    y / 2 * flat * _spread(np.sin(t), power),
                    z * np.sin(lift) ** (2 / power),
                )
            )
    return _few(convex(points, colour))


def egg(x: float, y: float, z: float, colour: str, power: float = 2.0) -> Piece:
    """Ellipsoid with those extents; a higher power makes it a pillow or a bar of soap."""
    points = []
    for lift in np.linspace(-np.pi / 2, np.pi / 2, 15):
        for t in np.arange(32) * np.pi / 16:
            flat = abs(np.cos(lift)) ** (2 / power)
            points.append(
                (
                    x / 2 * flat * _spread(np.cos(t), power),
                    y / 2 * flat * _spread(np.sin(t), power),
                    z / 2 * _spread(np.sin(lift), power),
                )
            )
    return _few(convex(points, colour))


def _spread(value: float, power: float) -> float:
    return float(np.sign(value) * abs(value) ** (2 / power))


def _few(piece: Piece) -> Piece:
    """The piece with a collision part of few corners."""
    part = Part("convex", vertices=few_corners(piece.vertices))
    return Piece(piece.vertices, piece.faces, piece.colour, (part,))


def open_box(x: float, y: float, z: float, wall: float, colour: str) -> list[Piece]:
    """Tray or box open towards +z: a floor and four walls."""
    floor = box(x, y, wall, colour).at(z=(wall - z) / 2)
    long = box(x, wall, z - wall, colour)
    short = box(wall, y - 2 * wall, z - wall, colour)
    return [
        floor,
        *(long.at(0, s * (y - wall) / 2, wall / 2) for s in (-1, 1)),
        *(short.at(s * (x - wall) / 2, 0, wall / 2) for s in (-1, 1)),
    ]


def shell(profile: list[Point2], wall: float, colour: str, wedges: int = 10) -> Piece:
    """Bowl or pot open towards +x.

    Args:
        profile: two or three (x, outer radius) from the floor up.
        wall: thickness [m] of floor and wall.
        wedges: straight blocks that stand for the wall in physics.
    """
    outer = np.array(profile, dtype=float)
    inner = np.stack([outer[:, 0], outer[:, 1] - wall], 1)
    inner[0, 0] += wall
    loop = np.concatenate([[(outer[0, 0], 0.0)], outer, inner[::-1], [(inner[0, 0], 0.0)]])
    vertices, faces = lathe_mesh(loop, SIDES)
    step = 2 * np.pi / wedges
    keep = min(np.sqrt(step / np.sin(step)), MAX_GROWTH)
    floor = turned([(outer[0, 0], outer[0, 1]), (inner[0, 0], inner[0, 1])], colour)
    parts = list(floor.parts)
    for low in range(len(outer) - 1):
        for i in range(wedges):
            corners = [
                (x, r * keep * np.cos(t), r * keep * np.sin(t))
                for line in (outer, inner)
                for x, r in line[low : low + 2]
                for t in (i * step, (i + 1) * step)
            ]
            parts.append(Part("convex", vertices=np.array(corners)))
    return Piece(vertices, faces, colour, tuple(parts))


def brush_head(x: float, y: float, z: float, back: str, bristles: str) -> list[Piece]:
    """Flat brush head in the xy plane, bristles towards +z, `z` over all."""
    body = convex(
        [(px, py, pz) for px, py in rounded(x, y, min(x, y) * 0.4) for pz in (-z / 2, -z * 0.15)],
        back,
    )
    tuft = box(x * 0.88, y * 0.86, z * 0.65, bristles).at(z=z * 0.175)
    return [body, tuft]


def dots(points: list[Point2], radius: float, colour: str) -> list[Piece]:
    """Drawn spots facing +z at (x, y)."""
    spot = disc(radius, colour).turn((0, 1, 0), -90)
    return [spot.at(x, y) for x, y in points]


def tube(
    path_radius: float, start: float, end: float, steps: int, shift: Point2
) -> list[tuple[float, float, float]]:
    """Points of an arc in the xy plane about `shift`, from angle `start` to `end` [degrees]."""
    return [
        (shift[0] + path_radius * float(np.cos(t)), shift[1] + path_radius * float(np.sin(t)), 0.0)
        for t in np.radians(np.linspace(start, end, steps + 1))
    ]


def brush_grip(a: float, b: float, c: float, colour: str) -> Piece:
    """Round handle along x from 0 to a, thickest at its end, b x c across."""
    r = b / 2
    return turned([(0, r * 0.8), (0.006, r), (a * 0.3, r), (a, r * 0.75)], colour, c / b)
