"""Integration rules of finite elements, their points in the order of Abaqus (and CalculiX).

Bricks and quadrilaterals live on [-1, 1]^d, tetrahedra and triangles on the unit simplex, wedges on the unit triangle
times [0, 1].
"""

from __future__ import annotations

from itertools import product

import numpy as np

#: points (n, d) of rules of equal weights: of a triangle, the centre (exact for degree 1) and three points (degree 2),
#: and four points of a tetrahedron (degree 2)
CENTRE = np.array([[1 / 3, 1 / 3]])
THREE = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])
_a, _b = (5 - np.sqrt(5)) / 20, (5 + 3 * np.sqrt(5)) / 20
FOUR = np.array([[_a, _a, _a], [_b, _a, _a], [_a, _b, _a], [_a, _a, _b]])


def gauss_rule(n: int, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points (n^d, d) and weights (n^d,), n a direction, the first coordinate fastest.

    Examples
    --------
    >>> points, weights = gauss_rule(2, 2)
    >>> points.round(3).tolist()
    [[-0.577, -0.577], [0.577, -0.577], [-0.577, 0.577], [0.577, 0.577]]
    """
    x, w = np.polynomial.legendre.leggauss(n)
    points = np.array([p[::-1] for p in product(x, repeat=dimension)])
    weights = np.array([np.prod(p) for p in product(w, repeat=dimension)])
    return points, weights


def wedge_rule(triangle: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """A rule of equal weights on the triangle, times n Gauss points along the wedge.

    Examples
    --------
    >>> points, weights = wedge_rule(CENTRE, 2)
    >>> points.round(3).tolist(), weights.tolist()
    ([[0.333, 0.333, 0.211], [0.333, 0.333, 0.789]], [0.25, 0.25])
    """
    x, w = np.polynomial.legendre.leggauss(n)
    points = [[*p, (1 + z) / 2] for z in x for p in triangle]
    return np.array(points), np.repeat(w / 4, len(triangle)) / len(triangle)
