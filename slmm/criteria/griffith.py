"""Griffith's criterion with Irwin's energy release rate: a crack goes on where G = (K_I^2 + K_II^2)/E reaches G_c."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slmm.criteria.coupled import ENERGY
from slmm.criteria.path_curves import Critical, PathCurves
from slmm.criteria.status import Status
from slmm.mechanics.material import Material


def energy_release_rate(K_I: float, K_II: float, material: Material) -> float:
    """G, N/mm, of stress intensities, MPa sqrt(mm), in the material's plane state.

    Examples
    --------
    >>> energy_release_rate(3.0, 4.0, Material(E=100.0, nu=0.3, sigma_c=1.0, G_c=1.0))
    0.25
    """
    return (K_I * K_I + K_II * K_II) / material.plane_stress_equivalent[0]


@dataclass(frozen=True)
class Griffith:
    """Energy alone, at crack tips, a `criterion.Criterion`."""

    needs: ClassVar[frozenset[str]] = frozenset({"energy"})
    bounded_by: ClassVar[str] = "nothing"

    def depth(self, material: Material) -> float:
        """How deep it looks, mm: not at all."""
        return 0.0

    def judge(self, curves: PathCurves, material: Material, complete: np.ndarray | None = None) -> Critical:
        """Apply it where a crack of no length releases energy: at the tips of cracks that open."""
        found = Critical.empty(len(curves.a))
        for i in np.flatnonzero(np.isfinite(curves.G_inc[:, 0])):
            G = curves.G_inc[i, 0]
            if not G > 0:
                found.refused[i] = Status.NO_CRACK
                continue
            found.load_factor[i], found.crack_length[i] = np.sqrt(material.G_c / G), 0.0
            found.governed_by[i], found.error[i] = ENERGY, 0.5 * curves.G_error[i, 0]
        return found
