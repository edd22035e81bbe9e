"""Crack faces that meet: a crack that grows into compression stays closed there and releases nothing more.

Faces cannot penetrate one another. Where the stress along a path turns from tension to compression, a longer crack
opens only as far as the stress intensity at its tip stays positive; the energy released remains that of this length.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

#: share of the crack length at which the opening tells whether the tip is open; chosen
NEAR_TIP = 0.9
#: a mode I share of a closed crack that counts as none; round-off
CLOSED = 1e-6


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


def closes_at(lengths: np.ndarray, K: np.ndarray) -> np.ndarray:
    """Length (k,) from which on cracks along a path close at their tips, infinite where they never do, mm.

    Parameters
    ----------
    lengths : ndarray (k, n)
        Ascending, mm.
    K : ndarray (k, n, 2)
        Modes I and II of faces that could penetrate one another.

    Examples
    --------
    >>> K = np.array([[[1.0, 0.0], [-1.0, 0.5], [-2.0, 0.5]], [[3.0, 0.0], [2.0, 0.0], [1.0, 0.0]]])
    >>> closes_at(np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]]), K)
    array([1.5, inf])
    """
    shut = K[..., 0] < -CLOSED * np.abs(K).max(axis=(-2, -1))[:, None]
    row, after = np.arange(len(K)), shut.argmax(axis=1)
    before = np.maximum(after - 1, 0)
    one, other = K[row, before, 0], K[row, after, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip(one / (one - other), 0.0, 1.0)
    at = lengths[row, before] + share * (lengths[row, after] - lengths[row, before])
    return np.where(shut.any(axis=1), np.where(after == 0, 0.0, at), np.inf)


def held(a: np.ndarray, G_inc: np.ndarray, closed: np.ndarray) -> np.ndarray:
    """G_inc (k, n) at ascending lengths a (k, n) whose energy is constant from lengths ``closed`` (k,) on.

    Examples
    --------
    >>> held(np.array([[0.0, 1.0, 2.0]]), np.array([[0.0, 1.0, 2.0]]), np.array([1.0]))
    array([[0. , 1. , 0.5]])
    """
    result = G_inc.copy()
    for i in np.flatnonzero(closed < a[:, -1]):
        energy = closed[i] * np.interp(closed[i], a[i], G_inc[i])
        later = a[i] > closed[i]
        result[i, later] = energy / a[i, later]
        if closed[i] == 0:
            result[i] = 0.0
    return result
