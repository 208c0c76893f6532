"""Hand tools."""

from __future__ import annotations

from maniskill_taskgrasp.assets.objects.pieces import Piece, box, rod, turned
from maniskill_taskgrasp.assets.objects.recipe import item

STEEL = "#b8bcc4"
WOOD = "#b98a55"


@item("screwdriver", "tools", "plastic", length=0.21)
def screwdriver(a: float, b: float, c: float) -> list[Piece]:
    r, grip = b / 2, 0.1
    handle = turned(
        [
            (0, r * 0.7),
            (0.004, r * 0.92),
            (0.012, r),
            (0.06, r * 0.95),
            (0.075, r * 0.72),
            (0.085, r * 0.72),
            (0.095, r * 0.85),
            (grip, r * 0.6),
        ],
        "#d9372b",
    )
    return [handle, rod(r * 0.18, a - grip, STEEL).at((a + grip) / 2)]


@item("hammer", "tools", "wood", length=0.28)
def hammer(a: float, b: float, c: float) -> list[Piece]:
    handle = box(a, b, c, WOOD, 0.003).held()
    head = box(0.026, 0.06, 0.026, "#5a5f66", 0.003).at(a / 2 - 0.014, 0.005)
    face = rod(0.014, 0.03, STEEL).along((0, 1, 0)).at(a / 2 - 0.014, -0.04)
    return [handle, head, face]
