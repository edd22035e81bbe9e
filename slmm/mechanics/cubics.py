"""Curves of cubic pieces, and splines through points.

`scipy.interpolate` has the same, but brings special functions, optimisation and spatial search along: 23 MB and a sixth
of a second of every process that reads a scene.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_banded

Array = NDArray[np.float64]


class Cubics(NamedTuple):
    """A curve of cubic pieces; the first and the last one go on beyond its ends.

    Attributes
    ----------
    breaks : ndarray (m + 1,)
        Ascending parameters where the pieces begin, and where the last one ends.
    coefficients : ndarray (4, m, ...)
        Of the powers of the parameter beyond each piece's beginning, highest first.

    Examples
    --------
    >>> x = np.array([0.0, 1.0, 3.0, 4.0])
    >>> cubic = through(x, x**3)
    >>> float(cubic(2.0).round(12)), cubic([2.0, 5.0], 1).round(12).tolist()
    (8.0, [12.0, 75.0])
    """

    breaks: Array
    coefficients: Array

    def __call__(self, s: ArrayLike, order: int = 0) -> Array:
        """Its values at the parameters s, or derivatives of an order up to the second; the shape of s comes first."""
        return self.derivatives(s, order)[0]

    def derivatives(self, s: ArrayLike, *orders: int) -> list[Array]:
        """The same, one array for each of some orders from 0 to 2."""
        s = np.asarray(s, dtype=float)
        piece = self.breaks[1:-1].searchsorted(s, side="right")
        t = (s - self.breaks[piece]).reshape(s.shape + (1,) * (self.coefficients.ndim - 2))
        a, b, c, d = self.coefficients.take(piece, axis=1)
        found = []
        for order in orders:
            if order == 0:
                found.append(((a * t + b) * t + c) * t + d)
            elif order == 1:
                found.append((3 * a * t + 2 * b) * t + c)
            else:
                found.append(6 * a * t + 2 * b)
        return found


def through(x: Array, y: Array) -> Cubics:
    """Curve through values (n, ...) at ascending parameters (n,), twice continuously differentiable.

    Its third derivative does not jump at the second and the last but one of them (C. de Boor, A Practical Guide to
    Splines, 2001, chapter IV); through three values it is a parabola, through two a straight line.

    Examples
    --------
    >>> through(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 4.0]))([3.0, 4.0]).round(12).tolist()
    [9.0, 16.0]
    """
    h, chord = _chords(x, values := y.reshape(len(y), -1))
    if len(x) == 2:
        slopes = np.concatenate([chord, chord])
    elif len(x) == 3:
        middle = (h[1] * chord[0] + h[0] * chord[1]) / (h[0] + h[1])
        slopes = np.array([2 * chord[0] - middle, middle, 2 * chord[1] - middle])
    else:
        bands, right = np.zeros((3, len(x))), np.empty_like(values)
        bands[0, 2:], bands[1, 1:-1], bands[2, :-2] = h[:-1], 2 * (h[:-1] + h[1:]), h[1:]
        right[1:-1] = 3 * (h[1:, None] * chord[:-1] + h[:-1, None] * chord[1:])
        first, last = h[0] + h[1], h[-1] + h[-2]
        bands[1, 0], bands[0, 1] = h[1], first
        right[0] = ((h[0] + 2 * first) * h[1] * chord[0] + h[0] ** 2 * chord[1]) / first
        bands[1, -1], bands[2, -2] = h[-2], last
        right[-1] = ((h[-1] + 2 * last) * h[-2] * chord[-1] + h[-1] ** 2 * chord[-2]) / last
        slopes = solve_banded((1, 1), bands, right)
    return _with_slopes(x, y, slopes)


def closed_through(x: Array, y: Array) -> Cubics:
    """The same through values (n, ...) at parameters (n + 1,), n >= 3: at the last one it begins anew, as smoothly.

    Examples
    --------
    >>> around = np.linspace(0.0, 2 * np.pi, 101)
    >>> wave = closed_through(around, np.sin(around[:-1]))
    >>> bool(abs(wave(0.5) - np.sin(0.5)) < 1e-7), bool(abs(wave(around[-1], 1) - 1) < 1e-6)
    (True, True)
    """
    y = np.concatenate([y, y[:1]])
    h, chord = _chords(x, y.reshape(len(y), -1))
    before = np.roll(h, 1)
    bands = np.array([np.roll(before, 1), 2 * (before + h), np.roll(h, -1)])
    right = 3 * (h[:, None] * np.roll(chord, 1, axis=0) + before[:, None] * chord)
    # The first row has h[0] in the last column, the last row h[-2] in the first one: the product of two vectors, taken
    # out of the bands and put back (Sherman and Morrison).
    ends = np.zeros(len(h))
    ends[0], ends[-1] = -bands[1, 0], h[-2]
    share = h[0] / ends[0]
    bands[1, 0] -= ends[0]
    bands[1, -1] -= ends[-1] * share
    found = solve_banded((1, 1), bands, np.column_stack([right, ends]))
    without, by_ends = found[:, :-1], found[:, -1]
    slopes = without - np.outer(
        by_ends, (without[0] + share * without[-1]) / (1 + by_ends[0] + share * by_ends[-1])
    )
    return _with_slopes(x, y, np.concatenate([slopes, slopes[:1]]))


def _chords(x: Array, values: Array) -> tuple[Array, Array]:
    """Steps (n - 1,) of the parameter, and slopes (n - 1, k) of the chords between values (n, k)."""
    h = np.diff(x)
    return h, np.diff(values, axis=0) / h[:, None]


def _with_slopes(x: Array, y: Array, slopes: Array) -> Cubics:
    """The curve through values (n, ...), with slopes (n, k) there."""
    h, chord = _chords(x, values := y.reshape(len(y), -1))
    h = h[:, None]
    bend = (slopes[:-1] + slopes[1:] - 2 * chord) / h
    coefficients = np.array([bend / h, (chord - slopes[:-1]) / h - bend, slopes[:-1], values[:-1]])
    return Cubics(x, coefficients.reshape(4, len(h), *y.shape[1:]))
