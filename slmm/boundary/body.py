"""The body without its cracks: panels, what is known at them, and the factorised base system."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.linalg as la
from numpy.polynomial import legendre
from numpy.typing import NDArray

from slmm.boundary.densities import Linear, displacement_of_boundary, parts
from slmm.boundary.panels import boundary_of, panelled
from slmm.boundary.rules import Array, integration, rule
from slmm.mechanics.material import Material
from slmm.mechanics.rigid import free_motions
from slmm.mechanics.stress import kolosov, shear_modulus
from slmm.part.part import Part
from slmm.scene.load_checks import UNBALANCED
from slmm.scene.loading import Condition, Loading

#: a crack may grow towards a surface until panels there are so many times as long as its tip is away; those that are
#: made for a tip are no longer than that distance (chosen)
TOO_NEAR = 1.5


class Body:
    """A part's outlines, with panels that end at the mouths of its cracks; it serves as long as these stay.

    Parameters
    ----------
    part : Part
        Its cracks count by their mouths and tips alone.
    material : Material
    loading : Loading
    p : int
        Gauss points on each panel, which must be even.

    Attributes
    ----------
    panels : Panels
    known_t, known_q : ndarray, shape (n,)
        Tractions that are given, MPa, and their resultants over kappa + 1.
    lu : tuple
        Of the base system.
    solution : ndarray, shape (2 n,)
        Unknowns without cracks.
    crack_columns, crack_rows : dict
        What panels of cracks do to the base system and feel of it, by their place: kept while cracks grow.
    """

    def __init__(self, part: Part, material: Material, loading: Loading, p: int) -> None:
        """Assemble and factorise."""
        check_in_one_piece(part)
        E, nu = material.plane_stress_equivalent
        self.part, self.loading, self.material, self.p = part, loading, material, p
        self.E, self.nu, self.mu, self.kappa = E, nu, shear_modulus(E, nu), kolosov(nu)
        self.scale = (self.kappa + 1) / (2 * self.mu)
        self.mouths = mouths_of(part)
        changes = [complex(*point) for condition in loading for point in (condition.start, condition.end)]
        self.panels = panelled(boundary_of(part, self.mouths, changes), part, tips_of(part), p)
        self.crack_columns: dict[tuple[complex, complex, bool], Array] = {}
        self.crack_rows: dict[tuple[complex, complex, bool], tuple[Array, Array]] = {}
        self._set_conditions()
        self._factorise()

    def serves(self, part: Part) -> bool:
        """Whether a part with other cracks has the same outlines and mouths, and no tip too near a surface."""
        same = part.holes is self.part.holes and part.outer is self.part.outer
        if not same or mouths_of(part) != self.mouths:
            return False
        ends, p = self.panels.z.reshape(-1, self.p), self.p
        length = np.abs(self.panels.dz.reshape(-1, p)).sum(axis=1)
        return all((np.abs(ends - tip).min(axis=1) * TOO_NEAR >= length).all() for tip in tips_of(part))

    def _set_conditions(self) -> None:
        """What is known at every point: displacements as part of g, and tractions."""
        panels, n = self.panels, self.panels.n
        self.held = np.zeros((n, 2), dtype=bool)
        known, traction = np.zeros((n, 2)), np.zeros((n, 2))
        points = np.column_stack([panels.z.real, panels.z.imag])
        outer = np.repeat(panels.straight, panels.p)
        self.of_condition: dict[Condition, NDArray[np.bool_]] = {}
        for condition in self.loading:
            on = outer & condition.on(points)
            self.of_condition[condition] = on
            for i, component in enumerate(condition.displacement):
                if component is not None:
                    self.held[on, i] = True
                    known[on, i] = component(points[on]) * 2 * self.mu / (self.kappa + 1)
            traction[on] = condition.traction
        traction[self.held] = 0.0
        self.known_g = known @ [1, 1j]
        self.known_t = traction @ [1, 1j]

    @cached_property
    def to_q(self) -> Array:
        """From tractions (n,) to the integrals of i t ds along each contour, over i."""
        panels, p = self.panels, self.panels.p
        local = integration(p)
        length = np.abs(panels.dz.reshape(-1, p)).sum(axis=1)
        m = len(length)
        matrix = np.zeros((m, p, m, p))
        for k in range(m):
            matrix[k, :, k, :] = 0.5 * length[k] * local[:p]
            later = np.flatnonzero((panels.contour == panels.contour[k]) & (np.arange(m) > k))
            matrix[later, :, k, :] = 0.5 * length[k] * local[p]
        return matrix.reshape(m * p, m * p)

    def in_unknowns(self, by_g: Linear, by_q: Linear) -> Array:
        """Real matrix (2 t, 2 n) in the unknowns: displacements at the points or, where these are held, tractions."""
        to_q = self.to_q * (1j / (self.kappa + 1))
        matrix = by_g.real()
        held = self.held.ravel()
        if held.any():
            rows = np.flatnonzero(self.held.any(axis=1))
            columns = Linear(by_q.one @ to_q[:, rows], by_q.other @ to_q[:, rows].conj()).real()
            place = np.ravel(2 * rows[:, None] + np.arange(2))
            which = held[place]
            matrix[:, place[which]] = columns[:, which]
        return matrix

    def _factorise(self) -> None:
        """The base system: at every point the limit of W from inside is (kappa + 1) g."""
        n = self.panels.n
        by_g, by_q = displacement_of_boundary(self.panels, self.kappa, self.panels.z, np.arange(n))
        by_g = Linear(by_g.one - (self.kappa + 1) * np.eye(n), by_g.other)
        matrix = self.in_unknowns(by_g, by_q)
        self.known_q = self.to_q @ (self.known_t * 1j / (self.kappa + 1))
        rhs = -(by_g(self.known_g) + by_q(self.known_q))
        points = np.column_stack([self.panels.z.real, self.panels.z.imag])
        free = free_motions(points, self.held)
        weight = np.repeat(np.abs(self.panels.dz), 2)
        self._check_balance(free, weight)
        for mode in free.T:
            matrix += (self.kappa + 1) / weight.sum() * np.outer(mode, mode * weight)
        for mode in self._unseen_tractions():
            matrix += (self.kappa + 1) * np.outer(mode, mode)
        self.lu = la.lu_factor(matrix, overwrite_a=True)
        self.solution = la.lu_solve(self.lu, parts(rhs))

    def _check_balance(self, free: Array, weight: Array) -> None:
        """Refuse forces that do work on motions that nothing holds."""
        force = parts(self.known_t) * weight
        if np.any(np.abs(free.T @ force) > 2 * UNBALANCED * np.abs(force).sum()):
            x, y = force.reshape(-1, 2).sum(axis=0)
            raise ValueError(
                f"load: the part is free to move, and what acts on it does not balance: forces of ({x:.4g}, {y:.4g}) N "
                "for each mm of thickness are left, or a moment; prescribe displacements"
            )

    def _unseen_tractions(self) -> list[Array]:
        """Tractions (2 n,) whose resultant is the same at all points: none shows where a whole curve is held."""
        panels, p = self.panels, self.panels.p
        x, _ = rule(p)
        length = np.abs(panels.dz.reshape(-1, p)).sum(axis=1)
        # the resultant is a Legendre polynomial less one on every panel, which vanishes at the points
        slope = (legendre.legval(x, legendre.legder(np.eye(p + 1)[p])) * 2 / length[:, None]).ravel()
        modes = []
        for contour in range(panels.contour.max() + 1):
            here = np.repeat(panels.contour == contour, p)
            for i in range(2):
                if self.held[here, i].all():
                    mode = np.zeros((panels.n, 2))
                    mode[here, i] = slope[here]
                    modes.append(mode.ravel() / np.linalg.norm(mode))
        return modes


def mouths_of(part: Part) -> list[complex]:
    """Where cracks end on surfaces."""
    return [
        complex(*crack.points[k])
        for crack in part.cracks
        for k, end in ((0, crack.start), (-1, crack.end))
        if end.kind == "surface"
    ]


def tips_of(part: Part) -> list[complex]:
    """Where cracks have tips."""
    return [complex(*line[-1]) for line in part.tips]


def check_in_one_piece(part: Part) -> None:
    """Refuse a part that its cracks sever."""
    if part.is_severed:
        raise ValueError(
            f"the cracks sever the part, in {len(part.pieces)} pieces: nothing holds them together"
        )
