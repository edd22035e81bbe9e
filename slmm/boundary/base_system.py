"""The factorised equations of a body without cracks: at every point the limit of W from inside is (kappa + 1) g."""

from __future__ import annotations

import numpy as np
import scipy.linalg as la

from slmm.boundary.conditions import Known
from slmm.boundary.densities import (
    Targets,
    displacement_by_g,
    displacement_of_boundary,
    parts,
    stress_of_boundary,
    traction_of,
)
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex
from slmm.boundary.tractions import Tractions
from slmm.mechanics.rigid import free_motions
from slmm.scene.load_checks import UNBALANCED


class BaseSystem:
    """What is known and unknown on panels, and the factors of their equations.

    Parameters
    ----------
    panels : Panels
        Of n points.
    known : Known
        What is known at them.
    kappa : float
    size : float
        Of the body, mm; it decides rigid motions alone.

    Attributes
    ----------
    acted : ndarray, shape (k,) of int
        The panels on which tractions act, known or not, or displacements are known.
    tractions : Tractions
        On these.
    lu : tuple
    solution : ndarray, shape (2 n,)
        Unknowns without cracks: displacements at the points or, where these are held, tractions.

    Raises
    ------
    ValueError
        When the body is free to move and its loads do not balance.
    """

    def __init__(self, panels: Panels, known: Known, kappa: float, size: float) -> None:
        """Assemble and factorise."""
        self.panels, self.known, self.kappa = panels, known, kappa
        self.acted = known.acted(panels.p)
        self.tractions = Tractions(panels.chosen(self.acted), kappa, size)
        points = (self.acted[:, None] * panels.p + np.arange(panels.p)).ravel()
        self._known_g, self._known_t = known.g[points], known.t[points]
        held = known.held[points].ravel()
        self._held = np.ravel(2 * points[:, None] + np.arange(2))[held], held
        at = Targets.on(panels)
        matrix = self.displacement(at)
        matrix[np.diag_indices(2 * panels.n)] -= np.where(known.held.ravel(), 0.0, kappa + 1)
        self._held_by = (kappa + 1) / (4 * size)
        self._set_motions(free_motions(np.column_stack([panels.z.real, panels.z.imag]), known.held))
        matrix += self.by_motions(panels.z)
        self.lu = la.lu_factor(matrix, overwrite_a=True, check_finite=False)
        self.solution = la.lu_solve(self.lu, -parts(self.known_displacement(at)), check_finite=False)

    def displacement(self, at: Targets) -> Array:
        """W at targets (t,) by the unknowns, real and imaginary parts in turn; (2 t, 2 n)."""
        matrix = displacement_by_g(self.panels, self.kappa, at)
        columns, held = self._held
        if len(columns):
            matrix[:, columns] = self.tractions.displacement(at.of(self.acted, self.panels.p)).real()[:, held]
        return matrix

    def known_displacement(self, at: Targets) -> Complex:
        """W at targets (t,) by what is known, less (kappa + 1) g at known points."""
        here = at.of(self.acted, self.panels.p)
        by_g, _ = displacement_of_boundary(self.tractions.panels, self.kappa, here)
        W = by_g(self._known_g) + self.tractions.displacement(here)(self._known_t)
        own = here.own >= 0
        W[own] -= (self.kappa + 1) * self._known_g[here.own[own]]
        return W

    def traction(self, z: Complex, e: Complex) -> tuple[Array, Array]:
        """Change of the resultant force along directions e (t,) at points z (t,), real and imaginary parts in turn.

        By the unknowns (2 t, 2 n), and by what is known (2 t,).
        """
        by_g = traction_of(*stress_of_boundary(self.panels, z), -1.0, e)
        rows = by_g.real()
        by_t = self.tractions.along(z, e)
        columns, held = self._held
        rows[:, columns] = by_t.real()[:, held]
        points = (self.acted[:, None] * self.panels.p + np.arange(self.panels.p)).ravel()
        on_acted = type(by_g)(by_g.one[:, points], by_g.other[:, points])
        return rows, parts(on_acted(self._known_g) + by_t(self._known_t))

    def _set_motions(self, free: Array) -> None:
        """What the equations add to hold free motions (2 n, k), which forces that balance do not cause."""
        weight = np.repeat(np.abs(self.panels.dz), 2)
        force = parts(self.known.t) * weight
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

    def by_motions(self, z: Complex) -> Array:
        """What holds free motions, in the equations of points (t,), by the unknowns; (2 t, 2 n)."""
        return self.motions(z) @ self._felt_motions

    def motions_felt(self, panels: Panels) -> Array:
        """The same by the displacements on other panels of m points: how much each motion is felt, (k, 2 m)."""
        weight = np.repeat(np.abs(panels.dz), 2)
        return (self._held_by * self.motions(panels.z) * weight[:, None]).T


def _rigid(z: Complex) -> Array:
    """Motions along x and y and a turn, at points (t,); (2 t, 3)."""
    result = np.zeros((len(z), 2, 3))
    result[:, 0, 0] = result[:, 1, 1] = 1.0
    result[:, 0, 2], result[:, 1, 2] = -z.imag, z.real
    return result.reshape(-1, 3)
