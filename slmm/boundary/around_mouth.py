"""A finer rule on the panels about a mouth, for what varies there as much as a crack is long."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy.linalg as la
from numpy.polynomial import legendre
from numpy.typing import NDArray

from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex, rule

#: panels nearer to a mouth than so many times their length have the finer rule, whose parts are halved towards the
#: mouth until they are as short as this share of the crack (both chosen on tests/boundary/test_surface_cracks.py)
NEAR, SHORT = 0.6, 0.1
#: places on each part (chosen)
FINE = 8
#: the change of curvature over a crack's length, as a turn in rad, that leaves nothing to be seen (chosen)
ALIKE = 1e-4
#: parts are halved so many times at most
MOST_HALVED = 30


class AroundMouth(NamedTuple):
    """The finer rule.

    Attributes
    ----------
    points : ndarray, shape (p m,) of int
        The points of the m panels.
    z, tangent : ndarray, shape (r,)
        Places, mm, and unit tangents.
    weight : ndarray, shape (r,)
        Of the rule, mm.
    spread : ndarray, shape (r, p m)
        From values at the points to those at the places.
    gathered : ndarray, shape (p m, r)
        From values at the places to the points, of which the panels' polynomials come nearest.
    """

    points: NDArray[np.int64]
    z: Complex
    tangent: Complex
    weight: Array
    spread: Array
    gathered: Array

    @classmethod
    def of(
        cls, panels: Panels, mouth: complex, panel: int, xi: float, curvature: float, longest: float
    ) -> AroundMouth | None:
        """About a mouth at a place xi of a panel, for cracks as long as given, mm.

        None where the surface about it is the circle of its curvature, 1/mm, which leaves nothing there.
        """
        p = panels.p
        away = np.abs(panels.fine - mouth)
        near = away.min(axis=1) < NEAR * panels.length
        near[panel] = True
        rows = np.flatnonzero(near)
        bend = panels.curvature.reshape(-1, p)[rows]
        smooth = (panels.smooth[rows] == panels.smooth[panel]).all()
        if smooth and np.abs(bend - curvature).max() * longest < ALIKE:
            return None
        x, w = rule(FINE)
        z, tangent, weight, spread, gathered = [], [], [], [], []
        for row in rows.tolist():
            at = xi if row == panel else (-1.0 if away[row, 0] < away[row, -1] else 1.0)
            low, high = _halved(at, SHORT * longest * 2 / panels.length[row])
            half = 0.5 * (high - low)[:, None]
            places = (0.5 * (low + high)[:, None] + half * x).ravel()
            weights = (half * w).ravel()
            polynomials = legendre.legvander(places, 2 * p - 1)
            to_places = polynomials @ _coefficients(2 * p)
            z.append(to_places @ panels.fine[row])
            along = to_places @ panels.fine_tangent[row]
            tangent.append(along / np.abs(along))
            weight.append(0.5 * panels.length[row] * weights)
            spread.append(polynomials[:, :p] @ _coefficients(p))
            gathered.append(_nearest(polynomials[:, :p], weights, p))
        return cls(
            (rows[:, None] * p + np.arange(p)).ravel(),
            np.concatenate(z),
            np.concatenate(tangent),
            np.concatenate(weight),
            la.block_diag(*spread),
            la.block_diag(*gathered),
        )


def _halved(at: float, short: float) -> tuple[Array, Array]:
    """Parts of (-1, 1) that become as short as given towards a place."""
    cuts = [at]
    for end in (-1.0, 1.0):
        size = abs(end - at)
        if size > 0:
            times = min(MOST_HALVED, max(0, int(np.ceil(np.log2(size / short)))))
            cuts += [at + (end - at) * 0.5**k for k in range(times + 1)]
    edges = np.unique(cuts)
    return edges[:-1], edges[1:]


def _nearest(polynomials: Array, weights: Array, p: int) -> Array:
    """From values at places with weights to those at p Gauss points of the polynomial that comes nearest; (p, r)."""
    coefficients = (np.arange(p) + 0.5)[:, None] * polynomials.T * weights
    return np.asarray(legendre.legvander(rule(p)[0], p - 1) @ coefficients)


@lru_cache
def _coefficients(p: int) -> Array:
    """From values at p Gauss points to coefficients of Legendre's polynomials."""
    return np.linalg.inv(legendre.legvander(rule(p)[0], p - 1))
