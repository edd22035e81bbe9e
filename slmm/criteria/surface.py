"""Strength at the surface: Rankine's largest principal stress, and von Mises' equivalent stress (thesis 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slmm.criteria.path_curves import Critical, PathCurves
from slmm.criteria.status import Status
from slmm.mechanics.material import Material


def mises_stress(across: np.ndarray, along: np.ndarray, shear: np.ndarray, material: Material) -> np.ndarray:
    """Equivalent stress (...) of plane stresses (...) in any two perpendicular directions, MPa.

    Examples
    --------
    >>> material = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)
    >>> float(mises_stress(np.float64(0.0), np.float64(0.0), np.float64(1.0), material).round(4))
    1.7321
    """
    middle, radius = 0.5 * (across + along), np.hypot(0.5 * (across - along), shear)
    out_of_plane = material.nu * (across + along) if material.state == "plane strain" else 0.0 * across
    first, second = middle + radius, middle - radius
    squares = (first - second) ** 2 + (second - out_of_plane) ** 2 + (out_of_plane - first) ** 2
    return np.sqrt(0.5 * squares)


@dataclass(frozen=True)
class Strength:
    """The stress at the surface reaches the strength, a `criterion.Criterion`.

    Parameters
    ----------
    mises : bool
        The equivalent stress counts, in place of the largest principal one: the curves hold that then.
    """

    mises: bool = False

    @property
    def needs(self) -> frozenset[str]:
        """Of a source."""
        return frozenset({"equivalent stress" if self.mises else "stress"})

    @property
    def bounded_by(self) -> str:
        """The principal stress says nothing of the equivalent one."""
        return "nothing" if self.mises else "surface"

    def depth(self, material: Material) -> float:
        """How deep it looks, mm: not at all."""
        return 0.0

    def judge(self, curves: PathCurves, material: Material, complete: np.ndarray | None = None) -> Critical:
        """Apply it to every position that has a stress at its mouth."""
        found = Critical.empty(len(curves.a))
        sigma = curves.sigma_I[:, 0]
        found.refused[np.isinf(sigma)] = Status.SINGULAR
        known = np.flatnonzero(np.isfinite(sigma))
        error = curves.sigma_error[known, 0] * np.abs(sigma[known])
        found.put_stress((known,), sigma[known], error, material.sigma_c)
        return found
