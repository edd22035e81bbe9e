"""What a loading says at the points of panels: displacements that are held, and tractions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex
from slmm.scene.loading import Condition, Loading


class Known(NamedTuple):
    """What is known at points.

    Attributes
    ----------
    held : ndarray, shape (n, 2) of bool
        Whether the displacement along x and y is.
    g : ndarray, shape (n,)
        These displacements over ``scale``; of components that are not held nothing.
    t : ndarray, shape (n,)
        Tractions, MPa; of held components nothing.
    of_condition : dict
        For each condition at which points (n,) it acts.
    """

    held: NDArray[np.bool_]
    g: Complex
    t: Complex
    of_condition: dict[Condition, NDArray[np.bool_]]

    def acted(self, p: int) -> NDArray[np.int64]:
        """The panels of p points on which anything is held or loaded."""
        return np.flatnonzero((self.held.any(axis=1) | (self.t != 0)).reshape(-1, p).any(axis=1))


def known_at(panels: Panels, loading: Loading, scale: float) -> Known:
    """What a loading says at the points of panels."""
    points = np.column_stack([panels.z.real, panels.z.imag])
    held = np.zeros(points.shape, dtype=bool)
    displacement, traction = np.zeros(points.shape), np.zeros(points.shape)
    of_condition: dict[Condition, NDArray[np.bool_]] = {}
    for condition in loading:
        on = condition.on(points)
        of_condition[condition] = on
        for i, component in enumerate(condition.displacement):
            if component is not None:
                held[on, i] = True
                displacement[on, i] = component(points[on])
        outward = np.column_stack([panels.tangent.imag, -panels.tangent.real])[on]
        traction[on] += condition.tractions(outward)
    traction[held] = 0.0
    unit: Array = np.array([1, 1j])
    return Known(held, displacement @ unit / scale, traction @ unit, of_condition)
