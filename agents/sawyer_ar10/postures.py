"""The AR10's preshape and closing for each of the 15 topologies.

Preshapes start from the coupled presets (fact sheet, section 4.3). Closings differ from the
authors': their thumb flexes to 1.5 rad and traps the object on its back; here pinch types stop it
where its end opposes the finger pads (fact sheet "grasping", section 1).
"""

from __future__ import annotations

from maniskill_taskgrasp.agents.hand import Posture

Pair = tuple[float, float]
STRAIGHT: Pair = (0.17, 0.17)
FOLDED: Pair = (1.57, 1.31)


def _posture(
    thumb: tuple[Pair, Pair],
    index: tuple[Pair, Pair] | Pair,
    middle: tuple[Pair, Pair] | Pair,
    ring: tuple[Pair, Pair] | Pair,
    little: tuple[Pair, Pair] | Pair,
    centre_mm: tuple[float, float, float],
    reason: str,
    *,
    tilt: float = 0.0,
    roll: float = 0.0,
    yaw: float = 0.0,
    feasible: bool = True,
) -> Posture:
    """Posture from (open, closed) pairs of (first, second) joint a digit; one pair holds still."""
    preshape: list[float] = []
    closing: list[float] = []
    for digit in (thumb, index, middle, ring, little):
        still = isinstance(digit[0], float)
        start, end = (digit, digit) if still else digit
        preshape += start  # type: ignore[arg-type]
        closing += end  # type: ignore[arg-type]
    return Posture(
        preshape=tuple(preshape),
        closing=tuple(closing),
        grasp_centre=tuple(value / 1000 for value in centre_mm),  # type: ignore[arg-type]
        tilt=tilt,
        roll=roll,
        yaw=yaw,
        feasible=feasible,
        reason=reason,
    )


PINCH_FINGER = ((0.35, 0.55), (1.57, 0.80))
PINCH_THUMB = ((1.33, 0.34), (1.33, 0.75))

POSTURES: dict[str, Posture] = {
    "power_palm_add_3_5": _posture(
        ((0.90, 0.50), (0.90, 1.50)),
        (0.23, 0.47),
        ((0.54, 0.77), (1.57, 1.57)),
        ((0.54, 0.80), (1.57, 1.57)),
        ((0.52, 0.84), (1.57, 1.57)),
        (-17, 47, 32),
        "middle, ring and little face the palm (gap 52 to 0 mm), the index stays out, extended",
        tilt=-0.1,
    ),
    "power_palm_abd_2_5": _posture(
        ((1.24, 0.34), (1.24, 1.50)),
        ((0.40, 0.80), (1.57, 1.57)),
        ((0.48, 0.81), (1.57, 1.57)),
        ((0.31, 0.85), (1.57, 1.57)),
        ((0.23, 0.77), (1.57, 1.57)),
        (-20, 32, 19),
        "four fingers face the palm (gap 56 to 0 mm), the thumb closes from in front",
        tilt=0.3,
    ),
    "power_palm_add_2_5": _posture(
        ((0.90, 0.40), (0.90, 1.50)),
        ((0.55, 0.77), (1.57, 1.57)),
        ((0.63, 0.77), (1.57, 1.57)),
        ((0.39, 0.81), (1.57, 1.57)),
        ((0.22, 0.90), (1.57, 1.57)),
        (-2, 31, 39),
        "four fingers face the palm (gap 52 to 0 mm), the thumb lies beside",
        tilt=0.3,
    ),
    "power_pad_abd_2": _posture(
        PINCH_THUMB,
        PINCH_FINGER,
        STRAIGHT,
        STRAIGHT,
        STRAIGHT,
        (-37, 46, 25),
        "the thumb's end meets the index pad (gap 93 to 0 mm)",
        tilt=-0.1,
    ),
    "power_pad_abd_2_3": _posture(
        PINCH_THUMB,
        PINCH_FINGER,
        PINCH_FINGER,
        FOLDED,
        FOLDED,
        (-26, 60, 27),
        "the thumb's end meets index and middle pads (gap 93 to 0 mm)",
        tilt=-0.1,
    ),
    "power_pad_abd_2_4": _posture(
        PINCH_THUMB,
        PINCH_FINGER,
        PINCH_FINGER,
        PINCH_FINGER,
        FOLDED,
        (-25, 50, 31),
        "the thumb's end meets index and middle pads (gap 93 to 0 mm), ring joins from the side",
        tilt=0.1,
    ),
    "intermediate_abd_2": _posture(
        ((0.85, 0.34), (0.85, 0.34)),
        ((0.73, 0.49), (1.20, 0.80)),
        ((0.74, 0.46), (1.57, 1.20)),
        FOLDED,
        FOLDED,
        (-27, 0, 70),
        "index and middle bend about parallel axes: no scissor motion (gap 4 to 3 mm)",
        tilt=0.64,
        roll=0.2,
        feasible=False,
    ),
    "intermediate_add_2": _posture(
        ((0.85, 0.34), (1.40, 0.60)),
        ((0.52, 1.04), (0.80, 1.20)),
        FOLDED,
        FOLDED,
        FOLDED,
        (-42, 32, 19),
        "the thumb's rotation presses a thing against the index finger's side (gap 48 to 12 mm)",
        tilt=0.5,
        roll=0.38,
    ),
    "intermediate_add_3": _posture(
        ((1.12, 0.34), (1.45, 0.75)),
        ((0.53, 1.20), (1.10, 1.40)),
        ((1.30, 1.31), (1.57, 1.31)),
        FOLDED,
        FOLDED,
        (-38, 44, 37),
        "thumb and index hold an upright rod against the middle finger (gap 23 to 0 mm)",
        tilt=0.44,
        roll=0.2,
        yaw=-1.35,
    ),
    "precision_pad_abd_2": _posture(
        PINCH_THUMB,
        PINCH_FINGER,
        STRAIGHT,
        STRAIGHT,
        STRAIGHT,
        (-36, 55, 25),
        "the thumb's end meets the index pad (gap 93 to 0 mm)",
    ),
    "precision_pad_abd_2_3": _posture(
        PINCH_THUMB,
        PINCH_FINGER,
        PINCH_FINGER,
        FOLDED,
        FOLDED,
        (-26, 56, 25),
        "the thumb's end meets index and middle pads (gap 93 to 0 mm)",
    ),
    "precision_pad_abd_2_4": _posture(
        PINCH_THUMB,
        PINCH_FINGER,
        PINCH_FINGER,
        PINCH_FINGER,
        FOLDED,
        (-20, 56, 19),
        "the thumb's end meets index and middle pads (gap 93 to 0 mm), ring joins from the side",
        tilt=-0.1,
    ),
    "precision_pad_abd_2_5": _posture(
        PINCH_THUMB,
        PINCH_FINGER,
        PINCH_FINGER,
        PINCH_FINGER,
        PINCH_FINGER,
        (-11, 58, 34),
        "the thumb's end meets index and middle pads (gap 93 to 0 mm), ring and little join",
    ),
    "precision_pad_add_2_5": _posture(
        ((1.40, 0.34), (1.40, 0.90)),
        ((0.60, 0.19), (1.57, 0.17)),
        ((0.60, 0.20), (1.57, 0.17)),
        ((0.60, 0.30), (1.57, 0.17)),
        ((0.60, 0.30), (1.57, 0.17)),
        (-8, 41, 21),
        "straight fingers flex at the knuckles towards the thumb (gap 91 to 19 mm)",
        tilt=-0.1,
    ),
    "precision_side_abd_3": _posture(
        ((1.10, 0.34), (1.45, 0.75)),
        ((0.24, 1.24), (0.90, 1.40)),
        ((1.30, 1.26), (1.57, 1.31)),
        FOLDED,
        FOLDED,
        (-32, 34, 13),
        "thumb and index hold an upright pen against the middle finger's side (gap 23 to 0 mm)",
        tilt=0.34,
        roll=-0.2,
    ),
}
