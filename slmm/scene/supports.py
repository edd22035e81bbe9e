"""Where supports leave stresses without bound: what holds the two sides of a point of the surface differs there."""

from __future__ import annotations

import numpy as np

from slmm.part.outline import SMALLEST_TURN
from slmm.scene.loading import Loading

#: whether u_x and u_y are prescribed
Held = tuple[bool, bool]


def held_at(loading: Loading, point: tuple[float, float]) -> Held:
    """What a loading prescribes at a point of the surface, mm."""
    acting = [condition.is_held for condition in loading if condition.on(np.array([point]))[0]]
    return any(x for x, _ in acting), any(y for _, y in acting)


def is_singular(one: Held, other: Held, turn: float) -> bool:
    """Whether stresses grow without bound between two sides by what is held on them.

    Parameters
    ----------
    one, other : (bool, bool)
        Whether u_x and u_y are prescribed before and behind the point.
    turn : float
        By which the surface turns there, rad, positive where it juts out. A roller is a mirror at a right angle: what
        it meets there goes straight on.

    Examples
    --------
    >>> clamped, roller, free = (True, True), (False, True), (False, False)
    >>> is_singular(clamped, free, np.pi / 2), is_singular(roller, free, np.pi / 2), is_singular(roller, free, 0.0)
    (True, False, True)
    """
    square = abs(turn - 0.5 * np.pi) < SMALLEST_TURN
    return one != other and not (square and 1 in (sum(one), sum(other)))
