"""The body without its cracks: panels, what is known at them, and the factorised base system."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

from slmm.boundary.densities import (
    Linear,
    displacement_of_boundary,
    displacement_of_highest,
    displacement_of_jumps,
    parts,
)
from slmm.boundary.elimination import Border
from slmm.boundary.panels import panelled
from slmm.boundary.rules import Array, Complex, highest, integration
from slmm.boundary.stretches import FINE, MouthGrading, boundary_of
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
        Gauss points on each panel.
    grading : MouthGrading
    ahead : sequence of complex
        Where tips may come to be, mm: panels are as short as these ask for, too.

    Attributes
    ----------
    panels : Panels
    known_t, known_q, known_jumps : ndarray, shape (n,), (n,), (c,)
        Tractions that are given, MPa, their resultants over kappa + 1, and those of the c closed curves.
    lu : tuple
        Of the base system.
    rigid : ndarray, shape (n, m)
        What the m free motions of rigid bodies on the surface are, each by 1 mm, as part of g.
    solution : ndarray, shape (2 n + m,)
        Unknowns without cracks: at the points, and by how much rigid bodies move, mm.
    border : Border
        What panels of cracks do to the base system and feel of it, of the cracks that were seen last.
    """

    def __init__(
        self,
        part: Part,
        material: Material,
        loading: Loading,
        p: int,
        grading: MouthGrading = FINE,
        ahead: Sequence[complex] = (),
    ) -> None:
        """Assemble and factorise."""
        check_in_one_piece(part)
        E, nu = material.plane_stress_equivalent
        self.part, self.loading, self.material, self.p, self.grading = part, loading, material, p, grading
        self.E, self.nu, self.mu, self.kappa = E, nu, shear_modulus(E, nu), kolosov(nu)
        self.scale = (self.kappa + 1) / (2 * self.mu)
        self.mouths = mouths_of(part)
        self.panels = panelled(
            boundary_of(part, self.mouths, loading, grading.side), part, [*tips_of(part), *ahead], p
        )
        self._set_conditions()
        self.border = Border.none(2 * self.panels.n + self.rigid.shape[1])
        self._factorise()

    def serves(self, part: Part) -> bool:
        """Whether a part with other cracks has the same outlines and mouths, and no tip too near a surface."""
        same = part.holes is self.part.holes and part.outer is self.part.outer
        if not same or mouths_of(part) != self.mouths:
            return False
        ends = self.panels.z.reshape(-1, self.p)
        length = self.panels.length
        return all((np.abs(ends - tip).min(axis=1) * TOO_NEAR >= length).all() for tip in tips_of(part))

    def _set_conditions(self) -> None:
        """What is known at every point: displacements as part of g, and tractions."""
        panels, n = self.panels, self.panels.n
        self.held = np.zeros((n, 2), dtype=bool)
        known, traction = np.zeros((n, 2)), np.zeros((n, 2))
        points = np.column_stack([panels.z.real, panels.z.imag])
        self.of_condition: dict[Condition, NDArray[np.bool_]] = {}
        for condition in self.loading:
            on = condition.on(points)
            self.of_condition[condition] = on
            for i, component in enumerate(condition.displacement):
                if component is not None:
                    self.held[on, i] = True
                    known[on, i] = component(points[on]) * 2 * self.mu / (self.kappa + 1)
            outward = np.column_stack([panels.tangent.imag, -panels.tangent.real])[on]
            traction[on] += condition.tractions(outward)
        bodies = [np.zeros((n, 2, 0))]
        for body in self.loading.stiff:
            on = np.any([self.of_condition[c] for c in self.loading if c.stiff is body], axis=0)
            bodies.append(np.where(on[:, None, None], body.motions(points), 0.0))
        self._motions = np.concatenate(bodies, axis=2)
        self.rigid = np.einsum("nim,i->nm", self._motions, [1, 1j]) * 2 * self.mu / (self.kappa + 1)
        traction[self.held] = 0.0
        self.known_g = known @ [1, 1j]
        self.known_t = traction @ [1, 1j]

    @cached_property
    def _contours(self) -> list[slice]:
        """Panels of each closed curve, which lie one behind the other."""
        first = np.flatnonzero(np.diff(self.panels.contour, prepend=-1)).tolist()
        return [slice(a, b) for a, b in pairwise([*first, len(self.panels.ends)])]

    def resultants(self, values: Array) -> Array:
        """Integrals (n,) of values (n,) along each closed curve up to each point."""
        p = self.panels.p
        local = integration(p)
        at = values.reshape(-1, p)
        half = 0.5 * self.panels.length[:, None]
        result, whole = half * (at @ local[:p].T), half[:, 0] * (at @ local[p])
        for panels in self._contours:
            result[panels] += (np.cumsum(whole[panels]) - whole[panels])[:, None]
        return result.ravel()

    def _by_values(self, by_resultants: Complex) -> Complex:
        """What is given by resultants with weights (t, n), as weights (t, h) of the values at held points."""
        p = self.panels.p
        local = integration(p)
        half = 0.5 * self.panels.length
        of_point = self.held_rows // p
        found = []
        for panels in self._contours:  # integrals begin anew on each
            which = np.unique(of_point[(of_point >= panels.start) & (of_point < panels.stop)])
            if not len(which):
                continue
            at = by_resultants[:, panels.start * p : panels.stop * p].reshape(len(by_resultants), -1, p)
            whole = at.sum(axis=2)
            later = np.cumsum(whole[:, ::-1], axis=1)[:, ::-1] - whole
            mine = which - panels.start
            values = (at[:, mine] @ local[:p] + later[:, mine, None] * local[p]) * half[which, None]
            place = (which[:, None] * p + np.arange(p)).ravel()
            found.append(values.reshape(len(at), -1)[:, np.isin(place, self.held_rows)])
        return np.concatenate(found, axis=1)

    @cached_property
    def held_rows(self) -> NDArray[np.int64]:
        """Points (h,) at which a displacement is prescribed."""
        return np.flatnonzero(self.held.any(axis=1))

    @cached_property
    def to_jumps(self) -> Array:
        """From tractions (n,) to what q is short of after each closed curve, over i/(kappa + 1); (c, n)."""
        of_point = np.repeat(self.panels.contour, self.panels.p)
        return np.where(of_point == np.unique(of_point)[:, None], np.abs(self.panels.dz), 0.0)

    @cached_property
    def begins(self) -> Complex:
        """Where each closed curve begins, (c,)."""
        first = np.unique(self.panels.contour, return_index=True)[1]
        return np.asarray(self.panels.ends[first, 0])

    def by_tractions(self, by_q: Linear, by_jumps: Linear) -> Linear:
        """By the tractions at held points, what is given by q and its jumps."""
        rows, unit = self.held_rows, 1j / (self.kappa + 1)
        if not len(rows):
            none = np.empty((len(by_q.one), 0), dtype=complex)
            return Linear(none, none)
        to_jumps = self.to_jumps[:, rows]
        return Linear(
            unit * (self._by_values(by_q.one) + by_jumps.one @ to_jumps),
            np.conj(unit) * (self._by_values(by_q.other) + by_jumps.other @ to_jumps),
        )

    def displacement_by_jumps(self, targets: Complex) -> Linear:
        """W at targets (t,) by the jumps of q."""
        size = 2 * float(np.abs(self.panels.z - self.panels.z.mean()).max())
        return displacement_of_jumps(self.kappa, self.begins, size, targets)

    def in_unknowns(self, by_g: Linear, by_t: Linear) -> Array:
        """Real matrix (2 t, 2 n + m) in the unknowns: displacements at the points or, where these are held, tractions.

        The last ones are those of rigid bodies.
        """
        matrix = by_g.real()
        place = np.ravel(2 * self.held_rows[:, None] + np.arange(2))
        which = self.held.ravel()[place]
        matrix[:, place[which]] = by_t.real()[:, which]
        if not self.rigid.shape[1]:
            return matrix
        return np.concatenate([matrix, *(parts(by_g(rigid))[:, None] for rigid in self.rigid.T)], axis=1)

    def _unseen(self) -> Linear:
        """W at all points by what q has on held panels and does not show at any: their P_p.

        It would else be free to grow: q jumps where a held stretch ends; such jumps are forces at corners, which hardly
        any point feels.
        """
        panels, p = self.panels, self.panels.p
        own = np.arange(panels.n) // p
        held = np.unique(self.held_rows // p)
        share = 0.5 * panels.length[held, None] * highest(p)
        spread = np.zeros((len(held), panels.n), dtype=complex)
        np.put_along_axis(spread, held[:, None] * p + np.arange(p), share * (1j / (self.kappa + 1)), axis=1)
        spread = spread[:, self.held_rows]
        of_held = displacement_of_highest(panels, self.kappa, held, panels.z, own)
        return Linear(of_held.one @ spread, of_held.other @ spread.conj())

    def _factorise(self) -> None:
        """The base system: at every point the limit of W from inside is (kappa + 1) g."""
        n, unit = self.panels.n, 1j / (self.kappa + 1)
        by_g, by_q = displacement_of_boundary(self.panels, self.kappa, self.panels.z, np.arange(n))
        by_jumps = self.displacement_by_jumps(self.panels.z)
        by_g = Linear(by_g.one - (self.kappa + 1) * np.eye(n), by_g.other)
        matrix = self.in_unknowns(by_g, self.by_tractions(by_q, by_jumps).plus(self._unseen()))
        self.known_q, self.known_jumps = (
            self.resultants(self.known_t * unit),
            self.to_jumps @ (self.known_t * unit),
        )
        known = by_g(self.known_g) + by_q(self.known_q) + by_jumps(self.known_jumps)
        points = np.column_stack([self.panels.z.real, self.panels.z.imag])
        free = free_motions(points, self.held)
        weight = np.repeat(np.abs(self.panels.dz), 2)
        self._check_balance(free, weight)
        for mode in free.T:
            matrix += (self.kappa + 1) / weight.sum() * np.outer(mode, mode * weight)
        rhs = -parts(known)
        if self.rigid.shape[1]:
            # the tractions on a rigid body have its resultants
            rows = np.zeros((self.rigid.shape[1], matrix.shape[1]))
            rows[:, : 2 * n] = (self._motions.reshape(2 * n, -1) * weight[:, None]).T
            matrix = np.concatenate([matrix, rows])
            rhs = np.concatenate([rhs, *(body.resultants for body in self.loading.stiff)])
        self.lu = la.lu_factor(matrix, overwrite_a=True)
        self.solution = la.lu_solve(self.lu, rhs)

    def _check_balance(self, free: Array, weight: Array) -> None:
        """Refuse forces that do work on motions that nothing holds."""
        force = parts(self.known_t) * weight
        if np.any(np.abs(free.T @ force) > 2 * UNBALANCED * np.abs(force).sum()):
            x, y = force.reshape(-1, 2).sum(axis=0)
            raise ValueError(
                f"load: the part is free to move, and what acts on it does not balance: forces of ({x:.4g}, {y:.4g}) N "
                "for each mm of thickness are left, or a moment; prescribe displacements"
            )


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
