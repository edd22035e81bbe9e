"""Rules of Gauss and Legendre on a panel: points, refinement, integrals, values and slopes of polynomials."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Array = NDArray[Any]
Complex = NDArray[Any]


@lru_cache
def rule(p: int) -> tuple[Array, Array]:
    """Points and weights of Gauss and Legendre on [-1, 1]."""
    x, w = legendre.leggauss(p)
    return x, w


@lru_cache
def refinement(p: int) -> Array:
    """From values at p Gauss points to those at 2 p, shape (2 p, p)."""
    x, _ = rule(p)
    fine, _ = rule(2 * p)
    return legendre.legvander(fine, p - 1) @ np.linalg.inv(legendre.legvander(x, p - 1))


@lru_cache
def integration(p: int) -> Array:
    """From values at p Gauss points to integrals from -1 to each of them, and to 1 in the last row; (p + 1, p)."""
    x, _ = rule(p)
    coefficients = np.linalg.inv(legendre.legvander(x, p - 1))
    at = np.append(x, 1.0)
    powers = [legendre.legval(at, legendre.legint(np.eye(p)[n], lbnd=-1.0)) for n in range(p)]
    return np.array(powers).T @ coefficients


@lru_cache
def _coefficients(p: int) -> Array:
    x, _ = rule(p)
    return np.linalg.inv(legendre.legvander(x, p - 1))


@lru_cache
def highest(p: int) -> Array:
    """From values at p Gauss points to the P_p in their integral from -1, which shows at none of them; shape (p,)."""
    return _coefficients(p)[p - 1] / (2 * p - 1)


@lru_cache
def highest_rule(p: int) -> tuple[Array, Array]:
    """P_p at twice as many points, and the weights of their rule."""
    x, w = rule(2 * p)
    return legendre.legval(x, np.eye(p + 1)[p]), w


def values_at(xi: Array, p: int) -> Array:
    """From values at p Gauss points to those at places xi (k,) of the panel, -1 to 1; (k, p)."""
    return legendre.legvander(xi, p - 1) @ _coefficients(p)


@lru_cache
def differentiation(p: int) -> Array:
    """From values at p Gauss points to derivatives by xi there, shape (p, p)."""
    return slopes_at(rule(p)[0], p)


def slopes_at(xi: Array, p: int) -> Array:
    """The same for derivatives by xi."""
    slopes = [legendre.legval(xi, legendre.legder(np.eye(p)[n])) for n in range(p)]
    return np.array(slopes).T @ _coefficients(p)
