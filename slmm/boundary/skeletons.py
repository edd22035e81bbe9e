"""Skeletons: the few unknowns and equations of a cluster of panels through which it acts on all others, and feels them.

An interpolative decomposition (Cheng, Gimbutas, Martinsson and Rokhlin, SIAM J. Sci. Comput. 26 (2005) 1389-1404) of
what the cluster causes at its surroundings, and of what these cause at it. Surroundings are what is near, as it is, and
what is far: all that comes from far are Taylor series of the functions of Kolosov and Muskhelishvili, and all that goes
there shows on a circle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

from slmm.boundary.densities import Targets
from slmm.boundary.equations import Equations
from slmm.boundary.rules import Array, Complex

Numbers = NDArray[np.int64]
#: what a decomposition leaves out over the largest column (chosen: K and stress stay the same to 1e-8)
LEFT_OUT = 5e-12
#: radius beyond which all is far, over that of the cluster (chosen by the time), and the terms of a series: the next
#: ones are below 1.5^-64, which is as much as is left out
BEYOND, TERMS = 1.5, 64
#: rows over columns beyond which rows are added up with random signs, and in how many sums each one is (chosen: some
#: rows more than columns, and eight sums, keep what is left out as small; Tropp et al., SIAM J. Sci. Comput. 41 (2019)
#: A2430-A2463)
MIXED, IN_ROWS = 1.5, 8


class Skeleton(NamedTuple):
    """Which of some columns stand for all, and how.

    Attributes
    ----------
    kept : ndarray, shape (k,) of int
        Columns that stand for all.
    shares : ndarray, shape (k, n)
        How much of each of these a column is.
    """

    kept: Numbers
    shares: Array


def skeleton(matrix: Array, weight: Array) -> Skeleton:
    """Of the columns of a matrix (m, n), which are weighed (n,), by a triangular factor with pivots.

    Of many rows sums with random signs tell the same.

    Examples
    --------
    >>> found = skeleton(np.outer([1.0, 2.0, 3.0], [1.0, -2.0]), np.ones(2))
    >>> found.kept.tolist(), bool(np.allclose(found.shares, [[-0.5, 1.0]]))
    ([1], True)
    """
    most = int(MIXED * matrix.shape[1])
    mixed = _mixing(most, len(matrix)) @ matrix if len(matrix) > most else matrix
    R, order = la.qr(mixed * weight, mode="r", pivoting=True, overwrite_a=True, check_finite=False)
    along = np.abs(np.diag(R))
    k = int(np.count_nonzero(along > LEFT_OUT * along[0]))
    kept, rest = order[:k].astype(np.int64), order[k:]
    shares = np.zeros((k, R.shape[1]))
    shares[np.arange(k), kept] = 1.0
    T = la.solve_triangular(R[:k, :k], R[:k, k:], check_finite=False)
    shares[:, rest] = weight[kept, None] * T / weight[rest]
    return Skeleton(kept, shares)


def _mixing(few: int, many: int) -> sp.csc_array:
    """Adds many rows up to fewer, each with random signs to some of them: how columns depend on each other stays."""
    rng = np.random.default_rng(0)
    signs = rng.choice(np.array([-1.0, 1.0]), IN_ROWS * many)
    return sp.csc_array(
        (signs, rng.integers(few, size=IN_ROWS * many), IN_ROWS * np.arange(many + 1)), shape=(few, many)
    )


class Circle(NamedTuple):
    """Around a cluster.

    Attributes
    ----------
    centre : complex
    radius : float
    """

    centre: complex
    radius: float

    @classmethod
    def around(cls, z: Complex) -> Circle:
        """The circle about the middle of the box around points (n,)."""
        x, y = z.real, z.imag
        centre = 0.5 * complex(x.min() + x.max(), y.min() + y.max())
        return cls(centre, float(np.abs(z - centre).max()))

    def taylor(self, z: Complex, kappa: float) -> Array:
        """W at points (t,) inside by what is far: each term of phi and psi, real and imaginary; (2 t, 4 TERMS)."""
        k, zeta = np.arange(TERMS), (z - self.centre)[:, None] / self.radius
        power = zeta**k
        slope = np.zeros_like(power)
        slope[:, 1:] = k[1:] * power[:, :-1]
        one = np.concatenate([kappa * power, np.zeros_like(power)], axis=1)
        other = np.concatenate([-zeta * slope.conj(), -power.conj()], axis=1)
        share = np.tile(BEYOND**-k, 2)
        W = np.stack([(one + other) * share, 1j * (one - other) * share], axis=-1).reshape(len(z), -1)
        return np.stack([W.real, W.imag], axis=1).reshape(2 * len(z), -1)

    @property
    def beyond(self) -> Complex:
        """Places at which all shows that goes far: a circle, and a few points that tell resultant forces apart."""
        turn = np.exp(2j * np.pi * np.arange(2 * TERMS + 6) / (2 * TERMS + 6))
        far = 10 * np.exp(2j * np.pi * np.arange(4) / 4)
        return self.centre + self.radius * BEYOND * np.concatenate([turn, far])


class Around:
    """What any cluster causes at its surroundings and feels of them.

    Parameters
    ----------
    equations : Equations
    moves : ndarray, shape (2 n, k)
        What motions that nothing holds add to the equations.
    felt : ndarray, shape (k, 2 n)
        How much of each the unknowns are.
    """

    def __init__(self, equations: Equations, moves: Array, felt: Array) -> None:
        """Compute nothing yet."""
        self._equations, self._moves, self._felt = equations, moves, felt
        panels = equations.panels
        self._shape = np.column_stack([panels.z.reshape(-1, panels.p), panels.ends])
        # tractions are displacements over a length
        self._weight = np.where(equations.known.held.ravel(), 1 / equations.size, 1.0)
        self._felt_share = felt * np.abs(moves).max(axis=0, initial=0.0)[:, None]

    def entries(self, rows: Numbers, columns: Numbers) -> Array:
        """Of the whole matrix, for equations (i,) and unknowns (j,)."""
        found = self._equations.entries(rows, columns)
        found += self._moves[rows] @ self._felt[:, columns]
        return found

    def circle(self, rows: Numbers, columns: Numbers) -> Circle:
        """Around the panels of equations and unknowns."""
        width = 2 * self._equations.panels.p
        return Circle.around(self._shape[np.unique(np.concatenate([rows, columns]) // width)].ravel())

    def of_unknowns(self, columns: Numbers, circle: Circle, others: Numbers) -> Skeleton:
        """Of unknowns, by what they cause at equations of others and far away."""
        equations = self._equations
        near = others[np.abs(equations.panels.z[others // 2] - circle.centre) < BEYOND * circle.radius]
        matrix = [
            self.entries(near, columns),
            equations.caused(Targets.beside(circle.beyond), columns),
            self._felt_share[:, columns],
        ]
        return skeleton(np.concatenate(matrix), self._weight[columns])

    def of_equations(self, rows: Numbers, circle: Circle, others: Numbers) -> Skeleton:
        """Of equations, by what they feel of the unknowns of others and of what is far away."""
        z, p = self._equations.panels.z, self._equations.panels.p
        reach = np.abs(self._shape - circle.centre).min(axis=1)
        near = others[reach[others // (2 * p)] < BEYOND * circle.radius]
        matrix = [
            (self.entries(rows, near) * self._weight[near]).T,
            _rows_of(circle.taylor(z[rows // 2], self._equations.kappa), rows).T,
        ]
        return skeleton(np.concatenate(matrix), np.ones(len(rows)))


def _rows_of(values: Array, rows: Numbers) -> Array:
    """Of real and imaginary parts (2 t, k) at a point for each of the equations (t,) its own."""
    return values[2 * np.arange(len(rows)) + rows % 2]
