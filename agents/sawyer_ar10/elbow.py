"""The Sawyer's typical part: a round tube that turns a corner whose outside is cut off flat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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

    def _squeezed(self, inward: Array, room: float) -> Array:
        """Inward offsets of a tube at the bend, its inner half flattened to fit into `room`."""
        inner = min(self.radius_bend, room - self.fillet)
        return np.where(inward > 0, inner, self.radius_bend) * inward

    def _lines(self) -> Array:
        """(SECTORS, SAMPLES, 3) points along the tube, one line for every angle around it."""
        angles = np.linspace(0.0, 2.0 * np.pi, SECTORS, endpoint=False)[:, None]
        inward, sideways = np.cos(angles), np.sin(angles)
        y_before = self._squeezed(inward, self.length_out)
        z_after = -self._squeezed(inward, self.length_in)
        slack = self.bend - self.radius_bend * inward - self.fillet
        rounding = self.fillet + (slack + np.sqrt(slack**2 + self.fillet**2)) / 2.0
        rounding = np.minimum(rounding, self.length_out - y_before)
        rounding = np.minimum(rounding, self.length_in + z_after)

        t = np.linspace(0.0, 1.0, SAMPLES // 3)[None]
        ease = t * t * (3.0 - 2.0 * t)
        turn = t * np.pi / 2.0
        straight_in = (
            sideways * _mix(self.radius_in, self.radius_bend, ease),
            _mix(inward * self.radius_in, y_before, ease),
            _mix(-self.length_in, z_after - rounding, t),
        )
        around = (
            sideways * np.full_like(t, self.radius_bend),
            y_before + rounding * (1.0 - np.cos(turn)),
            z_after - rounding * (1.0 - np.sin(turn)),
        )
        straight_out = (
            sideways * _mix(self.radius_bend, self.radius_out, ease),
            _mix(y_before + rounding, self.length_out, t),
            _mix(z_after, -inward * self.radius_out, ease),
        )
        pieces = [np.stack(piece, axis=2) for piece in (straight_in, around, straight_out)]
        return np.concatenate(pieces, axis=1)

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
        above = np.flatnonzero(last > first)
        wider = np.arange(above[0] - 1, above[-1] + 2)  # Closes the points at both sides.
        soup.append(fan(_loop(before, after, wider)))
        return np.concatenate(soup), _cap(_loop(before, after, above))


def _mix(start: Array | float, stop: Array | float, share: Array) -> Array:
    """The value that lies at `share` of the way from `start` to `stop`."""
    return start + (stop - start) * share


def _resample(lines: Array, start: Array, stop: Array) -> Array:
    """(RINGS, SECTORS, 3) points at even steps between two fractional samples of each line."""
    positions = start + np.linspace(0.0, 1.0, RINGS)[:, None] * (stop - start)
    low = np.minimum(positions.astype(int), SAMPLES - 2)
    share = (positions - low)[:, :, None]
    rows = np.arange(SECTORS)
    return (1.0 - share) * lines[rows, low] + share * lines[rows, low + 1]


def _loop(before: Array, after: Array, rows: NDArray[np.int64]) -> Array:
    """(2 n, 3) points around the flat: where the given lines leave it, and where they meet it."""
    return np.concatenate([after[0, rows], before[-1, rows[::-1]]])


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
