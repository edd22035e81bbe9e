"""Boundary integrals as the engine of a simulation: one solution after the other, the body kept where it serves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.model import BoundaryModel
from slmm.boundary.stretches import COARSE
from slmm.criteria.distances import point_distance
from slmm.criteria.griffith import energy_release_rate
from slmm.fracture.events import COMPETING, Event, Kind, growths, starts
from slmm.fracture.initiation_sites import critical_sites
from slmm.mechanics.material import Material
from slmm.mechanics.stress import principal_stress
from slmm.part.part import Part
from slmm.scene.loading import Loading

Array = NDArray[np.float64]

#: Gauss points on panels of the boundary and of cracks, by the error of U_T that they reach; chosen on
#: validation/fracture_references.py
ORDERS = ((2e-3, (6, 5)), (1e-4, (8, 8)), (0.0, (10, 10)))
#: share of the points on cracks whose faces touch that counts; the ends of cracks may by their discretisation; chosen
TOUCHING = 0.02
#: K_I is none below this share of the largest stress along surfaces times sqrt(pi a); round-off and discretisation
NO_OPENING = 1e-4


@dataclass(frozen=True, eq=False)
class BoundaryState:
    """A part with its cracks under the scene's own load.

    Parameters
    ----------
    model : BoundaryModel
    """

    model: BoundaryModel

    @property
    def work(self) -> float:
        """Twice the stored energy, N mm for each mm of thickness."""
        return self.model.work

    @property
    def touches(self) -> bool:
        """Whether faces of cracks hold each other over more than the last points before their ends."""
        touching = self.model.touching
        return bool(len(touching) and touching.mean() > TOUCHING)

    def slides_before(self, load: float) -> bool:
        """Whether a closed tip would slide on, by its K_II alone, below a critical load."""
        K, material = self.model.stress_intensities(), self.model.body.material
        closed = K[K[:, 0] <= 0]
        return any(energy_release_rate(0.0, K_II, material) * load**2 > material.G_c for K_II in closed[:, 1])

    def events(self) -> list[Event]:
        """What may happen next, where it competes with the lowest load."""
        part, material = self.model.part, self.model.body.material
        K = self.model.stress_intensities()
        sizes = np.array([np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in part.tips])
        closed = NO_OPENING * float(np.abs(self.model.hoop).max()) * np.sqrt(np.pi * sizes)
        tips = growths(part.tips, np.where((K[:, 0] > closed)[:, None], K, 0.0), material)
        lowest = min((event.load for event in tips), default=np.inf)
        least = material.sigma_c / (lowest * (1 + COMPETING))
        return tips + starts(critical_sites(self.model, least), material)

    def finer(self, event: Event) -> tuple[float, float]:
        """Work and the load of an event by the model with more points, for estimates of errors."""
        model, material = self.model.finer, self.model.body.material
        if event.kind is Kind.GROWTH:
            K_I, K_II = model.stress_intensities()[event.tip]
            return model.work, float(np.sqrt(material.G_c / energy_release_rate(K_I, K_II, material)))
        below = event.point + point_distance(material) * event.direction
        return model.work, material.sigma_c / float(principal_stress(model.stress(below[None]))[0])


class BoundaryEngine:
    """Solves one part after the other, each with other cracks than the one before.

    Parameters
    ----------
    material : Material
    loading : Loading
    tolerance : float
        Relative error of U_T that is aimed at.
    """

    def __init__(self, material: Material, loading: Loading, tolerance: float) -> None:
        """Nothing is solved yet."""
        self.material, self.loading = material, loading
        self.order, self.crack_order = next(orders for error, orders in ORDERS if tolerance >= error)
        self._last: BoundaryModel | None = None

    def solve(self, part: Part) -> BoundaryState:
        """The part with its cracks."""
        if self._last is None:
            self._last = BoundaryModel(
                part, self.material, self.loading, self.order, self.crack_order, contact=True, grading=COARSE
            )
        else:
            self._last = self._last.with_cracks_of(part)
        return BoundaryState(self._last)
