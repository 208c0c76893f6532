"""How sure a success rate is: Wilson's score interval."""

from __future__ import annotations

import math

Z_95 = 1.959963984540054  # Two-sided 95 % quantile of the standard normal.


def wilson_interval(successes: int, trials: int, z: float = Z_95) -> tuple[float, float]:
    """Bounds of a binomial rate (Wilson 1927); (0, 1) where nothing was tried.

    Raises:
        ValueError: more successes than trials, or a negative count.
    """
    if not 0 <= successes <= trials:
        raise ValueError(f"successes must lie in [0, {trials}], got {successes}")
    if trials == 0:
        return 0.0, 1.0
    rate = successes / trials
    centre = rate + z**2 / (2 * trials)
    margin = z * math.sqrt(rate * (1 - rate) / trials + z**2 / (4 * trials**2))
    scale = 1 + z**2 / trials
    # At a rate of 0 or 1 the exact bound is that rate; rounding would miss it by an ulp.
    lower = 0.0 if successes == 0 else (centre - margin) / scale
    upper = 1.0 if successes == trials else (centre + margin) / scale
    return lower, upper
