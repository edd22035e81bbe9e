"""A contour of a sum of Gaussian kernels, followed step by step: for bends that samples of the function do not see."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: largest angle, rad, by which the contour turns in one step, and how far the step may be from its length; chosen
TURN, LONGER = 0.15, 1.5
#: shortest step: beyond, it is a corner; chosen
SHORTEST = 1e-5
#: steps of Newton's method onto the contour, at most, and where they end; round-off
NEWTON, REACHED = 30, 1e-13
#: points, at most; chosen
MOST = 1_000_000


class CornerError(ValueError):
    """A contour bends too sharply to be followed.

    Attributes
    ----------
    at : ndarray (2,)
        Where.
    """

    at: Array = np.full(2, np.nan)


def followed(
    axis: Array, weights: Array, rate: float, threshold: float, start: Array, longest: float
) -> Array:
    """Points (k, 2) once round a contour from one of them (2,), what is high on their right.

    Parameters
    ----------
    axis : ndarray, shape (m,)
        Places of the kernels along x and along y; a kernel is exp(-rate d^2) of both distances.
    weights : ndarray, shape (m, m)
        Of the kernels, by y and x.
    rate, threshold : float
    start : ndarray, shape (2,)
    longest : float
        Between two points.

    Raises
    ------
    CornerError
        Where it bends too sharply.

    Examples
    --------
    The contour of one kernel is a circle.

    >>> one = followed(np.zeros(1), np.ones((1, 1)), 1.0, 0.5, np.array([np.sqrt(np.log(2)), 0.0]), 0.1)
    >>> bool(np.abs(np.hypot(*one.T) - np.sqrt(np.log(2))).max() < 1e-12), 51 < len(one) < 55
    (True, True)
    """
    points = np.empty((256, 2))
    state = np.array([start[0], start[1], longest])
    count = 0
    while True:
        added, ended = _follow(axis, weights, rate, threshold, state, start, longest, count, points)
        count += added
        if ended > 0:
            return points[:count].copy()
        if ended < 0 or count >= MOST:
            error = CornerError("the contour bends too sharply to be followed")
            error.at = state[:2].copy()
            raise error
        points = np.concatenate([points, np.empty_like(points)])


@njit(cache=True, error_model="numpy")
def _follow(axis, weights, rate, threshold, state, start, longest, count, points):
    """Fill points from a number on; how many, and 1 once it is round, -1 at a corner, 0 where no room is left."""
    added = 0
    x, y, step = state[0], state[1], state[2]
    _, fx, fy, fxx, fyy, fxy = _local(axis, weights, rate, x, y)
    while count + added < len(points):
        near = math.hypot(x - start[0], y - start[1]) <= 0.75 * step
        if count + added >= 4 and near:
            return added, 1
        points[count + added, 0], points[count + added, 1] = x, y
        added += 1
        size = math.hypot(fx, fy)
        ex, ey = -fy / size, fx / size
        bend = abs(fxx * fy * fy - 2 * fxy * fx * fy + fyy * fx * fx) / size**3
        step = min(longest, 2 * step)
        if step * bend > TURN:
            step = TURN / bend
        while True:
            _, gx, gy, _, _, _ = _local(axis, weights, rate, x + 0.5 * step * ex, y + 0.5 * step * ey)
            size = math.hypot(gx, gy)
            u, v = x - step * gy / size, y + step * gx / size
            for _ in range(NEWTON):
                f, gx, gy, gxx, gyy, gxy = _local(axis, weights, rate, u, v)
                share = (f - threshold) / (gx * gx + gy * gy)
                u -= share * gx
                v -= share * gy
                if max(abs(share * gx), abs(share * gy)) < REACHED:
                    break
            size = math.hypot(gx, gy)
            cosine = (-gy * ex + gx * ey) / size
            ahead = (u - x) * ex + (v - y) * ey
            if cosine >= math.cos(TURN) and ahead > 0 and math.hypot(u - x, v - y) < LONGER * step:
                break
            step *= 0.5
            if not step > SHORTEST:
                state[0], state[1], state[2] = x, y, step
                return added, -1
        x, y, fx, fy, fxx, fyy, fxy = u, v, gx, gy, gxx, gyy, gxy
        state[0], state[1], state[2] = x, y, step
    return added, 0


@njit(cache=True, error_model="numpy")
def _local(axis, weights, rate, x, y):
    """The function, its slopes along x and y, and its second derivatives by xx, yy and xy."""
    m = len(axis)
    f = fx = fy = fxx = fyy = fxy = 0.0
    for i in range(m):
        d = y - axis[i]
        row = row_x = row_xx = 0.0
        for j in range(m):
            e = x - axis[j]
            w = weights[i, j] * math.exp(-rate * e * e)
            row += w
            row_x += -2 * rate * e * w
            row_xx += (4 * rate * rate * e * e - 2 * rate) * w
        value = math.exp(-rate * d * d)
        slope, second = -2 * rate * d * value, (4 * rate * rate * d * d - 2 * rate) * value
        f += value * row
        fx += value * row_x
        fy += slope * row
        fxx += value * row_xx
        fyy += second * row
        fxy += slope * row_x
    return f, fx, fy, fxx, fyy, fxy
