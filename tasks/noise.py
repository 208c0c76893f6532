"""How far the world may differ from what the planner was told."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.errors import unknown_name

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Noise:
    """Uniform ranges that are drawn after planning; nothing but touch and distance shows them."""

    position: float = 0.0
    """[m] largest offset along x and along y."""
    yaw: float = 0.0
    """[rad] largest turn about the vertical."""
    friction: tuple[float, float] | None = None
    """Coefficient between hand and object; None keeps the object's own."""
    mass: tuple[float, float] = (1.0, 1.0)
    """Factor on the object's mass."""

    @property
    def draws_scene(self) -> bool:
        """Whether friction or mass are drawn, which happens when a scene is built."""
        return self.friction is not None or self.mass != (1.0, 1.0)


NOISES: dict[str, Noise] = {
    "none": Noise(),
    "paper": Noise(position=0.005),  # Li et al., section IV: less than 5 mm.
    "hard": Noise(position=0.01, yaw=np.radians(15), friction=(0.5, 1.0), mass=(0.8, 1.2)),
    "blind": Noise(position=0.02, yaw=np.radians(15), friction=(0.5, 1.0), mass=(0.8, 1.2)),
}


def resolve_noise(name: str) -> Noise:
    """The noise of that name.

    Raises:
        InputError: no noise has that name.
    """
    if name not in NOISES:
        raise unknown_name("noise", name, NOISES)
    return NOISES[name]


def draw_friction(noise: Noise, own: float, rng: np.random.RandomState) -> float:
    """Coefficient of friction between hand and object for one environment."""
    return own if noise.friction is None else float(rng.uniform(*noise.friction))


def draw_offsets(noise: Noise, draws: Array) -> Array:
    """(n, 3) [m, m, rad] x, y and yaw offsets from uniform draws (n, 3) in [-1, 1]."""
    return draws * np.array([noise.position, noise.position, noise.yaw])
