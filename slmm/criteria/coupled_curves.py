"""The coupled criterion on curves with errors: the index, its own error, and bounds where curves end too early."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slmm.criteria.coupled import BOTH, ENERGY, NONE, critical_load, stress_over_crack
from slmm.criteria.path_curves import Critical, PathCurves
from slmm.mechanics.material import Material


@dataclass(frozen=True)
class Coupled:
    """Leguillon's coupled criterion, a `criterion.Criterion`.

    Parameters
    ----------
    average : bool
        Compare the mean stress over the crack with the strength (thesis Eq. 3.21), not the least.
    """

    average: bool = False
    needs: ClassVar[frozenset[str]] = frozenset({"stress", "energy"})

    @property
    def bounded_by(self) -> str:
        """The least stress over a crack cannot exceed that at the surface, the mean that anywhere on the path."""
        return "path" if self.average else "surface"

    def depth(self, material: Material) -> float:
        """How deep it looks whatever the crack, mm: nowhere but along the crack."""
        return 0.0

    def judge(self, curves: PathCurves, material: Material, complete: np.ndarray | None = None) -> Critical:
        """See `criticals`."""
        return criticals(curves, material, self.average, complete)


def criticals(
    curves: PathCurves, material: Material, average: bool, complete: np.ndarray | None = None
) -> Critical:
    """Apply the coupled criterion to every position that has curves.

    Where the load found lets the strength be exceeded all along the curves, longer cracks could need less: no value,
    unless a path is ``complete`` (n,), ie. goes through the whole ligament.
    """
    found = Critical.empty(len(curves.a))
    load_factor, length, error, code = found.load_factor, found.crack_length, found.error, found.governed_by
    with np.errstate(invalid="ignore"):
        strength = stress_over_crack(curves.a, curves.sigma_I, average)
        strength_error = _error_over_crack(curves, strength, average)
    for i in np.flatnonzero(np.isfinite(curves.a[:, -1])):
        open_end = complete is None or not complete[i]
        load_factor[i], length[i], code[i] = critical_load(
            curves.a[i], curves.G_inc[i], strength[i], material.G_c, material.sigma_c, not open_end
        )
        if open_end and strength[i, -1] > (1 + 1e-9) * material.sigma_c / load_factor[i]:
            load_factor[i], length[i], code[i] = np.nan, np.nan, NONE
            continue
        if np.isinf(load_factor[i]):
            # a crack that is closed from its mouth on is no matter of the stress's error
            shut = np.any(strength[i] > 0) and not np.any(curves.G_inc[i] > 0)
            error[i] = 0.0 if shut else _allowed_index(strength[i], strength_error[i], material)
            continue
        error[i] = _index_error(
            curves.a[i],
            curves.G_inc[i],
            strength[i],
            curves.G_error[i],
            strength_error[i],
            length[i],
            code[i],
        )
    return found


def index_bounds(curves: PathCurves, material: Material) -> tuple[np.ndarray, np.ndarray]:
    """Between which failure indices (n,) the stress along the crack leaves the truth, also where curves end too early.

    The index is the largest, over all crack lengths, of the smaller of what energy and stress allow. What the curves
    say up to their end is a lower bound of it. Longer cracks cannot have more than the stress allows at the end, for
    the least stress over a crack falls with its length (the mean may rise: of the average there is no bound). The
    errors that the curves tell widen both. NaN where there are no curves or no errors.
    """
    sigma, G = curves.sigma_I, np.maximum(curves.G_inc, 0.0)
    with np.errstate(invalid="ignore"):
        # infinite at a corner, whatever the error
        margin = np.where(np.isinf(sigma), 0.0, curves.sigma_error * np.abs(sigma))
        stress_low, stress_high = (
            np.maximum(stress_over_crack(curves.a, sigma + side * margin, average=False), 0.0)
            / material.sigma_c
            for side in (-1, 1)
        )
        energy_low, energy_high = (
            np.sqrt(np.maximum(G * (1 + side * curves.G_error), 0.0) / material.G_c) for side in (-1, 1)
        )
    # from one length to the next, and from the last one on, no more than the stress at its begin and the energy's
    # larger value
    larger = np.append(
        np.maximum(energy_high[:, :-1], energy_high[:, 1:]), np.full((len(G), 1), np.inf), axis=1
    )
    return np.minimum(energy_low, stress_low).max(axis=1), np.minimum(larger, stress_high).max(axis=1)


def _error_over_crack(curves: PathCurves, strength: np.ndarray, average: bool) -> np.ndarray:
    """Relative error (n, CURVE_POINTS) of the stress over the crack from that of the stress at every depth.

    Relative to the stress over the crack: where the least of that lies at the mouth, so does its error.
    """
    step = curves.sigma_error * np.abs(curves.sigma_I)
    step[np.isinf(curves.sigma_I)] = 0.0
    changed = [stress_over_crack(curves.a, curves.sigma_I + sign * step, average) for sign in (-1, 1)]
    error = np.abs(np.array(changed) - strength).max(axis=0) / np.maximum(np.abs(strength), 1e-300)
    return np.where(np.isinf(strength), curves.sigma_error, error)


def _allowed_index(strength: np.ndarray, error: np.ndarray, material: Material) -> float:
    """Largest failure index that the errors of the stress allow at a position that has none."""
    finite = np.isfinite(strength)  # at a corner or a crack tip the mouth says nothing
    allowed = strength[finite] + error[finite] * np.abs(strength[finite])
    return float(np.maximum(np.max(allowed, initial=0.0), 0.0)) / material.sigma_c


def _index_error(a, G_inc, strength, G_error, strength_error, length, code):
    """Relative error of the load factor from those of the curves at the critical length.

    Where both curves meet, lf^2 G(a) = G_c and lf sigma(a) = sigma_c; with the slopes q = d ln G/d ln a and
    p = -d ln sigma/d ln a, errors e_G and e_s change ln lf by -(q e_s + p e_G)/(q + 2 p).
    """
    if not np.isfinite(length):
        return np.nan
    at = max(length, a[1])
    # the curve's interval around it decides the slopes; a crack of no length has only the stress
    low, high = 0.8 * at, min(1.25 * at, a[-1])
    near = np.unique(np.clip(np.searchsorted(a, [low, at, high]), 1, len(a) - 1))
    e_G, e_s = np.max(G_error[near]), np.max(strength_error[near])
    if code == ENERGY:
        return 0.5 * e_G
    if code != BOTH or len(near) < 2:
        return e_s
    first, last = near[0], near[-1]
    span = np.log(a[last] / a[first])
    q = np.log(max(G_inc[last], 1e-300) / max(G_inc[first], 1e-300)) / span
    p = np.log(max(strength[first], 1e-300) / max(strength[last], 1e-300)) / span
    q, p = max(q, 1e-6), min(max(p, 0.0), 1e6)
    return (q * e_s + p * e_G) / (q + 2 * p)
