"""How far rays go until they meet one of many lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Lines(NamedTuple):
    """Polylines one behind the other.

    Attributes
    ----------
    vertices : (m, 2) array
        Of all lines, mm; of a closed one the first is repeated.
    first : (k + 1,) array of int
        Where each line begins in them, and the end of the last one.
    centre, radius : (k, 2), (k,) array
        A circle around each line, mm.
    """

    vertices: Array
    first: NDArray[np.int64]
    centre: Array
    radius: Array

    @classmethod
    def of(cls, lines: Sequence[Array], closed: bool = False) -> Lines:
        """Lines of arrays (n, 2); closed ones, whose first point is not repeated."""
        parts = [np.asarray(line, dtype=float).reshape(-1, 2) for line in lines]
        if closed:
            parts = [np.vstack([part, part[:1]]) for part in parts]
        centre = np.array([0.5 * (part.min(axis=0) + part.max(axis=0)) for part in parts]).reshape(-1, 2)
        radius = np.array(
            [np.hypot(*(part - middle).T).max() for part, middle in zip(parts, centre, strict=True)]
        )
        first = np.concatenate([[0], np.cumsum([len(part) for part in parts])]).astype(np.int64)
        return cls(np.concatenate([*parts, np.empty((0, 2))]), first, centre, radius)


def distances_along(start: Array, direction: Array, lines: Lines, beyond: Array | float = 0.0) -> Array:
    """Distances (n,) along rays to the nearest line, mm; infinite where they meet none.

    Parameters
    ----------
    start, direction : (n, 2) array
        Where the rays begin, mm, and their unit vectors.
    lines : Lines
    beyond : (n,) array or float
        Distance, mm, from which on a line counts.

    Examples
    --------
    >>> square = Lines.of([np.array([[1, -1], [3, -1], [3, 1], [1, 1]])], closed=True)
    >>> distances_along(np.zeros((2, 2)), np.array([[1.0, 0.0], [0.0, 1.0]]), square)
    array([ 1., inf])
    >>> distances_along(np.zeros((1, 2)), np.array([[1.0, 0.0]]), square, beyond=2.0)
    array([3.])
    """
    least = np.full(len(start), beyond, dtype=float)
    return _nearest(
        np.ascontiguousarray(start, dtype=float), np.ascontiguousarray(direction, dtype=float), *lines, least
    )


def are_inside(points: Array, lines: Lines) -> NDArray[np.bool_]:
    """Whether points (n, 2) lie within any of closed lines.

    Examples
    --------
    >>> square = Lines.of([np.array([[1, -1], [3, -1], [3, 1], [1, 1]])], closed=True)
    >>> are_inside(np.array([[0.0, 0.0], [2.0, 0.5]]), square)
    array([False,  True])
    """
    return _inside(np.ascontiguousarray(points, dtype=float), *lines)


@njit(cache=True)
def _inside(points, vertices, first, centre, radius):
    """Kernel of `are_inside`: crossings of a ray along x are even outside."""
    result = np.zeros(len(points), dtype=np.bool_)
    for i in range(len(points)):
        x, y = points[i]
        for k in range(len(radius)):
            if np.hypot(centre[k, 0] - x, centre[k, 1] - y) > radius[k]:
                continue
            odd = False
            for j in range(first[k] + 1, first[k + 1]):
                (px, py), (qx, qy) = vertices[j - 1], vertices[j]
                if (py > y) != (qy > y) and x < px + (y - py) / (qy - py) * (qx - px):
                    odd = not odd
            if odd:
                result[i] = True
                break
    return result


@njit(cache=True)
def _nearest(start, direction, vertices, first, centre, radius, beyond):
    """Kernel of `distances_along`."""
    result = np.empty(len(start))
    for i in range(len(start)):
        x, y = start[i]
        dx, dy = direction[i]
        least, nearest = beyond[i], np.inf
        for k in range(len(radius)):
            cx, cy = centre[k, 0] - x, centre[k, 1] - y
            along, across = cx * dx + cy * dy, dx * cy - dy * cx
            # a share more than the circle, for rounding
            reach = radius[k] * (1 + 1e-12)
            if abs(across) > reach or along + reach < least or along - reach > nearest:
                continue
            j = first[k]
            px, py = vertices[j, 0] - x, vertices[j, 1] - y
            side = dx * py - dy * px
            for j in range(first[k] + 1, first[k + 1]):
                qx, qy = vertices[j, 0] - x, vertices[j, 1] - y
                other = dx * qy - dy * qx
                if (side <= 0) != (other <= 0) or side == 0 or other == 0:
                    if side != other:
                        share = side / (side - other)
                        at = (px + share * (qx - px)) * dx + (py + share * (qy - py)) * dy
                        if least <= at < nearest:
                            nearest = at
                    else:  # the line lies in the ray
                        for at in (px * dx + py * dy, qx * dx + qy * dy):
                            if least <= at < nearest:
                                nearest = at
                px, py, side = qx, qy, other
        result[i] = nearest
    return result
