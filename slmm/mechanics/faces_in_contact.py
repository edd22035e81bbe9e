"""Faces that would overlap and hold each other instead, without friction: pressures where they touch, gaps elsewhere.

What a solver brings are the gaps of free faces, and those that a unit pressure at one place causes at all. Sought are
pressures p >= 0 with gaps g + A p >= 0, one of which is nothing at each place: a linear complementarity problem. All
places that are wrong change sides at once, which ends after a few steps as a rule. Where it does not, the last of them
alone does, which ends after finitely many steps where every principal minor of A is positive, as of any compliance that
is symmetric (block principal pivoting: Judice and Pires, Computers & Operations Research 21 (1994) 587).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: overlaps below this share of the largest movement of faces are round-off; chosen
ROUND_OFF = 1e-9
#: changes of all that is wrong that may fail to make it less, before places change one by one; published
PATIENCE = 3
#: steps at most: a dozen is usual, and some compliances by collocation are of no kind that has an answer; chosen
STEPS = 50


class ContactError(ValueError):
    """No set of closed places leaves all others open."""


def closing_pressures(
    gap: Array, by_pressure: Callable[[NDArray[np.int64]], Array], moves: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Pressures (m,) that keep faces from overlapping, and where these touch (m,).

    Parameters
    ----------
    gap : ndarray, shape (m,)
        Between free faces, negative where they overlap.
    by_pressure : callable
        The gaps (m, k) that unit pressures at places (k,) cause; each place is asked once, if at all.
    moves : float
        How far faces move at most.

    Raises
    ------
    ContactError
        When the search does not end.

    Examples
    --------
    Three springs in a row, of which the first one is pushed in and drags the others along.

    >>> A = np.array([[1.0, 0.5, 0.2], [0.5, 1.0, 0.5], [0.2, 0.5, 1.0]])
    >>> pressure, closed = closing_pressures(np.array([-1.0, -0.4, 0.3]), lambda k: A[:, k], 1.0)
    >>> pressure.tolist(), closed.tolist()
    ([1.0, 0.0, 0.0], [True, False, False])
    """
    m = len(gap)
    compliance, asked = np.empty((m, m)), np.zeros(m, dtype=bool)
    closed = np.zeros(m, dtype=bool)
    pressure = np.zeros(m)
    fewest, patience = m + 1, PATIENCE
    for _ in range(STEPS):
        new = np.flatnonzero(closed & ~asked)
        if len(new):
            compliance[:, new], asked[new] = by_pressure(new), True
        touch = np.flatnonzero(closed)
        pressure[:] = 0.0
        pressure[touch] = la.solve(compliance[np.ix_(touch, touch)], -gap[touch])
        overlaps = ~closed & (gap + compliance[:, touch] @ pressure[touch] < -ROUND_OFF * moves)
        wrong = np.flatnonzero(overlaps | (closed & (pressure < 0)))
        if not len(wrong):
            return pressure, closed
        if len(wrong) < fewest:
            fewest, patience = len(wrong), PATIENCE
        elif patience:
            patience -= 1
        else:
            wrong = wrong[-1:]
        closed[wrong] = ~closed[wrong]
    raise ContactError(f"cracks: no set of places where the faces touch was found in {STEPS} trials")
