"""Theory of critical distances: Taylor's point and line method (thesis 3.3.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slmm.criteria.coupled import stress_over_crack
from slmm.criteria.path_curves import Critical, PathCurves
from slmm.criteria.status import Status
from slmm.mechanics.material import Material

#: points along the distance that the line method averages over; chosen
SAMPLES = 41


def point_distance(material: Material) -> float:
    """Depth at which the point method takes the stress, mm: half of l_ch of thesis Eq. 3.16, l_Irwin/(2 pi)."""
    return material.irwin_length / (2 * np.pi)


def line_distance(material: Material) -> float:
    """Depth to which the line method averages, mm: twice l_ch of thesis Eq. 3.16 (Eq. 3.17)."""
    return 2 * material.irwin_length / np.pi


def point_stress(eta: np.ndarray, sigma: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Stress (m,) at depths (m,), MPa; NaN where it sinks to zero on the way there, or the path ends.

    Parameters
    ----------
    eta, sigma : ndarray (n,)
        Depth from the surface, mm, and tensile stress, MPa; at a corner it is infinite at the surface.
    depth : ndarray (m,)
        mm.

    Examples
    --------
    A beam in bending: the lower point lies on the neutral axis.

    >>> eta = np.linspace(0, 4.0, 50)
    >>> point_stress(eta, 1 - eta / 2, np.array([1.0, 2.0])).round(9)
    array([0.5, nan])
    """
    return np.where(_carries(eta, sigma, depth), np.interp(depth, eta, sigma), np.nan)


def line_stress(eta: np.ndarray, sigma: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Mean stress (m,) down to depths (m,), MPa; NaN where it sinks to zero on the way there, or the path ends.

    Parameters are those of `point_stress`.

    Examples
    --------
    >>> line_stress(np.array([0.0, 10.0]), np.array([2.0, 2.0]), np.array([4.0])).round(9)
    array([2.])
    """
    if np.isinf(sigma[0]):  # integrated as a power law from the corner on
        mean = stress_over_crack(eta[None], sigma[None], average=True)[0]
        found = np.interp(depth, eta[1:], mean[1:])
    else:
        at = depth[:, None] * np.linspace(0.0, 1.0, SAMPLES)
        found = np.trapezoid(np.interp(at, eta, sigma), dx=1 / (SAMPLES - 1), axis=1)
    return np.where(_carries(eta, sigma, depth), found, np.nan)


def _carries(eta: np.ndarray, sigma: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Whether (m,) the stress is tensile all the way: else its mean cancels, and at a point it says nothing."""
    # a stress that has sunk to round-off is zero
    finite = sigma[np.isfinite(sigma)]
    least = 1e-9 * np.abs(finite).max(initial=0.0)
    last = np.searchsorted(eta, depth, side="right") - 1
    tension = (np.interp(depth, eta, sigma) > least) & (np.minimum.accumulate(sigma)[last] > least)
    return (eta[-1] >= depth * (1 - 1e-9)) & tension


@dataclass(frozen=True)
class CriticalDistance:
    """The point or the line method, a `criterion.Criterion`.

    Parameters
    ----------
    line : bool
        The mean up to the distance counts, not the value at it.
    """

    line: bool = False
    needs: ClassVar[frozenset[str]] = frozenset({"stress"})
    bounded_by: ClassVar[str] = "path"

    def depth(self, material: Material) -> float:
        """How deep it looks, mm."""
        return line_distance(material) if self.line else point_distance(material)

    def judge(self, curves: PathCurves, material: Material, complete: np.ndarray | None = None) -> Critical:
        """Apply it to every position that has curves; those that end before the distance have no value."""
        return self.judge_each(curves, [material], complete).of(0)

    def judge_each(
        self, curves: PathCurves, materials: Sequence[Material], complete: np.ndarray | None = None
    ) -> Critical:
        """The same for m materials, (m, n)."""
        found = Critical.empty((len(materials), len(curves.a)))
        depth = np.array([self.depth(material) for material in materials])
        sigma_c = np.array([material.sigma_c for material in materials])
        for i in np.flatnonzero(np.isfinite(curves.a[:, -1]) & np.isfinite(curves.sigma_I[:, -1])).tolist():
            a, sigma = curves.a[i], curves.sigma_I[i]
            reached = a[-1] >= depth * (1 - 1e-9)
            if complete is not None and complete[i]:
                found.refused[~reached, i] = Status.TOO_DEEP
            rows = np.flatnonzero(reached)
            value = self._stress(a, sigma, depth[rows])
            found.refused[rows[np.isnan(value)], i] = Status.TOO_DEEP
            finite = np.isfinite(sigma)
            by_depth = np.where(finite, curves.sigma_error[i] * np.abs(np.where(finite, sigma, 0.0)), 0.0)
            last = np.searchsorted(a, depth[rows] * (1 + 1e-9), side="right") - 1
            error = np.maximum.accumulate(by_depth)[last]
            known = ~np.isnan(value)
            found.put_stress((rows[known], i), value[known], error[known], sigma_c[rows[known]])
        return found

    def _stress(self, a: np.ndarray, sigma: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Stress (m,) that decides at each depth (m,), MPa; NaN where it sinks to zero before."""
        finite = sigma[np.isfinite(sigma)]
        if (finite <= 0).all():
            return np.full(len(depth), finite[0])
        return (line_stress if self.line else point_stress)(a, sigma, depth)
