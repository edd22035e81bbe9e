"""Points on the simple hole shapes, dense enough for their smallest radius of curvature."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: points per full turn of the tangent
POINTS_PER_TURN = 360
MAX_POINTS = 8000


def circle(center: ArrayLike, radius: float) -> Array:
    """Points (n, 2) on a circle, from its rightmost point counter-clockwise; centre and radius in mm."""
    return ellipse(center, (radius, radius))


def ellipse(center: ArrayLike, semi_axes: tuple[float, float], angle: float = 0.0) -> Array:
    """Points (n, 2) on an ellipse, counter-clockwise from the end of its first semi-axis.

    Parameters
    ----------
    center : (2,) array_like
        Centre, mm.
    semi_axes : (float, float)
        Semi-axes along x and y before turning, mm.
    angle : float
        Angle by which it is turned counter-clockwise, degrees.
    """
    a, b = semi_axes
    # Even steps of the eccentric angle are shortest where the ellipse bends most; the tangent turns there
    # by a/b of the step.
    n = int(min(POINTS_PER_TURN * max(a / b, b / a), MAX_POINTS))
    t = np.linspace(0.0, 2 * np.pi, n, endpoint=False)
    return _placed(np.column_stack([a * np.cos(t), b * np.sin(t)]), center, angle)


def rectangle(
    center: ArrayLike, size: tuple[float, float], corner_radius: float, angle: float = 0.0
) -> Array:
    """Points (n, 2) on a rectangle with circular corners, counter-clockwise from its right side.

    Parameters
    ----------
    center : (2,) array_like
        Centre, mm.
    size : (float, float)
        Sides along x and y before turning, mm.
    corner_radius : float
        Radius of the corners, more than 0 and at most half the smaller side, mm.
    angle : float
        Angle by which it is turned counter-clockwise, degrees.
    """
    half = np.asarray(size, dtype=float) / 2 - corner_radius
    turn = np.linspace(0.0, np.pi / 2, POINTS_PER_TURN // 4 + 1)
    parts = []
    for quarter, (sx, sy) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        t = turn + quarter * np.pi / 2
        arc = half * (sx, sy) + corner_radius * np.column_stack([np.cos(t), np.sin(t)])
        # the straight side behind the corner has steps no longer than ten of the arc's
        side = 2 * half[quarter % 2]
        n = int(np.ceil(side / (10 * corner_radius * turn[1])))
        along = np.arange(1, n)[:, None] / max(n, 1) * side * np.array([-np.sin(t[-1]), np.cos(t[-1])])
        parts += [arc if side > 1e-9 * corner_radius else arc[:-1], arc[-1] + along]
    return _placed(np.vstack(parts), center, angle)


def _placed(points: Array, center: ArrayLike, angle: float) -> Array:
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return points @ np.array([[c, s], [-s, c]]) + np.asarray(center, dtype=float)
