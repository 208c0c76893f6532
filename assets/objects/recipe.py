"""How a catalogue object is described: one function of the data set's dimensions, and its facts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from maniskill_taskgrasp.assets.objects import catalogue
from maniskill_taskgrasp.assets.objects.pieces import Piece

Size = tuple[float, float, float]
Maker = Callable[[float, float, float], list[Piece]]

FRICTION = {
    "rubber": 0.9,
    "foam": 0.9,
    "fabric": 0.8,
    "soap": 0.5,
    "paper": 0.7,
    "wood": 0.7,
    "plastic": 0.7,
    "metal": 0.6,
    "glass": 0.6,
    "ceramic": 0.6,
    "wax": 0.6,
    "food": 0.7,
}
"""Coefficient against a rubber-covered finger by material: plausible values, not measured."""


@dataclass(frozen=True)
class Recipe:
    """A catalogue object before it is compiled. Design frame: +x up when it stands, +z its face."""

    name: str
    maker: Maker
    category: str
    material: str
    length: float | None = None
    """[m] true a where the data set's is capped at 0.15; None keeps what the data set says."""
    width: float | None = None
    """[m] true b where the data set's is capped too."""
    shown: str = ""
    """Resting pose in which it is best recognised, where the rule of render.py picks another."""


RECIPES: dict[str, Recipe] = {}


def item(
    name: str,
    category: str,
    material: str,
    length: float | None = None,
    width: float | None = None,
    shown: str = "",
) -> Callable[[Maker], Maker]:
    """Register a maker of (a, b, c) [m] as the recipe of one object; twice raises."""

    def register(maker: Maker) -> Maker:
        if name in RECIPES:
            raise ValueError(f"object {name!r} has two recipes")
        if material not in FRICTION:
            raise ValueError(f"object {name!r} has unknown material {material!r}")
        RECIPES[name] = Recipe(name, maker, category, material, length, width, shown)
        return maker

    return register


@cache
def load_recipes() -> dict[str, Recipe]:
    """All recipes by name, sorted; importing the chapters of the catalogue registers them."""
    for chapter in iter_modules(catalogue.__path__):
        import_module(f"{catalogue.__name__}.{chapter.name}")
    return dict(sorted(RECIPES.items()))
