"""The body without its cracks: panels, what is known at them, and the factorised base system."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.base_system import MOST_FACTORISED, BaseSystem, Factorised, Iterative, WithRigid
from slmm.boundary.densities import parts
from slmm.boundary.elimination import Border
from slmm.boundary.equations import Equations
from slmm.boundary.panels import panelled
from slmm.boundary.rules import Array
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


class Body(Equations):
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
    system : BaseSystem
        What solves for them.
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
        self._solve()

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
        held = np.zeros((n, 2), dtype=bool)
        known, traction = np.zeros((n, 2)), np.zeros((n, 2))
        points = np.column_stack([panels.z.real, panels.z.imag])
        self.of_condition: dict[Condition, NDArray[np.bool_]] = {}
        for condition in self.loading:
            on = condition.on(points)
            self.of_condition[condition] = on
            for i, component in enumerate(condition.displacement):
                if component is not None:
                    held[on, i] = True
                    known[on, i] = component(points[on]) * 2 * self.mu / (self.kappa + 1)
            outward = np.column_stack([panels.tangent.imag, -panels.tangent.real])[on]
            traction[on] += condition.tractions(outward)
        bodies = [np.zeros((n, 2, 0))]
        for body in self.loading.stiff:
            on = np.any([self.of_condition[c] for c in self.loading if c.stiff is body], axis=0)
            bodies.append(np.where(on[:, None, None], body.motions(points), 0.0))
        self._motions = np.concatenate(bodies, axis=2)
        self.rigid = np.einsum("nim,i->nm", self._motions, [1, 1j]) * 2 * self.mu / (self.kappa + 1)
        traction[held] = 0.0
        self.known_g = known @ [1, 1j]
        self.known_t = traction @ [1, 1j]
        Equations.__init__(self, panels, held, held.any(axis=1) | (self.known_t != 0), self.kappa)

    def _solve(self) -> None:
        """The base system, by its factors or iteratively, and its solution."""
        unit = 1j / (self.kappa + 1)
        self.known_q = self.resultants(self.known_t * unit)
        self.known_jumps = self.to_jumps @ (self.known_t * unit)
        points = np.column_stack([self.panels.z.real, self.panels.z.imag])
        free = free_motions(points, self.held)
        weight = np.repeat(np.abs(self.panels.dz), 2)
        self._check_balance(free, weight)
        known = self.known_g, self.known_q, self.known_jumps
        kind = Factorised if self.panels.n <= MOST_FACTORISED else Iterative
        self.system: BaseSystem = kind(self, known, free, self.rigid)
        if self.rigid.shape[1]:
            felt = self._motions.reshape(len(weight), -1) * weight[:, None]
            resultants = np.concatenate([body.resultants for body in self.loading.stiff])
            self.system = WithRigid(self.system, felt.T, resultants)
        self.solution = self.system.solve(self.system.right)

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
