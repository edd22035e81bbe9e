"""Isotropic linear elasticity: the stiffness between the strains and stresses of an element."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from slmm.mechanics.material import State
from slmm.mechanics.stress import kolosov, shear_modulus


@dataclass(frozen=True)
class Elasticity:
    """Young's modulus, Poisson's ratio and what plane elements do out of their plane.

    Parameters
    ----------
    E : float
        MPa.
    nu : float
        Between -1 and 0.5.
    state : {"plane strain", "plane stress"}
        Of plane elements; solids have none.

    Raises
    ------
    ValueError
        When a value is out of its range.

    Examples
    --------
    >>> steel = Elasticity(210e3, 0.3)
    >>> round(steel.E_prime), steel.stress(np.diag([1e-3, 0.0])).round(3).tolist()
    (230769, [[282.692, 0.0], [0.0, 121.154]])
    """

    E: float
    nu: float
    state: State = "plane strain"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.E) and self.E > 0):
            raise ValueError(f"E = {self.E!r} MPa: must be a positive number")
        if not (math.isfinite(self.nu) and -1 < self.nu < 0.5):
            raise ValueError(f"nu = {self.nu!r}: must lie between -1 and 0.5")
        if self.state not in ("plane strain", "plane stress"):
            raise ValueError(f"state = {self.state!r}: must be 'plane strain' or 'plane stress'")

    @property
    def mu(self) -> float:
        """Shear modulus, MPa."""
        return shear_modulus(self.E, self.nu)

    @property
    def E_prime(self) -> float:
        """Of G = K^2/E': E in plane stress, E/(1 - nu^2) in plane strain, MPa."""
        return self.E if self.state == "plane stress" else self.E / (1 - self.nu**2)

    @property
    def kappa(self) -> float:
        """Kolosov's constant of plane elements."""
        return kolosov(self.nu) if self.state == "plane stress" else 3 - 4 * self.nu

    @cached_property
    def _lame(self) -> dict[int, float]:
        """First Lamé parameter by dimension, MPa."""
        lam = self.E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu))
        plane = 2 * lam * self.mu / (lam + 2 * self.mu) if self.state == "plane stress" else lam
        return {2: plane, 3: lam}

    def stress(self, gradient: np.ndarray) -> np.ndarray:
        """Stresses (..., d, d), MPa, from displacement gradients (..., d, d)."""
        d = gradient.shape[-1]
        trace = np.trace(gradient, axis1=-2, axis2=-1)[..., None, None]
        return self.mu * (gradient + gradient.swapaxes(-1, -2)) + self._lame[d] * trace * np.eye(d)
