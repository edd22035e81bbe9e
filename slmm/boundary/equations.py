"""The equations of a body without cracks: at every point of its panels the limit of W from inside is (kappa + 1) g."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.conditions import Known
from slmm.boundary.densities import (
    Targets,
    displacement_by_q,
    displacement_of_boundary,
    parts,
    stress_of_boundary,
    traction_of,
    weights_of_boundary,
)
from slmm.boundary.influence import displacement_matrix
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex
from slmm.boundary.tractions import Tractions

#: weights of the whole matrix that are computed at once: 256 kB of each kind, which stay in the cache (chosen)
AT_ONCE = 16_384


class Equations:
    """What is known and unknown on panels, and what both cause.

    Parameters
    ----------
    panels : Panels
        Of n points.
    known : Known
        What is known at them, with m motions of rigid bodies.
    kappa : float
    size : float
        Of the body, mm; it decides rigid motions alone.

    Attributes
    ----------
    acted, points : ndarray, shape (k,), (k p,) of int
        The panels on which tractions act, known or not, or displacements are known, and their points.
    tractions : Tractions
        On these.
    """

    def __init__(self, panels: Panels, known: Known, kappa: float, size: float) -> None:
        """Compute nothing yet."""
        self.panels, self.known, self.kappa, self.size = panels, known, kappa, size
        self.acted = known.acted(panels.p)
        self.tractions = Tractions(panels.chosen(self.acted), kappa, size)
        self.points = (self.acted[:, None] * panels.p + np.arange(panels.p)).ravel()
        self._given_g = np.column_stack([known.g, known.rigid])[self.points]
        self._known_t = known.t[self.points]
        held = known.held[self.points].ravel()
        self._held = np.ravel(2 * self.points[:, None] + np.arange(2))[held], held

    def displacement(self, at: Targets) -> Array:
        """W at targets (t,) by the unknowns, real and imaginary parts in turn; (2 t, 2 n)."""
        C1, C3 = weights_of_boundary(self.panels, at)
        matrix = np.asarray(displacement_matrix(C1, C3, self.kappa))
        columns, held = self._held
        if len(columns):
            by_q = displacement_by_q(C1[:, self.points], C3[:, self.points], self.kappa)
            by_t = self.tractions.displacement(at.of(self.acted, self.panels.p), by_q)
            matrix[:, columns] = by_t.real()[:, held]
        return matrix

    def chosen(self, which: NDArray[np.int64]) -> Equations:
        """The same of some panels alone."""
        points = (which[:, None] * self.panels.p + np.arange(self.panels.p)).ravel()
        return Equations(self.panels.chosen(which), self.known.chosen(points), self.kappa, self.size)

    def caused(self, at: Targets, columns: NDArray[np.int64]) -> Array:
        """W at targets (t,) by some of the unknowns (k,) alone; (2 t, k)."""
        width = 2 * self.panels.p
        if not len(columns):
            return np.empty((2 * len(at.z), 0))
        which, place = np.unique(columns // width, return_inverse=True)
        some = self.chosen(which).displacement(at.of(which, self.panels.p))
        wanted = place * width + columns % width
        return some if np.array_equal(wanted, np.arange(some.shape[1])) else np.take(some, wanted, axis=1)

    def entries(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> Array:
        """Of the matrix, at equations (i,) and unknowns (j,)."""
        points, place = np.unique(rows // 2, return_inverse=True)
        at = Targets(self.panels.z[points], points, self.panels.smooth[points // self.panels.p])
        found = np.take(self.caused(at, columns), 2 * place + rows % 2, axis=0)
        _, i, j = np.intersect1d(rows, columns, assume_unique=True, return_indices=True)
        found[i, j] -= np.where(self.known.held.ravel()[rows[i]], 0.0, self.kappa + 1)
        return found

    def given_displacement(self, at: Targets) -> Array:
        """W at targets (t,) by what is known, and by the motions, less (kappa + 1) g at own points; (2 t, 1 + m)."""
        here = at.of(self.acted, self.panels.p)
        by_g, by_q = displacement_of_boundary(self.tractions.panels, self.kappa, here)
        W = by_g(self._given_g)
        if self._known_t.any():
            W[:, 0] += self.tractions.caused(here, self._known_t, by_q)
        own = here.own >= 0
        W[own] -= (self.kappa + 1) * self._given_g[here.own[own]]
        return _by_columns(W)

    def traction(self, z: Complex, e: Complex) -> tuple[Array, Array]:
        """Change of the resultant force along directions e (t,) at points z (t,), real and imaginary parts in turn.

        By the unknowns (2 t, 2 n), and by what is known and the motions (2 t, 1 + m).
        """
        P, Q = stress_of_boundary(self.panels, z)
        rows = traction_of(P, Q, -1.0, e).real()
        P, Q = (np.take(of, self.points, axis=1) for of in (P, Q))
        by_t = self.tractions.along_by(P, Q, z, e)
        columns, held = self._held
        rows[:, columns] = by_t.real()[:, held]
        given = traction_of(P, Q, -1.0, e)(self._given_g)
        given[:, 0] += by_t(self._known_t)
        return rows, _by_columns(given)

    def matrix(self, moves: Array, felt: Array) -> Array:
        """Of the equations at the points, (2 n, 2 n).

        With what motions (2 n, k) add to them, by how much the unknowns are each of these (k, 2 n).
        """
        here, n = Targets.on(self.panels), self.panels.n
        matrix = np.empty((2 * n, 2 * n))
        for points in np.array_split(np.arange(n), -(-n * n // AT_ONCE)):
            rows = slice(2 * points[0], 2 * points[-1] + 2)
            np.matmul(moves[rows], felt, out=matrix[rows])
            matrix[rows] += self.displacement(here.chosen(points))
        matrix[np.diag_indices(2 * n)] -= np.where(self.known.held.ravel(), 0.0, self.kappa + 1)
        return matrix


def _by_columns(values: Complex) -> Array:
    """Real and imaginary parts (2 t, k) in turn of values (t, k)."""
    return np.column_stack([parts(column) for column in values.T])
