"""Theory of critical distances: Taylor's point and line method (thesis 3.3.1)."""

from __future__ import annotations

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


def point_method(eta: np.ndarray, sigma: np.ndarray, material: Material) -> float:
    """Stress of the point method, MPa; NaN where the stress sinks to zero before its depth, or the path ends.

    Parameters
    ----------
    eta, sigma : ndarray (n,)
        Depth from the surface, mm, and tensile stress, MPa; at a corner it is infinite at the surface.
    material : Material

    Examples
    --------
    A beam in bending, twice as high as the distance: the point lies on the neutral axis.

    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)
    >>> h = 2 * point_distance(material)
    >>> eta = np.linspace(0, h, 50)
    >>> point_method(eta, 1 - 2 * eta / h, material)
    nan
    """
    d = point_distance(material)
    return float(np.interp(d, eta, sigma)) if _carries(eta, sigma, d) else float("nan")


def line_method(eta: np.ndarray, sigma: np.ndarray, material: Material) -> float:
    """Stress of the line method, MPa; NaN where the stress sinks to zero within its distance, or the path ends.

    Parameters are those of `point_method`.

    Examples
    --------
    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)
    >>> round(line_method(np.array([0.0, 10.0]), np.array([2.0, 2.0]), material), 9)
    2.0
    """
    d = line_distance(material)
    if not _carries(eta, sigma, d):
        return float("nan")
    if np.isinf(sigma[0]):  # integrated as a power law from the corner on
        mean = stress_over_crack(eta[None], sigma[None], average=True)[0]
        return float(np.interp(d, eta[1:], mean[1:]))
    at = np.linspace(0, d, SAMPLES)
    return float(np.trapezoid(np.interp(at, eta, sigma), at) / d)


def _carries(eta: np.ndarray, sigma: np.ndarray, distance: float) -> bool:
    """Whether the stress is tensile all the way: else its mean cancels, and at a point it says nothing."""
    ends_within = eta[-1] < distance * (1 - 1e-9)
    # a stress that has sunk to round-off is zero
    finite = sigma[np.isfinite(sigma)]
    least = 1e-9 * np.abs(finite).max(initial=0.0)
    return bool(
        not ends_within and np.interp(distance, eta, sigma) > least and sigma[eta <= distance].min() > least
    )


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
        found = Critical.empty(len(curves.a))
        depth, method = self.depth(material), line_method if self.line else point_method
        for i in np.flatnonzero(np.isfinite(curves.a[:, -1]) & np.isfinite(curves.sigma_I[:, -1])).tolist():
            a, sigma = curves.a[i], curves.sigma_I[i]
            if a[-1] < depth * (1 - 1e-9):
                if complete is not None and complete[i]:
                    found.refused[i] = Status.TOO_DEEP
                continue
            finite = np.isfinite(sigma)
            within = finite & (a <= depth * (1 + 1e-9))
            error = float(np.max(curves.sigma_error[i, within] * np.abs(sigma[within]), initial=0.0))
            value = float(sigma[finite][0]) if (sigma[finite] <= 0).all() else method(a, sigma, material)
            if np.isnan(value):
                found.refused[i] = Status.TOO_DEEP
                continue
            found.put_stress(i, value, error, material.sigma_c)
        return found
