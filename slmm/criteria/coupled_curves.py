"""The coupled criterion on curves with errors: the index, its own error, and bounds where curves end too early."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from slmm.criteria.coupled import BOTH, ENERGY, critical_load, stress_over_crack
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

    def judge_each(
        self, curves: PathCurves, materials: Sequence[Material], complete: np.ndarray | None = None
    ) -> Critical:
        """See `criticals_each`."""
        return criticals_each(curves, materials, self.average, complete)


def criticals(
    curves: PathCurves, material: Material, average: bool, complete: np.ndarray | None = None
) -> Critical:
    """Apply the coupled criterion to every position that has curves.

    Where the load found lets the strength be exceeded all along the curves, longer cracks could need less: no value,
    unless a path is ``complete`` (n,), ie. goes through the whole ligament.
    """
    return criticals_each(curves, [material], average, complete).of(0)


def criticals_each(
    curves: PathCurves, materials: Sequence[Material], average: bool, complete: np.ndarray | None = None
) -> Critical:
    """The same for m materials of one elasticity, (m, n): these curves are computed once."""
    n, m = len(curves.a), len(materials)
    found = Critical.empty((m, n))
    with np.errstate(invalid="ignore"):
        strength = stress_over_crack(curves.a, curves.sigma_I, average)
        strength_error = _error_over_crack(curves, strength, average)
    complete = np.zeros(n, dtype=bool) if complete is None else np.asarray(complete, dtype=bool)
    limits = np.array([(material.sigma_c, material.G_c) for material in materials]).reshape(m, 2)
    _judge(
        curves.a,
        curves.G_inc,
        strength,
        curves.G_error,
        strength_error,
        _allowed_stress(strength, strength_error),
        complete,
        limits,
        found.load_factor,
        found.crack_length,
        found.error,
        found.governed_by,
    )
    return found


@njit(cache=True)
def _judge(
    a, G_inc, strength, G_error, strength_error, allowed, complete, limits, load_factor, length, error, code
):
    """Fill load factors, lengths, errors and codes (m, n) for strengths and toughnesses (m, 2)."""
    for i in range(len(a)):
        if not np.isfinite(a[i, -1]):
            continue
        for k in range(len(limits)):
            sigma_c, G_c = limits[k]
            lf, at, governed = critical_load(a[i], G_inc[i], strength[i], G_c, sigma_c, complete[i])
            if not complete[i] and strength[i, -1] > (1 + 1e-9) * sigma_c / lf:
                continue
            load_factor[k, i], length[k, i], code[k, i] = lf, at, governed
            if np.isinf(lf):
                # a crack that is closed from its mouth on is no matter of the stress's error
                shut = np.any(strength[i] > 0) and not np.any(G_inc[i] > 0)
                error[k, i] = 0.0 if shut else allowed[i] / sigma_c
            else:
                error[k, i] = _index_error(
                    a[i], G_inc[i], strength[i], G_error[i], strength_error[i], at, governed
                )


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


def middle_of_bounds(curves: PathCurves, material: Material) -> tuple[np.ndarray, np.ndarray]:
    """Load factor (n,) of the middle of `index_bounds`, and half their distance as its relative error (n,).

    Both are NaN where there are no bounds; where the middle is 0, the load factor is infinite.
    """
    low, high = index_bounds(curves, material)
    known = np.isfinite(low) & np.isfinite(high)
    with np.errstate(divide="ignore", invalid="ignore"):
        load_factor = np.where(known, 2 / (low + high), np.nan)
        error = np.where(high > 0, (high - low) / (high + low), 0.0)
    return load_factor, np.where(known, error, np.nan)


def _error_over_crack(curves: PathCurves, strength: np.ndarray, average: bool) -> np.ndarray:
    """Relative error (n, CURVE_POINTS) of the stress over the crack from that of the stress at every depth.

    Relative to the stress over the crack: where the least of that lies at the mouth, so does its error.
    """
    step = curves.sigma_error * np.abs(curves.sigma_I)
    step[np.isinf(curves.sigma_I)] = 0.0
    changed = [stress_over_crack(curves.a, curves.sigma_I + sign * step, average) for sign in (-1, 1)]
    error = np.abs(np.array(changed) - strength).max(axis=0) / np.maximum(np.abs(strength), 1e-300)
    return np.where(np.isinf(strength), curves.sigma_error, error)


def _allowed_stress(strength: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Largest stress over a crack (n,) that its errors allow, MPa: over the strength, the index where there is none."""
    # at a corner or a crack tip the mouth says nothing
    with np.errstate(invalid="ignore"):
        allowed = np.where(np.isfinite(strength), strength + error * np.abs(strength), 0.0)
    return np.maximum(np.max(allowed, axis=1, initial=0.0), 0.0)


@njit(cache=True)
def _interval(a, length):
    """Number of the point that ends the interval of the lengths in which one lies."""
    return min(max(np.searchsorted(a, length), 1), len(a) - 1)


@njit(cache=True)
def _index_error(a, G_inc, strength, G_error, strength_error, length, code):
    """Relative error of the load factor from those of the curves at the critical length.

    Where both curves meet, lf^2 G(a) = G_c and lf sigma(a) = sigma_c; with the slopes q = d ln G/d ln a and
    p = -d ln sigma/d ln a, errors e_G and e_s change ln lf by -(q e_s + p e_G)/(q + 2 p).
    """
    if not np.isfinite(length):
        return np.nan
    at = max(length, a[1])
    # the curve's interval around it decides the slopes; a crack of no length has only the stress
    first, near = _interval(a, 0.8 * at), _interval(a, at)
    last = _interval(a, min(1.25 * at, a[-1]))
    e_G = max(G_error[first], G_error[near], G_error[last])
    e_s = max(strength_error[first], strength_error[near], strength_error[last])
    if code == ENERGY:
        return 0.5 * e_G
    if code != BOTH or first == last:
        return e_s
    span = np.log(a[last] / a[first])
    q = np.log(max(G_inc[last], 1e-300) / max(G_inc[first], 1e-300)) / span
    p = np.log(max(strength[first], 1e-300) / max(strength[last], 1e-300)) / span
    q, p = max(q, 1e-6), min(max(p, 0.0), 1e6)
    return (q * e_s + p * e_G) / (q + 2 * p)
