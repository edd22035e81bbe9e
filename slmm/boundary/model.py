"""A part by boundary integrals: densities on its outlines and cracks, and what follows from them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from slmm.boundary.body import Body, check_in_one_piece
from slmm.boundary.crack_panels import CrackPanels, at_tip, crack_panels, slope_at_tip
from slmm.boundary.densities import (
    Targets,
    displacement_of_boundary,
    displacement_of_jumps,
    of_cracks,
    stress_of_boundary,
    stress_of_jumps,
)
from slmm.boundary.elimination import eliminated
from slmm.boundary.faces import half_closed, halved, held_closed, opening_of, overlap
from slmm.boundary.rules import Array, Complex, values_at
from slmm.boundary.stretches import FINE, Grading
from slmm.boundary.surface import Feet, feet, hoop_stress, surface_stress
from slmm.mechanics.material import Material
from slmm.mechanics.nearest import Nearest
from slmm.part.part import Part
from slmm.scene.loading import Condition, Loading

#: how much higher the order is by which errors are told, and what covers them: 95 % of those of K and of the stress on
#: random plates are below so many differences (chosen on validation/boundary_errors.py)
HIGHER, COVERS = 2, 4.0
#: weights of the boundary at places that are computed at once: 32 MB of each kind (chosen)
MOST_WEIGHTS = 2_000_000
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
        Gauss points on each panel of the boundary, and of the cracks.
    body : Body, optional
        One that serves the part.
    grading : Grading
    contact : bool
        Whether faces that would overlap hold each other, without friction.

    Attributes
    ----------
    panels : Panels
    cracks : CrackPanels or None
    g, q : ndarray, shape (n,)
        Displacement and resultant force along each panel at the boundary's points, times 2 mu/(kappa + 1) and
        1/(kappa + 1).
    behind : ndarray, shape (k,)
        The resultants of the panels on which anything is held or acts.
    c : ndarray, shape (m,)
        Displacement jump at the points of the cracks, scaled as g.
    touching : ndarray, shape (m,) of bool
        Where their faces hold each other.
    """

    def __init__(
        self,
        part: Part,
        material: Material,
        loading: Loading,
        p: int = 8,
        crack_p: int = 8,
        body: Body | None = None,
        contact: bool = False,
        grading: Grading = FINE,
    ) -> None:
        """Assemble, factorise and solve; on a ``body`` that serves the part, only what its cracks need."""
        self.crack_p, self.contact = crack_p, contact
        self._finer_before: BoundaryModel | None = None
        self.part = part
        self.body = body or Body(part, material, loading, p, grading)
        self.panels = self.body.panels
        self.cracks: CrackPanels | None = None
        self.c = np.empty(0, dtype=complex)
        self.touching = np.empty(0, dtype=bool)
        if part.cracks:
            self.cracks = crack_panels(part, self.panels.z, crack_p, self.body.grading.crack)
        self._take(self._solved())

    def with_cracks_of(self, part: Part) -> BoundaryModel:
        """The same with other cracks, as after growth; the factorised body stays where it serves."""
        old = self.body
        body = old if old.serves(part) else old.divided(part)
        if any("crack" in (crack.start.kind, crack.end.kind) for crack in part.cracks):
            check_in_one_piece(part)  # without a new mouth only cracks that meet can sever it
        grown = BoundaryModel(
            part, old.material, old.loading, old.p, self.crack_p, body, self.contact, old.grading
        )
        grown._finer_before = self.__dict__.get("finer", self._finer_before)
        return grown

    @cached_property
    def finer(self) -> BoundaryModel:
        """The same with more points on each panel; when cracks grow its factorised body stays, too."""
        if self._finer_before is not None:
            return self._finer_before.with_cracks_of(self.part)
        body = self.body
        orders = body.p + HIGHER, self.crack_p + HIGHER
        return BoundaryModel(
            self.part, body.material, body.loading, *orders, contact=self.contact, grading=body.grading
        )

    def with_error(self, figure: Callable[[BoundaryModel], Array]) -> tuple[Array, Array]:
        """A figure (k, components) of the model, and the estimated error (k,) of its rows by the finer model.

        Examples
        --------
        >>> from slmm.mechanics.material import Material
        >>> from slmm.part.part import Part
        >>> from slmm.scene.loading import plate_loading
        >>> plate = Part.plate(10.0, 20.0).with_crack(np.array([[0.0, 10.0], [3.0, 10.0]]))
        >>> model = BoundaryModel(plate, Material.from_name("PMMA"), plate_loading(10.0, 20.0, stress=1.0))
        >>> K, error = model.with_error(BoundaryModel.stress_intensities)
        >>> bool(error[0] < 1e-4 * K[0, 0])
        True
        """
        value = figure(self)
        return value, COVERS * np.linalg.norm(figure(self.finer) - value, axis=1)

    def _solved(self) -> Array:
        """The boundary's unknowns, cracks and divided panels eliminated; sets the jumps of cracks."""
        body = self.body
        while True:
            where = eliminated(body, self.cracks)
            border = body.border
            y = border.solve()
            if self.cracks is None:
                break
            self.touching = np.zeros(len(self.cracks.z), dtype=bool)
            along = np.repeat(self.cracks.direction, self.cracks.p)
            if self.contact and overlap(y[where.cracks], along):
                y, self.touching = held_closed(border.factors.solve, y, where.cracks, along)
            jump = y[where.cracks]
            self.c = jump[::2] + 1j * jump[1::2]
            long = half_closed(self.cracks, self.touching)
            if not long.any():
                break
            self.cracks = halved(self.cracks, long)
        return body.unknowns(body.base.solution - y @ border.columns, y[where.panels])

    def _take(self, solution: Array) -> None:
        """Densities from the unknowns."""
        known = self.body.known
        at_points, motions = np.split(solution, [2 * self.panels.n])
        components = at_points.reshape(-1, 2)
        self.g = known.g + known.rigid @ motions + np.where(known.held, 0.0, components) @ [1, 1j]
        self.t = known.t + np.where(known.held, components, 0.0) @ [1, 1j]
        self.q, self.behind = self.body.resultants(self.t)

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
            # faces that hold each other up to the tip leave no mode I
            result[c.tip[k]] = 0.0 if self.touching[k * c.p] else K.imag, K.real
        return result

    def t_stresses(self) -> Array:
        """T-stress (k,) at every tip of the part, MPa: the stress along the crack that does not grow towards the tip.

        It is what the mean of both faces' stress along the crack tends to: all that is singular differs in sign there.
        """
        c = self.cracks
        result = np.empty(len(self.part.tips))
        if c is None:
            return result
        along = at_tip(c.p)
        for k in np.flatnonzero(c.is_tip):
            targets = c.z[k * c.p : (k + 1) * c.p]
            own = of_cracks(c, targets, np.full(c.p, k))
            P = self._from_boundary(targets)[0] + own.P @ self.c
            result[c.tip[k]] = along @ (4 * P.real)
        return result

    def energy_release_rates(self) -> Array:
        """G, which is J, (k,) of every tip of the part, N/mm."""
        K = self.stress_intensities()
        return (K**2).sum(axis=1) / self.body.E

    def opening(self) -> tuple[Array, Array]:
        """Points (m, 2) of the cracks, and how far their faces are apart there (m,), mm; negative if they overlap."""
        c = self.cracks
        if c is None:
            return np.empty((0, 2)), np.empty(0)
        opening = opening_of(self.c, np.repeat(c.direction, c.p)) * self.body.scale
        return np.column_stack([c.z.real, c.z.imag]), opening

    def panel_length(self, points: Array) -> Array:
        """Length (k,) of the panels next to points (k, 2), mm."""
        nodes = Nearest(np.column_stack([self.panels.z.real, self.panels.z.imag]))
        length = np.abs(np.diff(self.panels.ends, axis=1))[:, 0]
        # a whole smooth hole may be one panel's ends apart; its points are not
        length = np.maximum(length, np.abs(self.panels.dz).reshape(len(length), -1).sum(axis=1))
        return length[nodes.numbers(points, 1)[:, 0] // self.panels.p]

    def reaction(self, condition: Condition) -> Array:
        """Force (2,) on the part along a stretch, N for each mm of thickness."""
        on = self.body.known.of_condition[condition]
        force = np.sum(self.t[on] * np.abs(self.panels.dz[on]))
        return np.array([force.real, force.imag])

    @property
    def work(self) -> float:
        """Integral of traction times displacement around the part, N mm for each mm of thickness.

        Twice the energy that is stored.
        """
        return float(self.body.scale * np.sum(np.abs(self.panels.dz) * (self.t * self.g.conj()).real))

    @cached_property
    def hoop(self) -> Array:
        """Normal stress (n,) along the boundary at the panels' points, MPa: from densities alone, without kernels."""
        return hoop_stress(self.panels, self.g, self.t, self.body.E, self.body.nu, self.body.scale)

    def displacement(self, points: Array) -> Array:
        """Displacements (k, 2) at points (k, 2), mm; beside the material those of the surface there."""

        def at_surface(here: Feet) -> Array:
            p = self.panels.p
            g = np.einsum("kp,kp->k", values_at(here.xi, p), self.g.reshape(-1, p)[here.panel])
            return self.body.scale * np.column_stack([g.real, g.imag])

        return self._by_depth(points, at_surface, self._displacement_inside)

    def _by_depth(
        self, points: Array, at_surface: Callable[[Feet], Array], inside: Callable[[Array], Array]
    ) -> Array:
        """A field (k, ...) at points (k, 2) by kernels, or next to a surface by the cubic in the depth.

        That goes through the surface's own value and three deeper ones, where kernels keep their digits.
        """
        at = feet(self.part, self.panels, points)
        length = self.panels.length[at.panel]
        share = np.maximum(at.depth, 0.0) / (BESIDE * length)
        near = np.flatnonzero(share < 1)
        far = np.setdiff1d(np.arange(len(points)), near)
        here = Feet(*(values[near] for values in at))
        samples = [at_surface(here)]
        for k in (1, 2, 3):
            z = here.foot + k / 3 * BESIDE * length[near] * 1j * here.tangent
            samples.append(self._in_turns(np.column_stack([z.real, z.imag]), inside))
        x = 3 * share[near, None]
        weights = (
            -(x - 1) * (x - 2) * (x - 3) / 6,
            x * (x - 2) * (x - 3) / 2,
            -x * (x - 1) * (x - 3) / 2,
            x * (x - 1) * (x - 2) / 6,
        )
        result = np.empty((len(points), samples[0].shape[1]))
        result[far] = self._in_turns(points[far], inside)
        result[near] = sum(weight * sample for weight, sample in zip(weights, samples, strict=True))
        return result

    def _in_turns(self, points: Array, inside: Callable[[Array], Array]) -> Array:
        """A field (k, ...) at points (k, 2), of which so many are taken at once that weights stay small."""
        turns = -(-len(points) * self.panels.n // MOST_WEIGHTS)
        return np.concatenate([inside(of) for of in np.array_split(points, max(1, turns))])

    def _displacement_inside(self, points: Array) -> Array:
        """Displacements (k, 2) by the kernels."""
        targets = points[:, 0] + 1j * points[:, 1]
        beside, tractions = Targets.beside(targets), self.body.base.tractions
        by_g, by_q = displacement_of_boundary(self.panels, self.body.kappa, beside)
        behind = displacement_of_jumps(self.body.kappa, tractions.behind, tractions.size, targets)
        W = by_g(self.g) + by_q(self.q) + behind(self.behind)
        if self.cracks is not None:
            W = W + of_cracks(self.cracks, targets, beside.own).displacement(self.body.kappa)(self.c)
        u = W / (2 * self.body.mu)
        return np.column_stack([u.real, u.imag])

    def stress(self, points: Array) -> Array:
        """Stress xx, yy, xy (k, 3) at points (k, 2), MPa; beside the material that of the surface there."""

        def at_surface(here: Feet) -> Array:
            return surface_stress(
                self.panels, here, self.g, self.t, self.body.E, self.body.nu, self.body.scale
            )

        return self._by_depth(points, at_surface, self.stress_inside)

    def _from_boundary(self, targets: Complex) -> tuple[Complex, Complex]:
        """P and Q (t,) of the boundary's densities at targets (t,)."""
        P, Q = stress_of_boundary(self.panels, targets)
        P_behind, Q_behind = stress_of_jumps(self.body.base.tractions.behind, targets)
        one = P @ (self.g + self.q) + P_behind @ self.behind
        other = Q @ (self.g + self.q) + P @ (self.body.kappa * self.q - self.g).conj()
        return one, other + Q_behind @ self.behind + P_behind @ (self.body.kappa * self.behind).conj()

    def stress_inside(self, points: Array) -> Array:
        """Stress xx, yy, xy (k, 3) at points (k, 2) that lie `BESIDE` panels deep at least, MPa, by the kernels."""
        targets = points[:, 0] + 1j * points[:, 1]
        one, other = self._from_boundary(targets)
        if self.cracks is not None:
            P, Q = of_cracks(self.cracks, targets, np.full(len(targets), -1)).stress()
            one = one + P @ self.c
            other = other + Q @ self.c - P @ self.c.conj()
        mean, difference = 2 * one.real, other
        return np.column_stack([mean - difference.real, mean + difference.real, difference.imag])
