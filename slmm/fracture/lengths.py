"""How long the increments of cracks are: fixed, or as the path and what lies ahead allow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slmm.part.part import Part

Array = NDArray[np.float64]

#: first increments of "auto" over the shorter side of the part: 2 mm of 80 mm; published (Paper D, section 3.1)
PER_SIDE = 0.025
#: an increment may leave the tangent of a bent path by so much, over that length: 0.025 mm of 2 mm; chosen: past a hole
#: a path then is within 0.1 mm of 80, as far as paths are measured
OFF_PATH = 0.0125
#: longest and shortest increment over it; chosen
LONGEST, SHORTEST = 8.0, 0.1
#: on straight stretches each increment is so many times as long as the one before, at most; chosen
GROWTH = 2.0
#: an increment is no longer than this share of the distance from other surfaces, unless that length is; chosen
OF_ROOM = 0.5


@dataclass(frozen=True)
class Lengths:
    """Of increments, mm.

    Parameters
    ----------
    growth, first, ahead : float
        While cracks grow, at their start, and how far ahead they look.
    by_path : bool
        Whether ``growth`` is where they begin, and the path decides.
    """

    growth: float
    first: float
    ahead: float
    by_path: bool = False

    def along(
        self, line: Array, grown: bool, direction: Array, turned: float, room: float, rising: bool
    ) -> float:
        """Length of a tip's increment as its path asks, mm.

        Along a path of curvature k an increment h leaves its tangent by k h^2/2. Over the length of the last increment,
        k shows as the kink at its end, or as what the criterion's direction has turned since its start.

        Parameters
        ----------
        line : ndarray, shape (n, 2)
            What leads to the tip, mm, the tip last.
        grown : bool
            Whether its last segment is an increment; the kink of an initial crack is not its curvature.
        direction : ndarray, shape (2,)
            By the criterion.
        turned : float
            Angle to it from the criterion's direction at the tip before, radians.
        room : float
            Distance of the tip from surfaces and other cracks, mm.
        rising : bool
            Whether the tip needs more load than ever before: the curve F(u) then follows its length.

        Examples
        --------
        >>> lengths = Lengths(2.0, 2.0, 0.75, by_path=True)
        >>> line = np.array([[0.0, 0.0], [2.0, 0.0]])
        >>> for kink in (0.0, 0.1, 0.2, 1.0):
        ...     direction = np.array([math.cos(kink), math.sin(kink)])
        ...     print(round(lengths.along(line, True, direction, 0.0, 40.0, False), 2))
        4.0
        1.0
        0.71
        0.32
        """
        before = line[-1] - line[-2]
        last = float(np.linalg.norm(before)) if grown else self.growth
        longest = self.growth if rising else min(LONGEST * self.growth, max(self.growth, OF_ROOM * room))
        kink = math.atan2(before[0] * direction[1] - before[1] * direction[0], float(before @ direction))
        kink = max(abs(kink), abs(turned))
        bent = math.sqrt(2 * OFF_PATH * self.growth * last / kink) if kink else math.inf
        return max(min(bent, GROWTH * last, longest, room), SHORTEST * self.growth)


def lengths_of(part: Part, increment: float | str, first_length: float | None, look_ahead: float) -> Lengths:
    """Increments as they were asked for.

    Parameters
    ----------
    part : Part
    increment : float or "auto"
        mm.
    first_length : float, optional
        Of a crack that starts, mm.
    look_ahead : float
        Over the increment.

    Raises
    ------
    ValueError
        For a length that the part does not take.
    """
    width, height = (part.box[1] - part.box[0]).tolist()
    side = min(width, height)
    if isinstance(increment, str) and increment != "auto":
        raise ValueError(f"increment = {increment!r}: must be a length in mm or 'auto'")
    growth = PER_SIDE * side if isinstance(increment, str) else increment
    first = growth if first_length is None else first_length
    for name, length in (("increment", growth), ("first_length", first)):
        if not (math.isfinite(length) and 10 * part.tolerance < length < side):
            raise ValueError(
                f"{name} = {length!r}: must lie between {10 * part.tolerance:.3g} and {side:.6g} mm, the part's side"
            )
    return Lengths(growth, first, look_ahead * growth, isinstance(increment, str))
