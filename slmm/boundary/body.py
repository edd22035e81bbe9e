"""The body without its cracks: its panels, and the factorised system that serves them."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.base_system import BaseSystem
from slmm.boundary.border import Border
from slmm.boundary.conditions import known_at
from slmm.boundary.panelling import Panelling
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex
from slmm.boundary.stretches import FINE, Grading, boundary_of
from slmm.mechanics.material import Material
from slmm.mechanics.stress import kolosov, shear_modulus
from slmm.part.part import Part
from slmm.scene.loading import Loading

#: unknowns of changed panels over those of the factorised ones, beyond which all is factorised anew; chosen by the time
MOST_CHANGED = 1.0
#: where all is iterated a crack may grow towards a surface until panels there are so many times as long as its tip asks
#: for (chosen)
TOO_NEAR = 1.5
#: between the directions of two pins that are one; round-off
SAME_BEARING = 1e-12


class Body:
    """A part's outlines, with panels that end at the mouths of its cracks.

    Parameters
    ----------
    part : Part
        Its cracks count by their mouths and tips alone.
    material : Material
    loading : Loading
    p : int
        Gauss points on each panel; an even number where an edge rolls.
    grading : Grading
    ahead : sequence of complex
        Where tips may come to be, mm: panels are as short as these ask for, too.

    Attributes
    ----------
    panels : Panels
    base : BaseSystem
        The factorised system of these panels, or of those before some of them were divided.
    border : Border
        What divided panels and cracks do to the base system and feel of it, of those that were seen last.
    of_base : ndarray, shape (m,) of int
        Which panel of the base system each one is, -1 for none.
    removed : ndarray, shape (k,) of int
        Panels of the base system that are divided.
    """

    def __init__(
        self,
        part: Part,
        material: Material,
        loading: Loading,
        p: int,
        grading: Grading = FINE,
        ahead: Sequence[complex] = (),
    ) -> None:
        """Assemble and factorise."""
        check_in_one_piece(part)
        E, nu = material.plane_stress_equivalent
        self.loading, self.material, self.p, self.grading = loading, material, p, grading
        self.E, self.nu, self.mu, self.kappa = E, nu, shear_modulus(E, nu), kolosov(nu)
        self.scale = (self.kappa + 1) / (2 * self.mu)
        self.part, self.mouths = part, mouths_of(part)
        side = float(np.ptp(part.outer, axis=0).min())
        curves = Panelling(boundary_of(part, loading), side, part.tolerance, grading)
        self._curves = curves.with_mouths(self.mouths)
        tips = np.concatenate([tips_of(part), np.array(ahead, dtype=complex)])
        self._take(self._curves.divided(curves.first(p), tips))
        if p % 2 and np.any(self.known.held.any(axis=1) & ~self.known.held.all(axis=1)):
            raise ValueError(
                f"p = {p}: must be even; an odd number of points on a straight edge that rolls leaves the equations "
                "singular"
            )
        self.base = BaseSystem(self.panels, self.known, self.kappa, float(np.ptp(part.outer, axis=0).max()))
        self.border = Border(self.base)
        self.of_base, self.removed = np.arange(len(self.panels.intervals)), np.empty(0, dtype=int)

    def under(self, loading: Loading) -> Body:
        """The same under other loads; where they act on the same stretches, what is factorised stays."""
        known = known_at(self.panels, loading, self.scale)
        ours, theirs = _bearings(self.loading), _bearings(loading)
        same = self.base.panels is self.panels and ours.shape == theirs.shape
        same = same and bool(np.abs(ours - theirs).max(initial=0.0) < SAME_BEARING)
        base = self.base.under(known) if same else None
        if base is None:
            return Body(self.part, self.material, loading, self.p, self.grading)
        body = copy.copy(self)
        body.loading, body.known, body.base, body.border = loading, known, base, Border(base)
        return body

    def _take(self, panels: Panels) -> None:
        self.panels = panels
        self.known = known_at(panels, self.loading, self.scale)

    def serves(self, part: Part) -> bool:
        """Whether a part with other cracks has the same outlines and mouths, and no tip too near a surface."""
        if not self._is_around(part) or set(mouths_of(part)) != set(self.mouths):
            return False
        ends = self.panels.z.reshape(-1, self.p)
        length = self.panels.length
        # where all is iterated another body is dear
        nearness = self.grading.tip * (TOO_NEAR if self.base.is_iterative else 1.0)
        return all((np.abs(ends - tip).min(axis=1) * nearness >= length).all() for tip in tips_of(part))

    def _is_around(self, part: Part) -> bool:
        return part.holes is self.part.holes and part.outer is self.part.outer

    def divided(self, part: Part, ahead: Sequence[complex] = ()) -> Body:
        """One that serves a part with other cracks: panels are divided where these ask for it, the others stay.

        All are factorised anew where too many have changed, or those on which anything is held or acts, and there are
        other iterations where all is iterated.

        Parameters
        ----------
        part : Part
        ahead : sequence of complex
            Where tips may come to be, mm.
        """
        mouths = mouths_of(part)
        if self._is_around(part) and set(mouths) >= set(self.mouths) and not self.base.is_iterative:
            check_in_one_piece(part)
            body = copy.copy(self)
            body.part, body.mouths = part, mouths
            for name in ("acted_points", "outside"):
                body.__dict__.pop(name, None)
            body._curves = self._curves.with_mouths([z for z in mouths if z not in self.mouths])
            tips = np.concatenate([tips_of(part), np.array(ahead, dtype=complex)])
            body._take(body._curves.divided(self.panels, tips))
            place = {interval.key: k for k, interval in enumerate(self.base.panels.intervals)}
            of_base = [place.get(interval.key, -1) for interval in body.panels.intervals]
            body.of_base = np.array(of_base)
            body.removed = np.setdiff1d(np.arange(len(place)), body.of_base)
            changed = len(body.removed) + np.count_nonzero(body.of_base < 0)
            if not np.isin(body.removed, self.base.acted).any() and changed <= MOST_CHANGED * len(place):
                return body
        return Body(part, self.material, self.loading, self.p, self.grading, ahead)

    @cached_property
    def outside(self) -> Panels:
        """The panels that the base system has not."""
        return self.panels.chosen(np.flatnonzero(self.of_base < 0))

    @cached_property
    def acted_points(self) -> NDArray[np.int64]:
        """Points (h,) on panels with tractions, in the order of `base`."""
        place = np.empty(len(self.base.panels.intervals), dtype=int)
        place[self.of_base[self.of_base >= 0]] = np.flatnonzero(self.of_base >= 0)
        return np.asarray((place[self.base.acted][:, None] * self.p + np.arange(self.p)).ravel())

    def resultants(self, t: Complex) -> tuple[Complex, Complex]:
        """Resultants of tractions (n,) along each panel (n,), over kappa + 1, and behind those of `base.acted`."""
        q = np.zeros(len(t), dtype=complex)
        q[self.acted_points], behind = self.base.tractions.resultants(t[self.acted_points])
        return q, behind

    def unknowns(self, solution: Array, of_divided: Array) -> Array:
        """Unknowns (2 n + m,) from those of the base system and of the panels that are none of its own, in turn."""
        result = np.empty((len(self.of_base), 2 * self.p))
        stays = self.of_base >= 0
        at_points, motions = np.split(solution, [self.base.unknowns])
        result[stays] = at_points.reshape(-1, 2 * self.p)[self.of_base[stays]]
        result[~stays] = of_divided.reshape(-1, 2 * self.p)
        return np.concatenate([result.ravel(), motions])


def mouths_of(part: Part) -> list[complex]:
    """Where cracks end on surfaces."""
    return [
        complex(*crack.points[k])
        for crack in part.cracks
        for k, end in ((0, crack.start), (-1, crack.end))
        if end.kind == "surface"
    ]


def tips_of(part: Part) -> Complex:
    """Where cracks have tips."""
    return np.array([complex(*line[-1]) for line in part.tips], dtype=complex)


def check_in_one_piece(part: Part) -> None:
    """Refuse a part that its cracks sever."""
    if part.is_severed:
        raise ValueError(
            f"the cracks sever the part, in {len(part.pieces)} pieces: nothing holds them together"
        )


def _bearings(loading: Loading) -> Array:
    """Into which directions the pins of conditions press (k, 2), 0 of others; panels end where that pressure does."""
    pins = np.array([condition.bearing for condition in loading], dtype=float).reshape(-1, 2)
    return pins / np.maximum(np.linalg.norm(pins, axis=1, keepdims=True), 1e-300)
