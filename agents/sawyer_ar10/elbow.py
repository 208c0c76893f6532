"""The Sawyer's typical part: a round tube that turns a corner whose outside is cut off flat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.agents.sawyer_ar10.shapes import Array, Soup, closed_skin, fan, skin

SECTORS = 56
SAMPLES = 60  # Along one line of the tube, before it is cut.
RINGS = 14  # On either side of the cut.


@dataclass(frozen=True, kw_only=True)
class Elbow:
    """A tube that comes up along +z, turns at the origin and leaves along +y.

    Lengths share one unit. The tube is round at both ends; before the corner it gives way on the
    inside, so that a short exit does not start within the tube's own wall.
    """

    length_in: float
    length_out: float
    radius_in: float
    radius_bend: float
    radius_out: float
    bend: float
    """Radius of the bent middle line."""
    fillet: float = 5.0
    """Smallest radius of the inner corner."""
    cut: float | None = None
    """Distance of the flat from the corner, towards (0, -1, 1); None leaves the corner round."""

    def _lines(self) -> Array:
        """(SECTORS, SAMPLES, 3) points along the tube, one line for every angle around it."""
        angles = np.linspace(0.0, 2.0 * np.pi, SECTORS, endpoint=False)[:, None]
        inward = np.cos(angles)
        bent = self.radius_bend * inward
        enter = np.where(
            bent > 0, inward * min(self.radius_bend, self.length_out - self.fillet), bent
        )
        leave = np.where(
            bent > 0, inward * min(self.radius_bend, self.length_in - self.fillet), bent
        )
        slack = self.bend - bent - self.fillet
        rounding = self.fillet + (slack + np.sqrt(slack**2 + self.fillet**2)) / 2.0
        rounding = np.minimum(rounding, np.minimum(self.length_out - enter, self.length_in - leave))
        t = np.linspace(0.0, 1.0, SAMPLES // 3)[None]
        ease = t * t * (3.0 - 2.0 * t)
        sides = np.sin(angles)

        width_in = self.radius_in + (self.radius_bend - self.radius_in) * ease
        y_in = inward * self.radius_in + (enter - inward * self.radius_in) * ease
        z_in = -self.length_in + (self.length_in - leave - rounding) * t
        into = np.stack([sides * width_in, y_in, z_in], axis=2)

        turn = t * np.pi / 2.0
        y_turn = enter + rounding * (1.0 - np.cos(turn))
        z_turn = -leave - rounding * (1.0 - np.sin(turn))
        around = np.stack([sides * self.radius_bend + 0.0 * turn, y_turn, z_turn], axis=2)

        width_out = self.radius_bend + (self.radius_out - self.radius_bend) * ease
        y_out = enter + rounding + (self.length_out - enter - rounding) * t
        z_out = -leave + (leave - inward * self.radius_out) * ease
        out = np.stack([sides * width_out, y_out, z_out], axis=2)
        return np.concatenate([into, around, out], axis=1)

    def _cuts(self, lines: Array) -> tuple[Array, Array]:
        """(SECTORS,) fractional sample at which each line meets the flat, and leaves it again.

        Both are the middle of the bend for lines that stay below the flat.
        """
        middle = np.full(SECTORS, (SAMPLES - 1) / 2.0)
        first, last = middle.copy(), middle.copy()
        if self.cut is None:
            return first, last
        above = (lines[:, :, 2] - lines[:, :, 1]) / np.sqrt(2.0) - self.cut
        for row in np.flatnonzero((above > 0).any(axis=1)):
            high = np.flatnonzero(above[row] > 0)
            low, top = high[0] - 1, high[-1]
            first[row] = low + above[row, low] / (above[row, low] - above[row, low + 1])
            last[row] = top + above[row, top] / (above[row, top] - above[row, top + 1])
        return first, last

    def parts(self) -> tuple[Soup, Soup]:
        """The tube, and the cap that covers its flat (no triangles when there is no cut)."""
        lines = self._lines()
        first, last = self._cuts(lines)
        before = _resample(lines, np.zeros(SECTORS), first)
        after = _resample(lines, last, np.full(SECTORS, SAMPLES - 1.0))
        soup = [skin(before[:, ::-1]), skin(after[:, ::-1])]
        soup += [fan(before[0]), fan(after[-1, ::-1])]
        if self.cut is None:
            return np.concatenate(soup), np.empty((0, 3, 3))
        inner_rows = np.flatnonzero(last > first)  # One more on either side closes the points.
        open_rows = np.arange(inner_rows[0] - 1, inner_rows[-1] + 2)
        loop = np.concatenate([after[0, open_rows], before[-1, open_rows[::-1]]])
        soup.append(fan(loop))
        return np.concatenate(soup), _cap(loop)


def _resample(lines: Array, start: Array, stop: Array) -> Array:
    """(RINGS, SECTORS, 3) points at even steps between two fractional samples of each line."""
    positions = start + np.linspace(0.0, 1.0, RINGS)[:, None] * (stop - start)
    low = np.minimum(positions.astype(int), SAMPLES - 2)
    share = (positions - low)[:, :, None]
    rows = np.arange(SECTORS)
    return (1.0 - share) * lines[rows, low] + share * lines[rows, low + 1]


def _cap(loop: Array) -> Soup:
    """Shallow lid with a broken edge on a flat loop that faces (0, -1, 1)."""
    normal = np.array([0.0, -1.0, 1.0]) / np.sqrt(2.0)
    centre = loop.mean(axis=0)
    size = np.linalg.norm(loop - centre, axis=1).mean()
    steps = ((0.0, -2.0), (0.0, 1.6), (0.5, 2.4), (1.6, 3.0), (4.0, 3.4))  # inset, height
    rings = [
        centre + (loop - centre) * (1.0 - inset / size) + height * normal for inset, height in steps
    ]
    return closed_skin(np.stack(rings))
