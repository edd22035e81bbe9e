"""What solves the equations of a body without cracks: their factors, or iterations where there are too many."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.linalg as la

from slmm.boundary.densities import parts
from slmm.boundary.equations import Equations
from slmm.boundary.far_field import Clusters
from slmm.boundary.influence import TWO_PI_I
from slmm.boundary.near_field import near_field
from slmm.boundary.recycled import Recycled
from slmm.boundary.rules import Array, Complex

#: points up to which all is factorised, and of a block of the iterative solver's preconditioner, at most (chosen by the
#: time: both take some seconds)
MOST_FACTORISED, MOST_IN_BLOCK = 2500, 1000
#: densities that are known: g, q and its jumps
Known = tuple[Complex, Complex, Complex]


class BaseSystem(Protocol):
    """Solves for right-hand sides (2 n,) or (2 n, k).

    Attributes
    ----------
    right : ndarray, shape (2 n,)
        That of what is known.
    moved : ndarray, shape (2 n, m)
        What the equations say by motions of rigid bodies.
    """

    right: Array
    moved: Array

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape."""


def _hold(equations: Equations, free: Array) -> tuple[Array, Array]:
    """What the equations add to hold free motions (2 n, k): these, and what of the unknowns feels them (k, 2 n)."""
    weight = np.repeat(np.abs(equations.panels.dz), 2)
    return free, (equations.kappa + 1) / weight.sum() * (free * weight[:, None]).T


class Factorised:
    """By the factors of the whole matrix.

    Parameters
    ----------
    equations : Equations
    known : Known
    free : ndarray, shape (2 n, k)
        Motions that nothing holds.
    rigid : ndarray, shape (n, m)
        Those of rigid bodies on the surface, as part of g.
    """

    def __init__(self, equations: Equations, known: Known, free: Array, rigid: Array) -> None:
        """Assemble and factorise."""
        matrix, (by_g, by_q, by_jumps) = equations.matrix()
        g, q, jumps = known
        self.right = -parts(by_g(g) + by_q(q) + by_jumps(jumps))
        self.moved = _columns([by_g(motion) for motion in rigid.T], 2 * len(rigid))
        moves, felt = _hold(equations, free)
        matrix += moves @ felt
        self._lu = la.lu_factor(matrix, overwrite_a=True)

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape as right-hand sides (2 n,) or (2 n, k)."""
        return la.lu_solve(self._lu, right, check_finite=False)


class Iterative:
    """By iterations, preconditioned by the factors of what each closed curve causes at itself.

    Parameters are those of `Factorised`.
    """

    def __init__(self, equations: Equations, known: Known, free: Array, rigid: Array) -> None:
        """Prepare sums and factors of the blocks."""
        self._equations = equations
        panels, p = equations.panels, equations.panels.p
        self._clusters = Clusters(panels.z, panels.dz)
        self._near = near_field(panels)
        self._by_jumps = equations.displacement_by_jumps(panels.z)
        self._of_held, self._spread = equations.unseen
        self._moves, self._felt = _hold(equations, free)
        most = max(1, MOST_IN_BLOCK // p)
        edges = np.flatnonzero(np.diff(panels.contour, prepend=-1, append=-1))
        rows = [part for of in np.split(np.arange(len(panels.ends)), edges[1:-1]) for part in _cut(of, most)]
        self._blocks = [self._block(which) for which in rows]
        g, q, jumps = known
        self.right = -parts(self._caused(g, q, jumps))
        none = np.zeros_like(q), np.zeros_like(jumps)
        self.moved = _columns([self._caused(motion, *none) for motion in rigid.T], 2 * len(rigid))
        self._system = Recycled(self._image, self._preconditioned)

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape as right-hand sides (2 n,) or (2 n, k)."""
        return self._system.solve(right)

    def _caused(self, g: Complex, q: Complex, jumps: Complex) -> Complex:
        """W less (kappa + 1) g at the points, by densities there."""
        kappa, h, d = self._equations.kappa, g + q, (self._equations.kappa * q - g).conj()
        C1, C3 = self._near
        near = kappa * (C1 @ h) + (C1 @ d).conj() + C3 @ h.conj()
        far = self._clusters.displacement(h, d, kappa)
        return (far + near) / TWO_PI_I + self._by_jumps(jumps) - (kappa + 1) * g

    def _image(self, x: Array) -> Array:
        """The matrix times unknowns (2 n,)."""
        equations = self._equations
        held, unit = equations.held, np.array([1, 1j])
        g = np.where(held, 0.0, x.reshape(-1, 2)) @ unit
        t = np.where(held, x.reshape(-1, 2), 0.0) @ unit
        force = t * (1j / (equations.kappa + 1))
        W = self._caused(g, equations.resultants(force), equations.to_jumps @ force)
        W += self._of_held(self._spread @ t[equations.held_rows])
        return parts(W) + self._moves @ (self._felt @ x)

    def _block(self, which: Array) -> tuple[Array, tuple[Array, Array]]:
        """Numbers of the unknowns of some panels, and the factors of what these cause at themselves."""
        equations, p = self._equations, self._equations.panels.p
        points = (which[:, None] * p + np.arange(p)).ravel()
        unknowns = (2 * points[:, None] + np.arange(2)).ravel()
        own = Equations(
            equations.panels.chosen(which), equations.held[points], equations.acted[points], equations.kappa
        )
        matrix, _ = own.matrix()
        matrix += self._moves[unknowns] @ self._felt[:, unknowns]
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
    held : BaseSystem
        With these bodies at rest.
    felt : ndarray, shape (m, 2 n)
        Resultants by the unknowns.
    resultants : ndarray, shape (m,)
        N and N mm, for each mm of thickness.
    """

    def __init__(self, held: BaseSystem, felt: Array, resultants: Array) -> None:
        """Solve for what each motion causes."""
        self._held, self._felt = held, felt
        self.right, self.moved = np.concatenate([held.right, resultants]), held.moved
        self._caused = held.solve(held.moved)
        self._lu = la.lu_factor(felt @ self._caused)

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape as right-hand sides (2 n + m,) or (2 n + m, k)."""
        n = self._felt.shape[1]
        at_rest = self._held.solve(right[:n])
        motion = la.lu_solve(self._lu, self._felt @ at_rest - right[n:], check_finite=False)
        return np.concatenate([at_rest - self._caused @ motion, motion])


def _columns(values: list[Complex], rows: int) -> Array:
    """Real and imaginary parts (rows, m) of m complex vectors."""
    return np.array([parts(value) for value in values]).reshape(-1, rows).T


def _cut(which: Array, most: int) -> list[Array]:
    """Panels that follow each other, in as few runs of about the same length as are no longer than the most."""
    return np.array_split(which, -(-len(which) // most))
