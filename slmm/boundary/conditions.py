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
    motions : ndarray, shape (2 n, m)
        What the m free motions of rigid bodies on the surface are, each by 1 mm, real and imaginary parts in turn.
    rigid : ndarray, shape (n, m)
        These as part of g.
    resultants : ndarray, shape (m,)
        On these bodies, N and N mm for each mm of thickness.
    of_condition : dict
        For each condition at which points (n,) it acts.
    """

    held: NDArray[np.bool_]
    g: Complex
    t: Complex
    motions: Array
    rigid: Complex
    resultants: Array
    of_condition: dict[Condition, NDArray[np.bool_]]

    def acted(self, p: int) -> NDArray[np.int64]:
        """The panels of p points on which anything is held or loaded."""
        return np.flatnonzero((self.held.any(axis=1) | (self.t != 0)).reshape(-1, p).any(axis=1))

    def chosen(self, points: NDArray[np.int64]) -> Known:
        """The same at some of the points."""
        motions = self.motions.reshape(len(self.t), 2, -1)[points].reshape(2 * len(points), -1)
        on = {condition: here[points] for condition, here in self.of_condition.items()}
        return Known(
            self.held[points],
            self.g[points],
            self.t[points],
            motions,
            self.rigid[points],
            self.resultants,
            on,
        )


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
        traction[on] += condition.tractions(points[on], outward)
    traction[held] = 0.0
    unit: Array = np.array([1, 1j])
    bodies = [np.zeros((len(points), 2, 0))]
    for body in loading.stiff:
        on = np.any([of_condition[c] for c in loading if c.stiff is body], axis=0)
        bodies.append(np.where(on[:, None, None], body.motions(points), 0.0))
    motions = np.concatenate(bodies, axis=2)
    return Known(
        held,
        displacement @ unit / scale,
        traction @ unit,
        motions.reshape(2 * len(points), -1),
        np.einsum("nim,i->nm", motions, unit) / scale,
        np.concatenate([np.empty(0), *(body.resultants for body in loading.stiff)]),
        of_condition,
    )
