"""What solves the equations of a body without cracks: their factors, or iterations where there are too many.

Between both serves `slmm.boundary.skeletonised`.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrs

from slmm.boundary.densities import Targets, displacement_of_highest, displacement_of_jumps, parts
from slmm.boundary.equations import Equations
from slmm.boundary.far_field import Clusters
from slmm.boundary.influence import TWO_PI_I
from slmm.boundary.near_field import near_field
from slmm.boundary.recycled import Recycled
from slmm.boundary.rules import Array, Complex

#: points of a block of the iterative solver's preconditioner, at most (chosen by the time)
MOST_IN_BLOCK = 1000


class Solver(Protocol):
    """Solves for right-hand sides (2 n,) or (2 n, k)."""

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape."""


class Factorised:
    """By the factors of the whole matrix.

    Parameters
    ----------
    equations : Equations
    moves : ndarray, shape (2 n, k)
        Motions that nothing holds.
    felt : ndarray, shape (k, 2 n)
        How much of each the unknowns are.
    """

    def __init__(self, equations: Equations, moves: Array, felt: Array) -> None:
        """Assemble and factorise."""
        # transposed it is stored as LAPACK wants it, and factorised where it stands
        self._lu = la.lu_factor(equations.matrix(moves, felt).T, overwrite_a=True, check_finite=False)

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape as right-hand sides (2 n,) or (2 n, k)."""
        # without the wrapper, which takes as long as the solution for a crack's new panels in a small body
        solution, _ = dgetrs(*self._lu, right, trans=1)
        return np.asarray(solution)


class Iterative:
    """By iterations, preconditioned by the factors of what each closed curve causes at itself.

    Parameters are those of `Factorised`.
    """

    def __init__(self, equations: Equations, moves: Array, felt: Array) -> None:
        """Prepare sums and factors of the blocks."""
        self._equations, self._moves, self._felt = equations, moves, felt
        panels, p, tractions = equations.panels, equations.panels.p, equations.tractions
        self._clusters = Clusters(panels.z, panels.dz)
        self._near = near_field(panels)
        self._by_behind = displacement_of_jumps(equations.kappa, tractions.behind, equations.size, panels.z)
        here = Targets.on(panels).of(equations.acted, p)
        self._by_highest = displacement_of_highest(tractions.panels, equations.kappa, here)
        most = max(1, MOST_IN_BLOCK // p)
        edges = np.flatnonzero(np.diff(panels.contour, prepend=-1, append=-1))
        rows = [part for of in np.split(np.arange(len(panels.ends)), edges[1:-1]) for part in _cut(of, most)]
        self._blocks = [self._block(which) for which in rows]
        self._system = Recycled(self._image, self._preconditioned)

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape as right-hand sides (2 n,) or (2 n, k)."""
        return self._system.solve(right)

    def _caused(self, g: Complex, t: Complex) -> Complex:
        """W less (kappa + 1) g at the points, by displacements and tractions there."""
        kappa, tractions, points = self._equations.kappa, self._equations.tractions, self._equations.points
        q = np.zeros_like(g)
        q[points], behind = tractions.resultants(t[points])
        h, d = g + q, (kappa * q - g).conj()
        C1, C3 = self._near
        near = kappa * (C1 @ h) + (C1 @ d).conj() + C3 @ h.conj()
        far = self._clusters.displacement(h, d, kappa)
        beyond = self._by_behind(behind) + self._by_highest(tractions.unseen(t[points]))
        return (far + near) / TWO_PI_I + beyond - (kappa + 1) * g

    def _image(self, x: Array) -> Array:
        """The matrix times unknowns (2 n,)."""
        held, unit = self._equations.known.held, np.array([1, 1j])
        g = np.where(held, 0.0, x.reshape(-1, 2)) @ unit
        t = np.where(held, x.reshape(-1, 2), 0.0) @ unit
        return parts(self._caused(g, t)) + self._moves @ (self._felt @ x)

    def _block(self, which: NDArray[np.int64]) -> tuple[NDArray[np.int64], tuple[Array, Array]]:
        """Numbers of the unknowns of some panels, and the factors of what these cause at themselves."""
        equations, width = self._equations, 2 * self._equations.panels.p
        unknowns = (which[:, None] * width + np.arange(width)).ravel()
        matrix = equations.chosen(which).matrix(self._moves[unknowns], self._felt[:, unknowns])
        return unknowns, la.lu_factor(matrix, overwrite_a=True)

    def _preconditioned(self, rest: Array) -> Array:
        result = np.empty_like(rest)
        for unknowns, lu in self._blocks:
            result[unknowns] = la.lu_solve(lu, rest[unknowns], check_finite=False)
        return result


class WithRigid:
    """Rigid bodies on the surface in addition: by how much they move is unknown, the resultants on them are not.

    Parameters
    ----------
    held : Solver
        With these bodies at rest.
    moved : ndarray, shape (2 n, m)
        What the equations say by their motions.
    felt : ndarray, shape (m, 2 n)
        Resultants by the unknowns.
    """

    def __init__(self, held: Solver, moved: Array, felt: Array) -> None:
        """Solve for what each motion causes."""
        self._held, self._felt = held, felt
        self._caused = held.solve(moved)
        self._lu = la.lu_factor(felt @ self._caused)

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape as right-hand sides (2 n + m,) or (2 n + m, k)."""
        n = self._felt.shape[1]
        at_rest = self._held.solve(right[:n])
        motion = la.lu_solve(self._lu, self._felt @ at_rest - right[n:], check_finite=False)
        return np.concatenate([at_rest - self._caused @ motion, motion])


def _cut(which: NDArray[np.int64], most: int) -> list[NDArray[np.int64]]:
    """Panels that follow each other, in as few runs of about the same length as are no longer than the most."""
    return np.array_split(which, -(-len(which) // most))
