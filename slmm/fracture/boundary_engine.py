"""Boundary integrals as the engine of a simulation: one solution after the other, the body kept where it serves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.faces import lengths_of
from slmm.boundary.model import BoundaryModel
from slmm.boundary.stretches import COARSE
from slmm.criteria.distances import point_distance
from slmm.fracture.engine import Rules, competing_events, growth_load, unloaded
from slmm.fracture.events import Event, Kind
from slmm.mechanics.material import Material
from slmm.mechanics.stress import principal_stress
from slmm.part.part import Part
from slmm.scene.loading import Loading

Array = NDArray[np.float64]

#: Gauss points on panels of the boundary and of cracks, by the error of U_T that they reach; chosen on
#: validation/fracture_references.py
ORDERS = ((2e-3, (6, 5)), (1e-4, (8, 8)), (0.0, (10, 10)))
#: K_I is none below this share of the stress along surfaces times sqrt(pi a); round-off and discretisation
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
    def closed(self) -> float:
        """Length of cracks whose faces hold each other, mm."""
        cracks = self.model.cracks
        return 0.0 if cracks is None else float(lengths_of(cracks)[self.model.touching].sum())

    def events(self, rules: Rules) -> list[Event]:
        """What may happen next, where it competes with the lowest load."""
        model = self.model
        # the mean square, for where supports end a stress has no largest value
        length = np.abs(model.panels.dz)
        closed = unloaded(model.part, float(np.sqrt(model.hoop**2 @ length / length.sum())), NO_OPENING)
        tips, asks = len(model.part.tips), rules.direction.asks_for_T
        return competing_events(
            model.part,
            model.stress_intensities(),
            model.t_stresses() if asks else np.full(tips, np.nan),
            closed,
            lambda load: rules.initiation(model, load),
            model.body.material,
            rules.direction,
        )

    def finer(self, event: Event) -> tuple[float, float]:
        """Work and the load of an event by the model with more points, for estimates of errors."""
        model, material = self.model.finer, self.model.body.material
        if event.kind is Kind.GROWTH:
            return model.work, growth_load(model.stress_intensities()[event.tip], material)
        below = (event.point + point_distance(material) * event.direction)[None]
        # of the coupled criterion, too, both sides change as the stress does
        one, other = (float(principal_stress(each.stress(below))[0]) for each in (self.model, model))
        return model.work, event.load * one / other


class BoundaryEngine:
    """Solves one part after the other, each with other cracks than the one before.

    Parameters
    ----------
    material : Material
    loading : Loading
    tolerance : float
        Relative error of U_T that is aimed at.
    """

    keeps = True

    def __init__(self, material: Material, loading: Loading, tolerance: float) -> None:
        """Nothing is solved yet."""
        self.material, self.loading = material, loading
        self.order, self.crack_order = next(orders for error, orders in ORDERS if tolerance >= error)
        self._last: BoundaryModel | None = None

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {
            "engine": "boundary",
            "order": self.order,
            "crack_order": self.crack_order,
            "contact": "without friction",
        }

    def solve(self, part: Part) -> BoundaryState:
        """The part with its cracks."""
        if self._last is None:
            self._last = BoundaryModel(
                part, self.material, self.loading, self.order, self.crack_order, contact=True, grading=COARSE
            )
        else:
            self._last = self._last.with_cracks_of(part)
        return BoundaryState(self._last)
