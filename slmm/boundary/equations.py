"""The equations of a body without cracks: at every point of its panels the limit of W from inside is (kappa + 1) g."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.densities import (
    Linear,
    displacement_of_boundary,
    displacement_of_highest,
    displacement_of_jumps,
)
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex, highest, integration


class Equations:
    """What is unknown at the points of panels, and what it causes.

    Parameters
    ----------
    panels : Panels
        Of whole closed curves, or of stretches of such.
    held : ndarray, shape (n, 2) of bool
        Whether displacements along x and y are prescribed.
    acted : ndarray, shape (n,) of bool
        Where tractions are, known or not.
    kappa : float
    """

    def __init__(
        self, panels: Panels, held: NDArray[np.bool_], acted: NDArray[np.bool_], kappa: float
    ) -> None:
        """Compute nothing yet."""
        self.panels, self.held, self.acted, self.kappa = panels, held, acted, kappa

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
    def _acted(self) -> list[slice]:
        """Panels of the closed curves on which anything acts."""
        acted = np.asarray(self.acted.reshape(-1, self.panels.p).any(axis=1))
        return [panels for panels in self._contours if acted[panels].any()]

    @cached_property
    def to_jumps(self) -> Array:
        """From tractions (n,) to what q is short of after each closed curve, over i/(kappa + 1); (c, n)."""
        result = np.zeros((len(self._acted), self.panels.n))
        for k, panels in enumerate(self._acted):
            points = slice(panels.start * self.panels.p, panels.stop * self.panels.p)
            result[k, points] = np.abs(self.panels.dz[points])
        return result

    @cached_property
    def begins(self) -> Complex:
        """Where each closed curve on which anything acts begins, (c,)."""
        return self.panels.ends[np.array([panels.start for panels in self._acted], dtype=int), 0]

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
        """Real matrix (2 t, 2 n) in the unknowns: displacements at the points or, where these are held, tractions."""
        matrix = by_g.real()
        place = np.ravel(2 * self.held_rows[:, None] + np.arange(2))
        which = self.held.ravel()[place]
        matrix[:, place[which]] = by_t.real()[:, which]
        return matrix

    @cached_property
    def unseen(self) -> tuple[Linear, Array]:
        """W at all points by the P_p that q has on m held panels and shows at none, and these (m, h) by tractions.

        They would else be free to grow: q jumps where a held stretch ends; such jumps are forces at corners, which
        hardly any point feels.
        """
        panels, p = self.panels, self.panels.p
        own = np.arange(panels.n) // p
        held = np.unique(self.held_rows // p)
        share = 0.5 * panels.length[held, None] * highest(p)
        spread = np.zeros((len(held), panels.n), dtype=complex)
        np.put_along_axis(spread, held[:, None] * p + np.arange(p), share * (1j / (self.kappa + 1)), axis=1)
        return displacement_of_highest(panels, self.kappa, held, panels.z, own), spread[:, self.held_rows]

    def matrix(self) -> tuple[Array, tuple[Linear, Linear, Linear]]:
        """Real matrix (2 n, 2 n) of the equations, and what they say by known g, q and jumps of q."""
        n = self.panels.n
        by_g, by_q = displacement_of_boundary(self.panels, self.kappa, self.panels.z, np.arange(n))
        by_jumps = self.displacement_by_jumps(self.panels.z)
        by_g = Linear(by_g.one - (self.kappa + 1) * np.eye(n), by_g.other)
        of_held, spread = self.unseen
        by_t = self.by_tractions(by_q, by_jumps)
        by_t = by_t.plus(Linear(of_held.one @ spread, of_held.other @ spread.conj()))
        return self.in_unknowns(by_g, by_t), (by_g, by_q, by_jumps)
