"""What solves the equations of a body without cracks by factors, and with rigid bodies on its surface.

Where there are too many, `slmm.boundary.skeletonised` and `slmm.boundary.iterative` serve.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.linalg as la
from scipy.linalg.lapack import dgetrs

from slmm.boundary.equations import Equations
from slmm.boundary.rules import Array


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
