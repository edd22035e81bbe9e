"""The faces of cracks: how far they open, where they would overlap, and what holds them closed there."""

from __future__ import annotations

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

from slmm.boundary.rules import Array, Complex

#: overlaps below this share of the largest jump are round-off, and closed places are sought so many times at most
#: (both chosen)
ROUND_OFF, MOST_TRIES = 1e-9, 50


class FacesError(ValueError):
    """No set of closed places leaves all others open."""


def opening_of(jump: Complex, direction: Complex) -> Array:
    """Opening (m,) of jumps (m,) on lines along directions (m,), negative where faces overlap."""
    return (jump * direction.conj()).imag


def overlap(jump: Array, direction: Complex) -> bool:
    """Whether faces with jumps (2 m,), real and imaginary parts in turn, overlap anywhere."""
    opening = opening_of(jump[::2] + 1j * jump[1::2], direction)
    return bool(opening.min() < -ROUND_OFF * np.abs(jump).max(initial=1e-300))


def held_closed(S: Array, load: Array, direction: Complex) -> tuple[Array, NDArray[np.bool_]]:
    """Jumps (2 m,) that nowhere overlap, and where faces touch (m,), without friction.

    Parameters
    ----------
    S : ndarray, shape (2 m, 2 m)
        From jumps to the resultant force along the cracks, which is i times the traction.
    load : ndarray, shape (2 m,)
        What jumps must cause where faces are free.
    direction : ndarray, shape (m,)
        Along the cracks.

    Raises
    ------
    FacesError
        When the search for the places that touch does not end.
    """
    m = len(direction)
    turn = np.zeros((m, 2, m, 2))
    k = np.arange(m)
    turn[k, 0, k, 0] = turn[k, 1, k, 1] = direction.real
    turn[k, 0, k, 1], turn[k, 1, k, 0] = direction.imag, -direction.imag
    # along the crack, and across
    Q = turn.reshape(2 * m, 2 * m)
    local, acts = Q @ S @ Q.T, Q @ load
    # forces along a crack are normal tractions, jumps across it are openings
    along, across = np.arange(0, 2 * m, 2), np.arange(1, 2 * m, 2)
    lu = la.lu_factor(local, overwrite_a=True, check_finite=False)
    unheld = la.lu_solve(lu, acts, check_finite=False)
    #: jumps by a unit force on each place that has ever touched
    by_force, asked = np.empty((2 * m, m)), np.zeros(m, dtype=bool)
    closed = np.zeros(m, dtype=bool)
    for _ in range(MOST_TRIES):
        new = np.flatnonzero(closed & ~asked)
        unit = np.zeros((2 * m, len(new)))
        unit[along[new], np.arange(len(new))] = 1.0
        by_force[:, new] = la.lu_solve(lu, unit, overwrite_b=True, check_finite=False)
        asked[new] = True
        touch = np.flatnonzero(closed)
        force = la.solve(by_force[np.ix_(across[touch], touch)], -unheld[across[touch]])
        jump = unheld + by_force[:, touch] @ force
        jump[across[touch]] = 0.0
        tension = np.zeros(m)
        tension[touch] = force
        overlaps = jump[across] < -ROUND_OFF * np.abs(jump).max(initial=1e-300)
        now = (closed & (tension <= 0)) | overlaps
        if (now == closed).all():
            return Q.T @ jump, closed
        closed = now
    raise FacesError(f"cracks: no set of places where the faces touch was found in {MOST_TRIES} trials")
