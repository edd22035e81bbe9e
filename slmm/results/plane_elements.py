"""Plane elements as a displacement field needs them: their areas and outlines, and where in an element a point lies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from slmm.mechanics.element import Element
from slmm.mechanics.element_types import ELEMENT_TYPES

#: of Newton's method for local coordinates; chosen, with the step below which it ends
ITERATIONS, SMALLEST_STEP = 30, 1e-13
#: how far outside an element, in its local coordinates, Newton's method may go on its way; chosen
OUTSIDE = 0.5


@dataclass(frozen=True)
class PlaneElement(Element):
    """A plane element, whose edges have one node between their ends or none.

    Examples
    --------
    >>> PLANE_ELEMENTS["triangle"].clipped(np.array([[0.2, 0.3], [2.0, 2.0], [-1.0, 0.5]])).tolist()
    [[0.2, 0.3], [0.5, 0.5], [0.0, 0.5]]
    """

    @property
    def middle(self) -> np.ndarray:
        """Local coordinates of the centre."""
        return self.nodes[: self.corners].mean(axis=0)

    @cached_property
    def inner_points(self) -> np.ndarray:
        """The centre and the points of Gauss's rule towards the corners, shape (1 + corners, 2)."""
        towards = 0.5 if self.corners == 3 else 1 / np.sqrt(3)
        gauss = self.middle + towards * (self.nodes[: self.corners] - self.middle)
        return np.concatenate([self.middle[None], gauss])

    def clipped(self, xi: np.ndarray) -> np.ndarray:
        """Points xi (n, 2), or ones of the element next to them."""
        if self.corners == 4:
            return np.clip(xi, -1.0, 1.0)
        xi = np.maximum(xi, 0.0)
        return xi / np.maximum(xi.sum(axis=1, keepdims=True), 1.0)

    def areas(self, at_nodes: np.ndarray) -> np.ndarray:
        """Areas (m,) of elements with nodes (m, k, 2), negative if clockwise: a polygon and a parabola on each edge."""
        # from a corner of its own, so that far from the origin nothing cancels
        at_nodes = at_nodes - at_nodes[:, :1]
        start, end = at_nodes[:, self.edges[:, 0]], at_nodes[:, self.edges[:, 1]]
        area = _cross(start, end) / 2
        if self.edges.shape[1] == 3:
            area -= 2 / 3 * _cross(end - start, at_nodes[:, self.edges[:, 2]] - (start + end) / 2)
        return area.sum(axis=1)

    def hull(self, at_nodes: np.ndarray) -> np.ndarray:
        """Points (m, k', 2) between which the edges of elements with nodes (m, k, 2) lie: their control polygon."""
        start, end = at_nodes[:, self.edges[:, 0]], at_nodes[:, self.edges[:, 1]]
        if self.edges.shape[1] == 2:
            return start
        return np.concatenate([start, 2 * at_nodes[:, self.edges[:, 2]] - (start + end) / 2], axis=1)

    def derivatives(self, xi: np.ndarray, at_nodes: np.ndarray) -> np.ndarray:
        """Derivatives (n, 2, d) by the local coordinates, at xi (n, 2), of what has the values (n, k, d) at nodes."""
        return np.ascontiguousarray(self.gradient(xi).swapaxes(1, 2)) @ at_nodes

    def local_coordinates(
        self, at_nodes: np.ndarray, points: np.ndarray, start: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Local coordinates (n, 2) of points (n, 2) in elements with nodes (n, k, 2), clipped to them.

        Also the distance (n,), mm, that is left between the point and the place with these coordinates.
        """
        low, high = self.nodes.min() - OUTSIDE, self.nodes.max() + OUTSIDE
        xi = np.tile(start, (len(points), 1))
        active = np.arange(len(points))
        for _ in range(ITERATIONS):
            at = at_nodes[active]
            missing = points[active] - np.einsum("nk,nkd->nd", self.shape(xi[active]), at)
            (a, b), (c, d) = self.derivatives(xi[active], at).transpose(1, 2, 0)
            determinant = a * d - b * c
            # at a collapsed corner the map has no inverse: stay there
            safe = np.where(determinant == 0, np.inf, determinant)
            step = np.stack(
                [
                    (d * missing[:, 0] - c * missing[:, 1]) / safe,
                    (a * missing[:, 1] - b * missing[:, 0]) / safe,
                ],
                axis=1,
            )
            new = np.clip(xi[active] + step, low, high)
            change = np.abs(new - xi[active]).max(axis=1)
            xi[active] = new
            active = active[change > SMALLEST_STEP]
            if len(active) == 0:
                break
        xi = self.clipped(xi)
        reached = np.einsum("nk,nkd->nd", self.shape(xi), at_nodes)
        return xi, np.linalg.norm(points - reached, axis=1)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _plane_element(element: Element) -> PlaneElement:
    """An element whose monomials are added up by degree, that in x first.

    The order is that in which fields have always been evaluated. On the last digit hangs which of two elements takes
    a point of the edge between them.
    """
    p, q = element.exponents.T
    order = np.lexsort((-p, p + q, np.maximum(p, q)))
    return PlaneElement(
        element.name,
        element.corners,
        element.nodes,
        element.exponents[order],
        element.points,
        element.weights,
    )


#: by kind
PLANE_ELEMENTS = {
    kind: _plane_element(known.element)
    for kind, known in ELEMENT_TYPES.items()
    if known.element.dimension == 2 and known.element.edges.shape[1] <= 3
}
