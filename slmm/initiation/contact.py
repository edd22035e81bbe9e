"""Crack faces that meet: a crack that grows into compression stays closed there and releases nothing more.

Faces cannot penetrate one another. Where the stress along a path turns from tension to compression, a longer crack
opens only as far as the stress intensity at its tip stays positive; the energy released remains that of this length.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

#: share of the crack length at which the opening tells whether the tip is open; chosen
NEAR_TIP = 0.9


def tip_opening(moments: np.ndarray) -> np.ndarray:
    """Opening near the tip (...,), up to a positive factor, from its work (..., k) on Legendre tractions.

    Examples
    --------
    A parabola that is open all the way, 1 - x^2 = 2/3 (P_0 - P_2):

    >>> bool(tip_opening(np.array([4 / 3, 0.0, -4 / 15])) > 0)
    True
    """
    orders = np.arange(moments.shape[-1])
    values = legendre.legvander(np.array([2 * NEAR_TIP - 1]), len(orders) - 1)[0]
    return moments @ (values * (2 * orders + 1))


def until_closed(energy: np.ndarray, opening: np.ndarray) -> np.ndarray:
    """Energy (..., n) released by cracks of ascending lengths, constant from where the tip closes.

    Parameters
    ----------
    energy : ndarray (..., n)
        Released by faces that could penetrate one another.
    opening : ndarray (..., n)
        Of the faces near the tip; its sign counts.

    Examples
    --------
    >>> until_closed(np.array([1.0, 2.0, 2.1, 3.0]), np.array([1.0, 1.0, -1.0, -1.0]))
    array([1., 2., 2., 2.])
    """
    open_so_far = np.logical_and.accumulate(opening > 0, axis=-1)
    return np.maximum.accumulate(np.where(open_so_far, np.maximum(energy, 0.0), 0.0), axis=-1)
