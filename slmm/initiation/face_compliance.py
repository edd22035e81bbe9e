"""Compliance of the faces of a crack that starts from a circular hole, or from a straight edge, of an unbounded body.

The crack is a continuous distribution of dislocations (Hills, Kelly, Dai and Korsunsky, 1996): with the density B =
-d(opening)/d(eta) the stress on the path is the sum of theirs, the mirror by the free surface included (`dipole`), and
cancels the stress that was there. Gauss-Chebyshev quadrature and collocation make a small dense system of it (Erdogan
and Gupta, 1972). Its error is quadratic in the number of points and extrapolated; at a straight edge the known stress
intensity 1.1215 sigma sqrt(pi a) comes out to 1e-6.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev, legendre

from slmm.initiation.dipole import mirror_stress
from slmm.mechanics.richardson import extrapolated
from slmm.mechanics.stress import kolosov, shear_modulus

#: longest crack over the radius of the hole; chosen
LONGEST = 50.0
#: number of Legendre polynomials for tractions; chosen
ORDERS = 8
#: points along the crack, of the coarser of two solutions; chosen
POINTS = 20
#: degree of the polynomial over the ratio, and the ratio a/R at which its scale turns from linear to
#: logarithmic; both chosen
DEGREE, LINEAR_BELOW = 24, 0.5


@dataclass(frozen=True)
class FaceCompliance:
    """Work of Legendre tractions P_k(2 eta/a - 1) on the opening or sliding that others cause, for E = 1 MPa.

    Attributes
    ----------
    coefficients : ndarray (DEGREE + 1, 2, ORDERS, ORDERS)
        Chebyshev coefficients of C/a^2, 1/MPa, for opening and sliding, over the scaled ratio a/R.
    """

    coefficients: np.ndarray

    def __call__(self, a: np.ndarray, radius: float) -> np.ndarray:
        """Compliance (n, 2, k, k) for crack lengths (n,) at a hole, or an edge (radius = inf), mm^2/MPa.

        Examples
        --------
        A crack from a straight edge under constant stress releases the energy of K = 1.1215 sigma sqrt(pi a).

        >>> C = face_compliance()(np.array([1.0]), np.inf)
        >>> round(float(C[0, 0, 0, 0]) / (1.1215223**2 * np.pi), 5)
        1.0
        """
        basis = chebyshev.chebvander(_scaled(a / radius), DEGREE)
        return np.tensordot(basis * a[:, None] ** 2, self.coefficients, axes=1)


@lru_cache(maxsize=1)
def face_compliance() -> FaceCompliance:
    """Compliance over all ratios of crack length to radius, from 0 to LONGEST."""
    x = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    ratio = LINEAR_BELOW * np.expm1((x + 1) / 2 * np.log1p(LONGEST / LINEAR_BELOW))
    values = np.array([compliance(1 / r) for r in ratio])
    basis = chebyshev.chebvander(x, DEGREE)
    return FaceCompliance(np.linalg.solve(basis, values.reshape(len(x), -1)).reshape(values.shape))


def _scaled(ratio: np.ndarray) -> np.ndarray:
    """Ratios a/R between 0 and LONGEST, brought to -1 to 1."""
    return 2 * np.log1p(ratio / LINEAR_BELOW) / np.log1p(LONGEST / LINEAR_BELOW) - 1


def compliance(radius: float, points: int = POINTS) -> np.ndarray:
    """Compliance (2, k, k) of a crack of unit length at a hole of the given radius, for E = 1; inf is an edge."""
    C, _ = extrapolated(_with_points(radius, points), _with_points(radius, 2 * points), order=2)
    return (C + C.swapaxes(1, 2)) / 2


def _with_points(radius: float, n: int) -> np.ndarray:
    nu, E = 0.3, 1.0  # stresses by dislocations in plane bodies do not depend on Poisson's ratio
    mu, kappa = shear_modulus(E, nu), kolosov(nu)
    i = np.arange(1, n + 1)
    x, y = np.cos((2 * i - 1) * np.pi / (2 * n)), np.cos(np.arange(1, n) * np.pi / n)
    at, to = (1 + x) / 2, (1 + y) / 2  # depths of the dislocations and of the collocation points
    direct = E / (4 * np.pi) * (1 / (to[:, None] - at) - 1 / to[:, None])
    # what the surface adds to a dislocation is the sum over dipoles from the mouth to it
    ends = np.concatenate([[0.0], at[::-1]])
    t, w = legendre.leggauss(8)
    step = np.diff(ends)[:, None]
    within = ends[:-1, None] + step * (t + 1) / 2
    mirrored = mirror_stress(to, within.ravel(), radius, mu, kappa).reshape(2, n - 1, n, len(t))
    mirrored = np.cumsum(np.einsum("djiq,iq->dji", mirrored, step * w / 2), axis=-1)[..., ::-1]
    # Krenk's interpolation: the density's singular factor vanishes at the mouth, where the surface is free
    angle = (2 * i - 1) * np.pi / (4 * n)
    at_mouth = (np.sin((2 * n - 1) * angle) / np.sin(angle))[::-1] / n
    tractions = np.vstack([-legendre.legvander(y, ORDERS - 1), np.zeros(ORDERS)])
    P = legendre.legvander(x, ORDERS)
    k = np.arange(1, ORDERS)
    # integrals of P_k from the mouth: the work on a unit jump up to each dislocation
    work = np.column_stack([(x + 1) / 2, (P[:, 2:] - P[:, :-2])[:, : ORDERS - 1] / (2 * (2 * k + 1))])
    result = []
    for direction in range(2):
        system = np.vstack([(direct + mirrored[direction]) * np.pi / (2 * n), at_mouth])
        density = np.linalg.solve(system, tractions)
        result.append(work.T @ density * np.pi / (2 * n))
    return np.array(result)


def legendre_coefficients(orders: int, x: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """From values at Gauss points x (q,) in [-1, 1] to coefficients of the first Legendre polynomials, (orders, q)."""
    norm = (2 * np.arange(orders) + 1) / 2
    return norm[:, None] * (legendre.legvander(x, orders - 1) * weights[:, None]).T
