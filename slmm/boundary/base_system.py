"""The solved equations of a body without cracks, and what it causes elsewhere."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np

from slmm.boundary.conditions import Known
from slmm.boundary.densities import Targets, parts
from slmm.boundary.equations import Equations
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex
from slmm.boundary.solvers import Factorised, Solver, WithRigid
from slmm.mechanics.rigid import free_motions
from slmm.scene.load_checks import UNBALANCED

#: points up to which all is factorised, and up to which clusters are; beyond all is iterated (chosen by the time)
MOST_FACTORISED, MOST_SKELETONISED = 2000, 8000
#: weights that are computed at once for what is known: 4 MB of each kind (chosen)
MOST_WEIGHTS = 262_144


class BaseSystem:
    """What is known and unknown on panels, and what solves their equations.

    The unknowns are displacements at the points or, where these are held, tractions, and then by how much rigid bodies
    on the surface move, mm.

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
    equations : Equations
    acted : ndarray, shape (k,) of int
        The panels on which tractions act, known or not, or displacements are known.
    tractions : Tractions
        On these.
    solver : Factorised, Skeletonised or Iterative
        With rigid bodies at rest.
    solution : ndarray, shape (2 n + m,)
        Unknowns without cracks.
    corrections : dict
        What `slmm.boundary.part_corrections` has found of it, which no load changes.

    Raises
    ------
    ValueError
        When the body is free to move and its loads do not balance.
    """

    def __init__(self, panels: Panels, known: Known, kappa: float, size: float) -> None:
        """Assemble and factorise, or prepare iterations."""
        self.panels, self.kappa = panels, kappa
        self.equations = Equations(panels, known, kappa, size)
        self.acted, self.tractions = self.equations.acted, self.equations.tractions
        weight = np.repeat(np.abs(panels.dz), 2)
        self._held_by = (kappa + 1) / (4 * size)
        self._set_motions(
            free_motions(np.column_stack([panels.z.real, panels.z.imag]), known.held), known, weight
        )
        self.solver: Solver = self._way()(self.equations, self.motions(panels.z), self._felt_motions)
        self._solver: Solver = self.solver
        self.corrections: dict[object, Array] = {}
        given = self._given()
        if len(known.resultants):
            self._solver = WithRigid(self.solver, given[:, 1:], (known.motions * weight[:, None]).T)
        self.solution = self.solve(np.concatenate([-given[:, 0], known.resultants]))

    def _way(self) -> Callable[[Equations, Array, Array], Solver]:
        """What solves so many equations; what few of them need none of is loaded where it is needed."""
        if self.panels.n <= MOST_FACTORISED:
            return Factorised
        if self.is_iterative:
            from slmm.boundary.iterative import Iterative

            return Iterative
        from slmm.boundary.skeletonised import Skeletonised

        return Skeletonised

    def under(self, known: Known) -> BaseSystem | None:
        """The same with other loads, factorised as it is; None where they act elsewhere, or rigid bodies move."""
        equations = Equations(self.panels, known, self.kappa, self.equations.size)
        held = np.array_equal(known.held, self.equations.known.held)
        if not held or len(known.resultants) or not np.array_equal(equations.acted, self.acted):
            return None
        other = copy.copy(self)
        other.equations, other.tractions = equations, equations.tractions
        z, weight = self.panels.z, np.repeat(np.abs(self.panels.dz), 2)
        other._set_motions(free_motions(np.column_stack([z.real, z.imag]), known.held), known, weight)
        other.solution = other.solve(-other._given()[:, 0])
        return other

    def _given(self) -> Array:
        """The equations at its points by what is known, and by the motions (2 n, 1 + m)."""
        n = self.panels.n
        here, turns = Targets.on(self.panels), max(1, n * len(self.equations.points) // MOST_WEIGHTS)
        places = np.array_split(np.arange(n), turns)
        return np.concatenate([self.equations.given_displacement(here.chosen(rows)) for rows in places])

    @property
    def is_iterative(self) -> bool:
        """Whether there are too many points for factors, of clusters too."""
        return self.panels.n > max(MOST_FACTORISED, MOST_SKELETONISED)

    @property
    def unknowns(self) -> int:
        """At the panels' points, 2 n."""
        return 2 * self.panels.n

    def solve(self, right: Array) -> Array:
        """Unknowns for right-hand sides (2 n + m,) or (2 n + m, k), of the same shape."""
        return self._solver.solve(right)

    def displacement(self, at: Targets) -> tuple[Array, Array]:
        """The equations at targets (t,) beside its points: by the unknowns (2 t, 2 n + m), and what is known (2 t,)."""
        rows, given = self.equations.displacement(at), self.equations.given_displacement(at)
        rows += self.motions(at.z) @ self._felt_motions
        return _beside(rows, given)

    def traction(self, z: Complex, e: Complex) -> tuple[Array, Array]:
        """Change of the resultant force along directions e (t,) at points z (t,), in the same way."""
        return _beside(*self.equations.traction(z, e))

    def _set_motions(self, free: Array, known: Known, weight: Array) -> None:
        """What the equations add to hold free motions (2 n, k), which forces that balance do not cause."""
        force = parts(known.t) * weight
        if np.any(np.abs(free.T @ force) > 2 * UNBALANCED * np.abs(force).sum()):
            x, y = force.reshape(-1, 2).sum(axis=0)
            raise ValueError(
                f"load: the part is free to move, and what acts on it does not balance: forces of ({x:.4g}, {y:.4g}) N "
                "for each mm of thickness are left, or a moment; prescribe displacements"
            )
        self._motions = np.linalg.lstsq(_rigid(self.panels.z), free, rcond=None)[0]
        self._felt_motions = (self._held_by * free * weight[:, None]).T

    def motions(self, z: Complex) -> Array:
        """Free motions (2 t, k) at points (t,)."""
        return _rigid(z) @ self._motions

    def motions_felt(self, panels: Panels) -> Array:
        """How much the displacements on other panels of m points are each of these motions, (k, 2 m)."""
        weight = np.repeat(np.abs(panels.dz), 2)
        return (self._held_by * self.motions(panels.z) * weight[:, None]).T


def _beside(rows: Array, given: Array) -> tuple[Array, Array]:
    """Rows (t, 2 n) with what motions (t, m) cause beside them, and what is known (t,), of what is given (t, 1 + m)."""
    return rows if given.shape[1] == 1 else np.column_stack([rows, given[:, 1:]]), given[:, 0]


def _rigid(z: Complex) -> Array:
    """Motions along x and y and a turn, at points (t,); (2 t, 3)."""
    result = np.zeros((len(z), 2, 3))
    result[:, 0, 0] = result[:, 1, 1] = 1.0
    result[:, 0, 2], result[:, 1, 2] = -z.imag, z.real
    return result.reshape(-1, 3)
