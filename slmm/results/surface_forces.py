"""Which of a model's free edges carry forces: supports and loads, told by the displacements alone.

Nodes at which nothing acts are in balance: the forces that the elements' stresses ask of them vanish. What is left of
them inside, by digits of the file or by elements that were integrated otherwise, says how much of that is noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.element import Element
from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.mechanics.material import Material
from slmm.results.field import DisplacementField

Array = NDArray[np.float64]

#: a force counts from so many times the noise, and from this share of the largest force between two elements; chosen
ABOVE_NOISE, LEAST = 8.0, 1e-3
#: forces below this share of those that the displacements might cause; round-off
ROUND_OFF = 1e-12


class SurfaceForces(NamedTuple):
    """What acts on the nodes of a model.

    Attributes
    ----------
    forces : ndarray (n, 2)
        On each node, N for each mm of thickness.
    acts : ndarray (n, 2) of bool
        Where, and in which direction, more than noise acts.
    noise : float
        Forces inside over the largest one that an element exerts, in the worst of a hundred nodes.
    level : ndarray (n,)
        What is noise at each node, N for each mm of thickness; infinite inside.
    """

    forces: Array
    acts: NDArray[np.bool_]
    noise: float
    level: Array

    def above(self, times: float) -> SurfaceForces:
        """The same with forces that act from so many times the noise on."""
        return self._replace(acts=np.abs(self.forces) > times * self.level[:, None])


def surface_forces(
    field: DisplacementField, material: Material, on_surface: NDArray[np.int64]
) -> SurfaceForces:
    """Forces on the nodes of a linear elastic model.

    Parameters
    ----------
    field : DisplacementField
    material : Material
    on_surface : ndarray of int
        Nodes of the free edges.

    Examples
    --------
    A square, pulled along x: nothing acts along y.

    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> pulled = DisplacementField(square, {"quad": np.array([[0, 1, 2, 3]])}, 1e-3 * square * [1, 0])
    >>> found = surface_forces(pulled, Material(100e3, 0.0, 10.0, 0.1), np.arange(4))
    >>> (found.forces.round(6) + 0.0).tolist(), found.acts.any(axis=0).tolist()
    ([[-50.0, 0.0], [50.0, 0.0], [50.0, 0.0], [-50.0, 0.0]], [True, False])
    """
    rules = [_forces(field, material, reduced) for reduced in (False, True)]
    inside = np.ones(len(field.points), dtype=bool)
    inside[on_surface] = False
    inside &= np.isin(np.arange(len(inside)), np.concatenate([c.ravel() for c in field.cells.values()]))
    left = [float(np.abs(forces[inside]).sum()) for forces, _ in rules]
    forces, exerted = rules[int(np.argmin(left))]
    largest = exerted.max()
    if largest < ROUND_OFF * material.E * np.abs(field.u).max():  # a rigid motion
        return SurfaceForces(forces, np.zeros(forces.shape, dtype=bool), 0.0, np.full(len(forces), np.inf))
    size = np.abs(forces[inside]).max(axis=1) / largest if inside.any() else np.zeros(1)
    noise = float(np.quantile(size, 0.99))
    local = _largest_inside(field.cells, np.where(inside, np.abs(forces).max(axis=1), 0.0))
    level = np.where(inside, np.inf, np.maximum(local, LEAST * largest / ABOVE_NOISE))
    return SurfaceForces(forces, np.zeros(forces.shape, dtype=bool), noise, level).above(ABOVE_NOISE)


def _forces(field: DisplacementField, material: Material, reduced: bool) -> tuple[Array, Array]:
    """Forces (n, 2) on the nodes, and the largest (n,) that one element exerts on each."""
    E, nu = material.plane_stress_equivalent
    D = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
    total, largest = np.zeros_like(field.u), np.zeros(len(field.u))
    for kind, nodes in field.cells.items():
        element = _element(kind, reduced)
        X, u = field.points[nodes], field.u[nodes]
        gradient = element.gradient_at_points
        jacobian = np.einsum("eni,pnj->epij", X, gradient)
        by_x = np.einsum("pnj,epji->epni", gradient, np.linalg.inv(jacobian))
        H = np.einsum("eni,epnj->epij", u, by_x)
        strain = np.stack([H[..., 0, 0], H[..., 1, 1], H[..., 0, 1] + H[..., 1, 0]], axis=-1)
        xx, yy, xy = np.moveaxis(strain @ D, -1, 0)
        stress = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)
        volume = np.linalg.det(jacobian) * element.weights
        forces = np.einsum("epij,epnj,ep->eni", stress, by_x, volume)
        for i in range(2):
            total[:, i] += np.bincount(nodes.ravel(), forces[..., i].ravel(), len(total))
        np.maximum.at(largest, nodes.ravel(), np.abs(forces).max(axis=2).ravel())
    return total, largest


def _element(kind: str, reduced: bool) -> Element:
    known = ELEMENT_TYPES[kind]
    return known.reduced if reduced and known.reduced is not None else known.element


def _largest_inside(cells: Mapping[str, NDArray[np.int64]], size: Array) -> Array:
    """The largest (n,) of sizes (n,) at nodes that a node's elements have, or the elements next to those."""
    for _ in range(2):
        spread = size.copy()
        for nodes in cells.values():
            of_element = size[nodes].max(axis=1)
            np.maximum.at(spread, nodes.ravel(), np.repeat(of_element, nodes.shape[1]))
        size = spread
    return size
