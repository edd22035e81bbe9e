"""Smoothing of a traced contour or a stretch of it: as strong as the bends there allow.

The penalty on the third derivative acts as a low-pass filter that leaves parabolas alone; undulations shorter than a
wavelength are taken out. How long that may be follows from the radius of curvature (see `Edges` in `image`): it is
found by smoothing strongly first, and less where the outline turns out to bend more. All lengths are in pixels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import grey_erosion, maximum_filter1d
from scipy.sparse import diags_array, sparray
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]

#: weight of a point that the outline must pass through, and of straightness; chosen
HELD_WEIGHT, STRAIGHT_WEIGHT = 1e6, 1e7
#: rounds in which the wavelength follows the bends; chosen
ROUNDS = 5
#: bends by less than this over the curvature of a circle of the same length are the waves that remain; chosen
REMAINS = 1.4
#: by how much the wavelength may change along the contour, pixels per pixel; chosen
GRADING = 0.3
#: the sharpest bend that is followed; chosen
LEAST_RADIUS = 1.5


def smoothed(
    points: Array, weights: Array, straight: NDArray[np.bool_], wavelength: Array, step: float, closed: bool
) -> Array:
    """The points (n, 2) without their undulations.

    Parameters
    ----------
    points : (n, 2) array
        ``step`` apart.
    weights : (n,) array
        1 for a point of the contour, `HELD_WEIGHT` where the result must pass, 0 where nothing is known.
    straight : (n,) array of bool
        Where the result is a straight line.
    wavelength : (n,) array
        Undulations shorter than this go.
    step : float
    closed : bool
        Whether the first point follows the last one.
    """
    n = len(points)
    third, second = _differences(n, 3, closed), _differences(n, 2, closed)
    # a third difference stands for the middle of its four points, a second one for that of its three
    penalty = (0.5 * (np.roll(wavelength, -1) + np.roll(wavelength, -2)) / (2 * np.pi * step)) ** 6
    line = STRAIGHT_WEIGHT * (straight & np.roll(straight, -1) & np.roll(straight, -2))
    matrix = (
        diags_array(weights)
        + third.T @ diags_array(penalty[: third.shape[0]]) @ third
        + second.T @ diags_array(line[: second.shape[0]]) @ second
    )
    result: Array = splu(matrix.tocsc()).solve(weights[:, None] * points)
    return result


def _differences(n: int, order: int, closed: bool) -> sparray:
    row = np.array([1.0])
    for _ in range(order):
        row = np.convolve(row, [1.0, -1.0])
    row = row[::-1]
    bands = [np.full(n, value) for value in row]
    if not closed:
        return diags_array(
            [band[: n - order] for band in bands], offsets=list(range(order + 1)), shape=(n - order, n)
        )
    wrapped = [k - n for k in range(1, order + 1)]
    return diags_array([*bands, *bands[1:]], offsets=[*range(order + 1), *wrapped], shape=(n, n))


def wavelengths(
    points: Array,
    weights: Array,
    straight: NDArray[np.bool_],
    per_root: float,
    radius: float,
    step: float,
    closed: bool,
) -> Array:
    """Wavelengths (n,) below which undulations are noise.

    Parameters are those of `smoothed`, and

    per_root : float
        The wavelength over the root of the radius of curvature.
    radius : float
        Of a circle as long as the whole outline: what is straight is not smoothed more than that.
    """
    longest = per_root * np.sqrt(radius)
    wanted = np.full(len(points), longest)
    for _ in range(ROUNDS):
        bend = np.abs(curvatures(smoothed(points, weights, straight, wanted, step, closed), step, closed))
        reach = max(int(0.25 * wanted.min() / step), 1)
        largest = maximum_filter1d(bend, 2 * reach + 1, mode="wrap" if closed else "nearest")
        local = 1 / np.maximum(largest / REMAINS, 1e-12)
        next_one = np.minimum(wanted, per_root * np.sqrt(np.clip(local, LEAST_RADIUS, radius)))
        next_one = _graded(next_one, step, closed)
        if np.abs(next_one / wanted - 1).max() < 0.05:
            break
        wanted = next_one
    return wanted


def _graded(values: Array, step: float, closed: bool) -> Array:
    """The values, nowhere more than GRADING per pixel above their neighbours."""
    reach = int(np.ceil(np.ptp(values) / (GRADING * step)))
    if reach == 0:
        return values
    reach = min(reach, (len(values) - 1) // 2)
    slope = -GRADING * step * np.abs(np.arange(-reach, reach + 1))
    graded: Array = grey_erosion(
        values, footprint=np.ones(2 * reach + 1), structure=slope, mode="wrap" if closed else "nearest"
    )
    return graded


def curvatures(points: Array, step: float, closed: bool) -> Array:
    """Curvatures (n,) of points that are evenly spaced; those at open ends are their neighbours'."""
    before, behind = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    one, two = points - before, behind - points
    cross = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    length = np.hypot(*one.T) * np.hypot(*two.T) * np.hypot(*(behind - before).T)
    # of the circle through the three points
    bend = 2 * cross / np.maximum(length, 1e-12)
    if not closed:
        bend[0], bend[-1] = bend[1], bend[-2]
    return bend
