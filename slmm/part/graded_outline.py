"""Outlines that bend more sharply somewhere than even pieces can tell: their pieces are short there."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slmm.mechanics.cubics import Cubics, closed_through
from slmm.part.outline import Outline, read_only
from slmm.part.outline_splines import (
    MIN_PIECES,
    TURN_PER_PIECE,
    arc_lengths,
    chord_lengths,
)

Array = NDArray[np.float64]

#: places within a piece of a curve at which it is asked how sharply it bends; chosen
WITHIN = 8


def graded_outline(points: ArrayLike) -> Outline:
    """Outline through points (n, 2), mm, counter-clockwise and dense where it bends, however sharply that is.

    Examples
    --------
    >>> from slmm.part.shapes import ellipse
    >>> slit = graded_outline(ellipse((0, 0), (20.0, 0.2)))
    >>> round(float(1 / slit.curvatures(0.0)), 5), round(-(0.2**2) / 20, 5)
    (-0.002, -0.002)
    """
    given = np.asarray(points, dtype=float)
    curve = closed_through(chord_lengths(given), given)
    dense: Array = curve(_parameters(curve))
    parameter = chord_lengths(dense)
    for _ in range(3):  # from the chord lengths to the arc lengths
        curve = closed_through(parameter, dense)
        parameter = np.concatenate([[0.0], np.cumsum(arc_lengths(curve))])
    return Outline(read_only(curve.breaks), read_only(curve.coefficients))


def _parameters(curve: Cubics) -> Array:
    """Parameters (m,) of a closed curve between which it turns little, and that are nowhere far from each other."""
    piece = np.diff(curve.breaks)
    at = (curve.breaks[:-1, None] + piece[:, None] * np.arange(WITHIN) / WITHIN).ravel()
    step = np.repeat(piece / WITHIN, WITHIN)
    slope, bend = curve(at, 1), curve(at, 2)
    speed = np.linalg.norm(slope, axis=1)
    turning = np.abs(slope[:, 0] * bend[:, 1] - slope[:, 1] * bend[:, 0]) / speed**2
    needed = np.maximum(turning / TURN_PER_PIECE, MIN_PIECES * speed / (speed @ step)) * step
    so_far = np.concatenate([[0.0], np.cumsum(needed)])
    count = int(np.ceil(so_far[-1]))
    return np.interp(so_far[-1] * np.arange(count) / count, so_far, np.append(at, curve.breaks[-1]))
