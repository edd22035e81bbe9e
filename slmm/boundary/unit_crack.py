"""A straight crack of unit length from a surface: where its jumps are, and what they cause along it."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from slmm.boundary.crack_panels import CrackPanels, slope_at_tip, straight_rule, tip_rule
from slmm.boundary.densities import of_cracks, traction_of
from slmm.boundary.mirrored import Tangent, image_tractions
from slmm.boundary.rules import Array, rule, values_at

#: points on either of its panels, and where these meet: K of an edge crack has six digits (chosen)
POINTS, BREAK = 8, 0.2
#: the panel at the mouth is halved so many times for what is reflected there, and points on each part: so that the
#: rule adds nothing to the error (chosen)
HALVED, FINE = 5, 8


class UnitCrack(NamedTuple):
    """Jumps on a crack of unit length, along it and across in turn.

    Attributes
    ----------
    x, weight : ndarray, shape (n,)
        Places of the jumps, from the mouth, and the weights of a rule.
    own : ndarray, shape (2 n, 2 n)
        Tractions at these places on the left face's side by jumps, in an endless plane.
    fine : ndarray, shape (m,)
        Places of a finer rule, and
    spread : ndarray, shape (m, n)
        from jumps to those there, times the rule's weights.
    at_tip : ndarray, shape (n,)
        From jumps to K, over sqrt(mm) of a crack's length.
    """

    x: Array
    weight: Array
    own: Array
    fine: Array
    spread: Array
    at_tip: Array

    def reflected(self, tangent: Tangent, mouth: complex, direction: complex, length: float) -> Array:
        """Tractions (2 n, 2 n) by what a surface reflects, of a crack of some length, mm."""
        start = mouth - tangent.origin
        along = direction * length
        T = image_tractions(start + along * self.x, direction, start + along * self.fine, *tangent[1:])
        n, m = len(self.x), len(self.fine)
        by_fine = T.reshape(n, m, 4).transpose(0, 2, 1) @ (length * self.spread)
        return by_fine.reshape(n, 2, 2, n).transpose(0, 1, 3, 2).reshape(2 * n, 2 * n)


@lru_cache
def unit_crack() -> UnitCrack:
    """The crack from 0 to 1: one panel at the mouth and one at the tip."""
    _, w, _ = straight_rule(POINTS)
    xt, wt, _ = tip_rule(POINTS)
    first, last = BREAK, 1.0 - BREAK
    weight = np.concatenate([0.5 * first * w, 2 * last * xt * wt])
    ends = np.array([0.0, BREAK, 1.0], dtype=complex)
    panels = CrackPanels.between(ends[:-1], ends[1:], np.array([-1, 0]), POINTS)
    z = panels.z.real
    caused = of_cracks(panels, panels.z, np.repeat([0, 1], POINTS))
    change = traction_of(caused.P, caused.Q, -1.0, np.ones(len(z), dtype=complex)).real()
    n = len(z)
    # i times the change of the resultant along the line is the traction on its left
    own = np.stack([-change[1::2], change[::2]], axis=1).reshape(2 * n, 2 * n)
    places, weights, spread = _halved()
    fine = np.concatenate([BREAK * places, z[POINTS:]])
    to_fine = np.zeros((len(fine), n))
    to_fine[: len(places), :POINTS] = (BREAK * weights)[:, None] * spread
    to_fine[len(places) :, POINTS:] = np.diag(weight[POINTS:])
    at_tip = np.zeros(n)
    at_tip[POINTS:] = np.sqrt(0.5 * np.pi / last) * slope_at_tip(POINTS)
    return UnitCrack(z, weight, own, fine, to_fine, at_tip)


def _halved() -> tuple[Array, Array, Array]:
    """A rule on (0, 1) whose parts become short towards 0, and from values at Gauss points to those at its places."""
    x, w = rule(FINE)
    cuts = np.concatenate([[0.0], 0.5 ** np.arange(HALVED, -1, -1)])
    low, size = cuts[:-1, None], np.diff(cuts)[:, None]
    places, weights = (low + 0.5 * size * (1 + x)).ravel(), (0.5 * size * w).ravel()
    return places, weights, values_at(2 * places - 1, POINTS)
