"""Faces that would overlap and hold each other instead, without friction: pressures where they touch, gaps elsewhere.

What a solver brings are the gaps of free faces, and those that a unit pressure at one place causes at all. Sought are
pressures p >= 0 with gaps g + A p >= 0, one of which is nothing at each place: a linear complementarity problem. All
places that are wrong change sides at once, which ends after a few steps as a rule (block principal pivoting: Judice and
Pires, Computers & Operations Research 21 (1994) 587). Where it does not, the one that is most wrong does, from the free
faces on, and the last one that is wrong once that goes round. The published rule, the last one alone, ends where every
principal minor of A is positive; compliances by collocation are nearly symmetric only, and there it may not.
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
#: steps in which all that is wrong changes, at most: a dozen is usual; and changes one by one, over the places; chosen
STEPS, EACH = 30, 3


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

    def held(closed: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Pressures (m,) that keep these places just closed, and how wrong each place is (m,), as a movement, mm."""
        new = np.flatnonzero(closed & ~asked)
        if len(new):
            compliance[:, new], asked[new] = by_pressure(new), True
        touch = np.flatnonzero(closed)
        pressure = np.zeros(m)
        pressure[touch] = la.solve(compliance[np.ix_(touch, touch)], -gap[touch])
        overlap = -(gap + compliance[:, touch] @ pressure[touch])
        pulled = -pressure * np.where(asked, np.abs(np.diag(compliance)), 0.0)
        return pressure, np.where(closed, pulled, np.where(overlap > ROUND_OFF * moves, overlap, 0.0))

    closed = np.zeros(m, dtype=bool)
    fewest, patience = m + 1, PATIENCE
    for _ in range(STEPS):
        pressure, off = held(closed)
        wrong = off > 0
        if not wrong.any():
            return pressure, closed
        if wrong.sum() < fewest:
            fewest, patience = int(wrong.sum()), PATIENCE
        elif not patience:
            break
        else:
            patience -= 1
        closed ^= wrong
    closed, seen, goes_round = np.zeros(m, dtype=bool), set(), False
    for _ in range(EACH * m):
        pressure, off = held(closed)
        if off.max() <= 0:
            return pressure, closed
        goes_round |= closed.tobytes() in seen
        seen.add(closed.tobytes())
        one = int(np.flatnonzero(off > 0)[-1] if goes_round else off.argmax())
        closed[one] = not closed[one]
    raise ContactError(f"cracks: no set of places where the faces touch was found in {EACH * m} trials")
