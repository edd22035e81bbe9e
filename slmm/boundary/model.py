"""A part by boundary integrals: densities on its outlines and cracks, and what follows from them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy.linalg as la
import shapely
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from slmm.boundary.crack_panels import CrackPanels, crack_panels, slope_at_tip
from slmm.boundary.densities import (
    Linear,
    displacement_of_boundary,
    of_cracks,
    parts,
    stress_of_boundary,
    traction_of,
)
from slmm.boundary.panels import Array, boundary_of, integration, panelled, rule, values_at
from slmm.boundary.surface import Feet, feet, surface_stress
from slmm.mechanics.material import Material
from slmm.mechanics.rigid import free_motions
from slmm.mechanics.stress import kolosov, shear_modulus
from slmm.part.part import OUTLINE_SAMPLES, Part
from slmm.scene.loading import Condition, Loading

#: depth below a surface, over the length of the panel there, from which on kernels keep six digits (chosen)
BESIDE = 0.01


class BoundaryModel:
    """Plane elasticity on the outlines of a part alone; cracks are lines of displacement jump.

    Parameters
    ----------
    part : Part
        In one piece, its holes inside it.
    material : Material
    loading : Loading
    p, crack_p : int
        Gauss points on each panel of the boundary, which must be even, and of the cracks.

    Attributes
    ----------
    panels : Panels
    cracks : CrackPanels or None
    g, q : ndarray, shape (n,)
        Displacement and resultant force at the boundary's points, times 2 mu/(kappa + 1) and 1/(kappa + 1).
    c : ndarray, shape (m,)
        Displacement jump at the points of the cracks, scaled as g.
    """

    def __init__(
        self, part: Part, material: Material, loading: Loading, p: int = 8, crack_p: int = 6
    ) -> None:
        """Assemble, factorise and solve."""
        E, nu = material.plane_stress_equivalent
        self.part, self.loading = part, loading
        self.E, self.nu, self.mu, self.kappa = E, nu, shear_modulus(E, nu), kolosov(nu)
        self._scale = (self.kappa + 1) / (2 * self.mu)
        _check(part)
        mouths = [
            complex(*crack.points[k])
            for crack in part.cracks
            for k, end in ((0, crack.start), (-1, crack.end))
            if end.kind == "surface"
        ]
        tips = [complex(*line[-1]) for line in part.tips]
        self.panels = panelled(boundary_of(part, [*mouths, *self._changes()]), part, tips, p)
        self._set_conditions()
        self._factorise()
        self.cracks: CrackPanels | None = None
        solution = la.lu_solve(self._lu, self._rhs)
        self.c = np.empty(0, dtype=complex)
        if part.cracks:
            self.cracks = crack_panels(part, self.panels.z, crack_p)
            solution = self._with_cracks(solution)
        self._take(solution)

    def _changes(self) -> list[complex]:
        """Where conditions end on the outer edge."""
        return [complex(*point) for condition in self.loading for point in (condition.start, condition.end)]

    def _set_conditions(self) -> None:
        """What is known at every point: displacements as part of g, and tractions."""
        panels, n = self.panels, self.panels.n
        self._held = np.zeros((n, 2), dtype=bool)
        known, traction = np.zeros((n, 2)), np.zeros((n, 2))
        points = np.column_stack([panels.z.real, panels.z.imag])
        outer = np.repeat(panels.contour == 0, panels.p)
        self._of_condition: dict[Condition, NDArray[np.bool_]] = {}
        for condition in self.loading:
            on = outer & condition.on(points)
            self._of_condition[condition] = on
            for i, component in enumerate(condition.displacement):
                if component is not None:
                    self._held[on, i] = True
                    known[on, i] = component(points[on]) * 2 * self.mu / (self.kappa + 1)
            traction[on] = condition.traction
        traction[self._held] = 0.0
        self._known_g = known @ [1, 1j]
        self._known_t = traction @ [1, 1j]

    @cached_property
    def _to_q(self) -> Array:
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

    def _in_unknowns(self, by_g: Linear, by_q: Linear) -> Array:
        """Real matrix (2 t, 2 n) in the unknowns: displacements at the points or, where these are held, tractions."""
        to_q = self._to_q * (1j / (self.kappa + 1))
        matrix = by_g.real()
        held = self._held.ravel()
        if held.any():
            rows = np.flatnonzero(self._held.any(axis=1))
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
        matrix = self._in_unknowns(by_g, by_q)
        known_q = self._to_q @ (self._known_t * 1j / (self.kappa + 1))
        rhs = -(by_g(self._known_g) + by_q(known_q))
        points = np.column_stack([self.panels.z.real, self.panels.z.imag])
        free = free_motions(points, self._held)
        weight = np.repeat(np.abs(self.panels.dz), 2)
        for mode in free.T:
            matrix += (self.kappa + 1) / weight.sum() * np.outer(mode, mode * weight)
        for mode in self._unseen_tractions():
            matrix += (self.kappa + 1) * np.outer(mode, mode)
        self._rhs = parts(rhs)
        self._lu = la.lu_factor(matrix, overwrite_a=True)

    def _unseen_tractions(self) -> list[Array]:
        """Tractions (2 n,) whose resultant is the same at all points: none shows where the whole outer edge is held."""
        panels, p = self.panels, self.panels.p
        outer = np.repeat(panels.contour == 0, p)
        x, _ = rule(p)
        length = np.abs(panels.dz.reshape(-1, p)).sum(axis=1)
        # the resultant is a Legendre polynomial less one on every panel, which vanishes at the points
        slope = (legendre.legval(x, legendre.legder(np.eye(p + 1)[p])) * 2 / length[:, None]).ravel()
        modes = []
        for i in range(2):
            if self._held[outer, i].all():
                mode = np.zeros((panels.n, 2))
                mode[outer, i] = slope[outer]
                modes.append(mode.ravel() / np.linalg.norm(mode))
        return modes

    def _with_cracks(self, base: Array) -> Array:
        """The boundary's unknowns with cracks, by elimination of these; sets their jumps."""
        c = self.cracks
        assert c is not None
        beside = np.full(self.panels.n, -1)
        B = of_cracks(c, self.panels.z, beside).displacement(self.kappa).real()
        e = np.repeat(c.direction, c.p)
        own = of_cracks(c, c.z, np.repeat(np.arange(len(c.starts)), c.p))
        D = traction_of(own.P, own.Q, -1.0, e).real()
        P, Q = stress_of_boundary(self.panels, c.z)
        by_g, by_q = (traction_of(P, Q, S, e) for S in (-1.0, self.kappa))
        R = self._in_unknowns(by_g, by_q)
        known_q = self._to_q @ (self._known_t * 1j / (self.kappa + 1))
        traction = parts(by_g(self._known_g) + by_q(known_q))
        X = la.lu_solve(self._lu, B)
        jump = la.solve(D - R @ X, -traction - R @ base)
        self.c = jump[::2] + 1j * jump[1::2]
        return base - X @ jump

    def _take(self, solution: Array) -> None:
        """Densities from the unknowns."""
        parts = solution.reshape(-1, 2)
        self.g = self._known_g + np.where(self._held, 0.0, parts) @ [1, 1j]
        self.t = self._known_t + np.where(self._held, parts, 0.0) @ [1, 1j]
        self.q = self._to_q @ (self.t * 1j / (self.kappa + 1))

    def stress_intensities(self) -> Array:
        """K_I and K_II (k, 2) of every tip of the part, MPa sqrt(mm)."""
        c = self.cracks
        if c is None:
            return np.empty((0, 2))
        result = np.empty((len(self.part.tips), 2))
        slope = slope_at_tip(c.p)
        for k in np.flatnonzero(c.is_tip):
            along = c.ends[k] - c.starts[k]
            jump = slope @ self.c[k * c.p : (k + 1) * c.p] / np.sqrt(abs(along))
            K = np.conj(along) / abs(along) * np.sqrt(np.pi / 2) * jump
            result[c.tip[k]] = K.imag, K.real
        return result

    def panel_length(self, points: Array) -> Array:
        """Length (k,) of the panels next to points (k, 2), mm."""
        tree = cKDTree(np.column_stack([self.panels.z.real, self.panels.z.imag]))
        length = np.abs(np.diff(self.panels.ends, axis=1))[:, 0]
        # a whole smooth hole may be one panel's ends apart; its points are not
        length = np.maximum(length, np.abs(self.panels.dz).reshape(len(length), -1).sum(axis=1))
        return length[tree.query(points)[1] // self.panels.p]

    def reaction(self, condition: Condition) -> Array:
        """Force (2,) on the part along a stretch, N for each mm of thickness."""
        on = self._of_condition[condition]
        force = np.sum(self.t[on] * np.abs(self.panels.dz[on]))
        return np.array([force.real, force.imag])

    def displacement(self, points: Array) -> Array:
        """Displacements (k, 2) at points (k, 2), mm; beside the material those of the surface there."""

        def at_surface(here: Feet) -> Array:
            p = self.panels.p
            g = np.einsum("kp,kp->k", values_at(here.xi, p), self.g.reshape(-1, p)[here.panel])
            return self._scale * np.column_stack([g.real, g.imag])

        return self._by_depth(points, at_surface, self._displacement_inside)

    def _by_depth(
        self, points: Array, at_surface: Callable[[Feet], Array], inside: Callable[[Array], Array]
    ) -> Array:
        """A field (k, ...) at points (k, 2) by kernels, or next to a surface by the cubic in the depth.

        That goes through the surface's own value and three deeper ones, where kernels keep their digits.
        """
        at = feet(self.part, self.panels, points)
        length = np.abs(self.panels.dz.reshape(-1, self.panels.p)).sum(axis=1)[at.panel]
        share = np.maximum(at.depth, 0.0) / (BESIDE * length)
        near = np.flatnonzero(share < 1)
        far = np.setdiff1d(np.arange(len(points)), near)
        here = Feet(*(values[near] for values in at))
        samples = [at_surface(here)]
        for k in (1, 2, 3):
            z = here.foot + k / 3 * BESIDE * length[near] * 1j * here.tangent
            samples.append(inside(np.column_stack([z.real, z.imag])))
        x = 3 * share[near, None]
        weights = (
            -(x - 1) * (x - 2) * (x - 3) / 6,
            x * (x - 2) * (x - 3) / 2,
            -x * (x - 1) * (x - 3) / 2,
            x * (x - 1) * (x - 2) / 6,
        )
        result = np.empty((len(points), samples[0].shape[1]))
        result[far] = inside(points[far])
        result[near] = sum(weight * sample for weight, sample in zip(weights, samples, strict=True))
        return result

    def _displacement_inside(self, points: Array) -> Array:
        """Displacements (k, 2) by the kernels."""
        targets = points[:, 0] + 1j * points[:, 1]
        beside = np.full(len(targets), -1)
        by_g, by_q = displacement_of_boundary(self.panels, self.kappa, targets, beside)
        W = by_g(self.g) + by_q(self.q)
        if self.cracks is not None:
            W = W + of_cracks(self.cracks, targets, beside).displacement(self.kappa)(self.c)
        u = W / (2 * self.mu)
        return np.column_stack([u.real, u.imag])

    def stress(self, points: Array) -> Array:
        """Stress xx, yy, xy (k, 3) at points (k, 2), MPa; beside the material that of the surface there."""

        def at_surface(here: Feet) -> Array:
            return surface_stress(self.panels, here, self.g, self.t, self.E, self.nu, self._scale)

        return self._by_depth(points, at_surface, self._stress_inside)

    def _stress_inside(self, points: Array) -> Array:
        """Stress (k, 3) by the kernels."""
        targets = points[:, 0] + 1j * points[:, 1]
        P, Q = stress_of_boundary(self.panels, targets)
        one = P @ (self.g + self.q)
        other = Q @ (self.g + self.q) + P @ (self.kappa * self.q - self.g).conj()
        if self.cracks is not None:
            cracks = of_cracks(self.cracks, targets, np.full(len(targets), -1))
            one = one + cracks.P @ self.c
            other = other + cracks.Q @ self.c - cracks.P @ self.c.conj()
        mean, difference = 2 * one.real, other
        return np.column_stack([mean - difference.real, mean + difference.real, difference.imag])


def _check(part: Part) -> None:
    """Refuse what the engine does not do: notches across the outer edge, and parts in pieces."""
    inside = shapely.Polygon(part.outer).buffer(-part.tolerance)
    for k, hole in enumerate(part.holes):
        if not inside.covers(shapely.LinearRing(hole.polygon(OUTLINE_SAMPLES))):
            raise ValueError(
                f"holes[{k}] cuts the outer edge: boundary integrals do holes inside the part; use voxels or a "
                "body-fitted model"
            )
    if part.is_severed:
        raise ValueError(
            f"the cracks sever the part, in {len(part.pieces)} pieces: nothing holds them together"
        )
