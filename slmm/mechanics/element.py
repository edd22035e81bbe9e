"""A finite element in its reference coordinates: nodes, the monomials of its shape functions, and its integration rule.

Which elements there are, and what other programs call them, stands in `slmm.mechanics.element_types`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

#: det dX/dR over the largest side to the power of the dimension, below which an element is degenerate; chosen
DEGENERATE = 1e-10
#: how far a node may lie from where it belongs in reference coordinates: above round-off, below any spacing; chosen
SAME_PLACE = 1e-9


@dataclass(frozen=True)
class Element:
    """An isoparametric element.

    Attributes
    ----------
    name : str
    corners : int
    nodes : ndarray (n, d)
        Reference coordinates.
    exponents : ndarray (n, d) of int
        Powers of the monomials that span the shape functions.
    points, weights : ndarray (ips, d), (ips,)
        Integration rule in reference coordinates.
    """

    name: str
    corners: int
    nodes: np.ndarray
    exponents: np.ndarray
    points: np.ndarray
    weights: np.ndarray

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.nodes.shape[1]

    @cached_property
    def coefficients(self) -> np.ndarray:
        """Of the monomials (n,) in each shape function (n,)."""
        return np.linalg.inv(_monomials(self.nodes, self.exponents))

    def shape(self, at: np.ndarray) -> np.ndarray:
        """Shape functions (k, n) at reference coordinates (k, d)."""
        return _monomials(at, self.exponents) @ self.coefficients

    def gradient(self, at: np.ndarray) -> np.ndarray:
        """Their derivatives (k, n, d) by the reference coordinates."""
        result = []
        for i in range(self.dimension):
            lower = self.exponents.copy()
            lower[:, i] = np.maximum(lower[:, i] - 1, 0)
            result.append((_monomials(at, lower) * self.exponents[:, i]) @ self.coefficients)
        return np.stack(result, axis=-1)

    @cached_property
    def gradient_at_points(self) -> np.ndarray:
        """Derivatives (ips, n, d) at the integration points."""
        return np.ascontiguousarray(self.gradient(self.points))

    @cached_property
    def turned(self) -> tuple[np.ndarray, np.ndarray]:
        """Order of the nodes (n,) and of the points (ips,) of the element that runs the other way round."""
        # exchanging the first two coordinates maps each of the reference elements on itself
        exchanged = [1, 0, *range(2, self.dimension)]
        nodes, points = (
            np.linalg.norm(at[:, exchanged][:, None] - at, axis=2).argmin(axis=1)
            for at in (self.nodes, self.points)
        )
        return nodes, points

    @cached_property
    def edges(self) -> np.ndarray:
        """Nodes (corners, 2 or more) of a plane element's edges, anticlockwise: start, end, and those between in order.

        Raises
        ------
        ValueError
            For a solid.

        Examples
        --------
        >>> from slmm.mechanics.elements import element_named
        >>> element_named("CPE6").edges.tolist()
        [[0, 1, 3], [1, 2, 4], [2, 0, 5]]
        """
        if self.dimension != 2:
            raise ValueError(f"{self.name} is no plane element: it has faces, not edges")
        found = []
        for start in range(self.corners):
            end = (start + 1) % self.corners
            along = self.nodes[end] - self.nodes[start]
            at = (self.nodes - self.nodes[start]) @ along / (along @ along)
            off = np.linalg.norm(self.nodes - self.nodes[start] - at[:, None] * along, axis=1)
            between = np.flatnonzero((off < SAME_PLACE) & (at > SAME_PLACE) & (at < 1 - SAME_PLACE))
            found.append([start, end, *between[np.argsort(at[between])]])
        return np.array(found)

    def opposite_faces(self, face: Element) -> list[tuple[np.ndarray, np.ndarray]]:
        """Pairs of opposite faces of a solid that are both a plane element, node over node, each pair both ways round.

        Parameters
        ----------
        face : Element
            Whose nodes, in the order of its own, are looked for on both faces.

        Examples
        --------
        >>> from slmm.mechanics.elements import element_named
        >>> faces = element_named("C3D6").opposite_faces(element_named("CPE3"))
        >>> [(face.tolist(), opposite.tolist()) for face, opposite in faces]
        [([0, 1, 2], [3, 4, 5]), ([3, 4, 5], [0, 1, 2])]
        """
        found = []
        for axis in reversed(range(self.dimension)):
            across = self.nodes[:, axis]
            pair = []
            for side in (across.min(), across.max()):
                place = np.linalg.norm(
                    np.insert(face.nodes, axis, side, axis=1)[:, None] - self.nodes, axis=2
                )
                if (place.min(axis=1) < SAME_PLACE).all():
                    pair.append(place.argmin(axis=1))
            if len(pair) == 2:
                found += [(pair[0], pair[1]), (pair[1], pair[0])]
        return found


def _monomials(at: np.ndarray, exponents: np.ndarray) -> np.ndarray:
    """Monomials (k, n) at points (k, d)."""
    return np.prod(np.asarray(at, dtype=float)[:, None] ** exponents, axis=-1)
