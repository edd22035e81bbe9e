"""The displacements of any plane finite element model, at any point.

A field holds nodes, elements and nodal displacements. A point is looked up in the tree of the elements' boxes, its
local coordinates follow from Newton's method, and the element's shape functions interpolate. Elements are
isoparametric, so quadratic ones may have curved edges. Outside the model, between a notch and the chords that
approximate it, the field goes on linearly from the nearest point of the boundary.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import shapely

#: a point this close to an element is a point of it; nodes of files have six digits. In element sizes
TOUCH = 1e-6
#: a point this close to the model is covered by it: how far a notch may bulge over the chord of a linear element
#: that is not too coarse for it (0.4 radii long). In element sizes
COVERED = 0.05
#: of Newton's method, for local coordinates and for the nearest point of an edge
ITERATIONS = 30
#: pieces of a curved edge when the nearest edge is looked for
EDGE_PIECES = 8


@dataclass(frozen=True)
class ReferenceElement:
    """An element in its local coordinates: what its shape functions are made from.

    Parameters
    ----------
    nodes : ndarray, shape (k, 2)
        Local coordinates of the nodes: corners counter-clockwise, then midside nodes, then the middle (VTK's order).
    powers : ndarray, shape (k, 2)
        Exponents of the monomials that the shape functions combine.
    corners : int
        Their number.
    """

    nodes: np.ndarray
    powers: np.ndarray
    corners: int

    @cached_property
    def coefficients(self) -> np.ndarray:
        """Shape functions in terms of the monomials, shape (k, k): each is 1 at its node and 0 at the others."""
        return np.linalg.inv(np.prod(self.nodes[:, None, :] ** self.powers, axis=-1))

    @property
    def edges(self) -> np.ndarray:
        """Nodes of each edge, shape (corners, 2) or, with midside nodes, (corners, 3): start, end, middle."""
        start = np.arange(self.corners)
        edges = [start, np.roll(start, -1)]
        if len(self.nodes) >= 2 * self.corners:
            edges.append(start + self.corners)
        return np.stack(edges, axis=1)

    @property
    def turned(self) -> np.ndarray:
        """The order of the nodes that runs through an element the other way round."""
        corner = np.arange(self.corners)
        order = [-corner % self.corners]
        if len(self.nodes) >= 2 * self.corners:
            order.append(self.corners + (-1 - corner) % self.corners)
        order.append(np.arange(sum(map(len, order)), len(self.nodes)))
        return np.concatenate(order)

    @cached_property
    def middle(self) -> np.ndarray:
        """Local coordinates of the centre."""
        return self.nodes[: self.corners].mean(axis=0)

    @cached_property
    def inner_points(self) -> np.ndarray:
        """The centre and the points of Gauss's rule towards the corners, shape (1 + corners, 2)."""
        towards = 0.5 if self.corners == 3 else 1 / np.sqrt(3)
        gauss = self.middle + towards * (self.nodes[: self.corners] - self.middle)
        return np.concatenate([self.middle[None], gauss])

    def shape_functions(self, xi: np.ndarray) -> np.ndarray:
        """Values (n, k) at local coordinates xi (n, 2)."""
        return np.prod(xi[:, None, :] ** self.powers, axis=-1) @ self.coefficients

    def gradients(self, xi: np.ndarray) -> np.ndarray:
        """Derivatives (n, 2, k) of the shape functions by the local coordinates xi (n, 2)."""
        (x, y), (p, q) = xi.T[:, :, None], self.powers.T
        by_x = p * x ** np.maximum(p - 1, 0) * y**q
        by_y = q * x**p * y ** np.maximum(q - 1, 0)
        return np.stack([by_x, by_y], axis=1) @ self.coefficients

    def clipped(self, xi: np.ndarray) -> np.ndarray:
        """Points xi (n, 2), or ones of the element next to them."""
        if self.corners == 4:
            return np.clip(xi, -1.0, 1.0)
        xi = np.maximum(xi, 0.0)
        return xi / np.maximum(xi.sum(axis=1, keepdims=True), 1.0)


def _reference(corners: list[tuple[int, int]], powers: list[tuple[int, int]]) -> ReferenceElement:
    """The element with these corners and as many further nodes as it has monomials."""
    corner = np.array(corners, dtype=float)
    middles = (corner + np.roll(corner, -1, axis=0)) / 2
    nodes = np.concatenate([corner, middles, corner.mean(axis=0, keepdims=True)])
    return ReferenceElement(nodes[: len(powers)], np.array(powers), len(corners))


_TRIANGLE, _SQUARE = [(0, 0), (1, 0), (0, 1)], [(-1, -1), (1, -1), (1, 1), (-1, 1)]
_LINEAR, _BILINEAR = [(0, 0), (1, 0), (0, 1)], [(0, 0), (1, 0), (0, 1), (1, 1)]
_QUADRATIC, _SERENDIPITY = [*_BILINEAR, (2, 0), (0, 2)], [*_BILINEAR, (2, 0), (0, 2), (2, 1), (1, 2)]

#: plane elements by their names in meshio
ELEMENTS: dict[str, ReferenceElement] = {
    "triangle": _reference(_TRIANGLE, _LINEAR),
    "triangle6": _reference(_TRIANGLE, _QUADRATIC),
    "quad": _reference(_SQUARE, _BILINEAR),
    "quad8": _reference(_SQUARE, _SERENDIPITY),
    "quad9": _reference(_SQUARE, [*_SERENDIPITY, (2, 2)]),
}


class _Places(NamedTuple):
    """Where points lie: at local coordinates of elements, or outside, beside such a place on the boundary."""

    element: np.ndarray  # (k,), counted through all types
    xi: np.ndarray  # (k, 2)
    offset: np.ndarray  # (k, 2) from the place to the point, mm; zero inside


class _Boundary(NamedTuple):
    """Edges that belong to one element only."""

    element: np.ndarray  # (b,)
    xi: np.ndarray  # (b, 2 ends, 2) local coordinates
    curve: np.ndarray  # (b, 3, 2) start, end, middle, mm
    tree: shapely.STRtree


@dataclass(frozen=True)
class DisplacementField:
    """Displacements of a plane finite element model.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Nodes, mm. A third coordinate is dropped when it is the same for all nodes of elements.
    cells : mapping of str to ndarray, shape (m, k)
        Node numbers, counted from 0, of the elements of each type: "triangle", "triangle6", "quad", "quad8", "quad9",
        in VTK's order. Clockwise elements are turned around. Nodes without element are allowed.
    u : ndarray, shape (n, 2)
        Nodal displacements, mm.

    Raises
    ------
    ValueError
        When shapes do not fit, a type or a node is unknown, a node of an element has no finite coordinates or
        displacement, the model is not plane, or an element has no area or is folded over.

    Examples
    --------
    >>> points = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    >>> field = DisplacementField(points, {"quad": np.array([[0, 1, 2, 3]])}, u=0.01 * points)
    >>> field.displacement(np.array([[1.0, 0.5]]))
    array([[0.01 , 0.005]])
    >>> field.covers(np.array([[1.0, 0.5], [3.0, 0.5]]))
    array([ True, False])
    """

    points: np.ndarray
    cells: Mapping[str, np.ndarray]
    u: np.ndarray

    def __post_init__(self) -> None:
        points, u = np.array(self.points, dtype=float), np.array(self.u, dtype=float)
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            raise ValueError(f"points have shape {points.shape}: must be (n, 2), or (n, 3) with constant z")
        if u.shape != (len(points), 2):
            raise ValueError(f"u has shape {u.shape}: must be {(len(points), 2)}, one row for each point")
        cells = {kind: _checked_cells(kind, nodes, len(points)) for kind, nodes in self.cells.items()}
        cells = {kind: nodes for kind, nodes in cells.items() if len(nodes)}
        if not cells:
            raise ValueError("cells: there is no element")
        used = np.unique(np.concatenate([nodes.ravel() for nodes in cells.values()]))
        for name, value in (("points", points), ("u", u)):
            wrong = used[~np.isfinite(value[used]).all(axis=1)]
            if len(wrong):
                raise ValueError(
                    f"{name}[{wrong[0]}] = {value[wrong[0]].tolist()}: must be finite, as for every node of an "
                    f"element ({len(wrong)} of {len(used)} are not)"
                )
        points = _projected(points, used)
        cells = {kind: _oriented(kind, nodes, points) for kind, nodes in cells.items()}
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", cells)
        object.__setattr__(self, "u", u)

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacements (k, 2) at points (k, 2), mm.

        A point outside all elements is served by the element at the nearest point of the boundary: its displacement
        there, continued with the displacement gradient at its centre. ``covers`` tells how far that is trusted.

        Raises
        ------
        ValueError
            When a point is not finite or the shape is another one.
        """
        places = self._locate(_checked_query(points))
        u = np.empty_like(places.offset)
        for (kind, nodes), of_kind, element in self._by_kind(places.element):
            reference = ELEMENTS[kind]
            nodal_u = self.u[nodes[element]]
            u[of_kind] = np.einsum("nk,nkd->nd", reference.shape_functions(places.xi[of_kind]), nodal_u)
            outside = places.offset[of_kind].any(axis=1)
            if outside.any():
                corners, nodal_u = self.points[nodes[element[outside]]], nodal_u[outside]
                by_xi = reference.gradients(reference.middle[None])[0]
                slope = np.linalg.solve(by_xi @ corners, by_xi @ nodal_u)
                index = of_kind[outside]
                u[index] += np.einsum("nd,nde->ne", places.offset[index], slope)
        return u

    def covers(self, points: np.ndarray, tolerance: float = COVERED) -> np.ndarray:
        """Which points (k, 2), mm, lie in the model, or beside it by no more than ``tolerance`` element sizes.

        The outline of a model of straight-edged elements cuts the corners of a round notch; the default lets points
        of the true outline pass.
        """
        places = self._locate(_checked_query(points))
        distance = np.linalg.norm(places.offset, axis=1)
        return distance <= tolerance * np.sqrt(self._element_areas[places.element])

    def element_size(self, points: np.ndarray) -> np.ndarray:
        """Square root of the area of the element at each point (k, 2), or nearest to it: shape (k,), mm."""
        return np.sqrt(self._element_areas[self._locate(_checked_query(points)).element])

    def area(self) -> float:
        """Area of all elements, mm2."""
        return float(self._element_areas.sum())

    @cached_property
    def _first(self) -> np.ndarray:
        """The number of the first element of each type, when counted through all types; at the end, of all."""
        return np.cumsum([0, *(len(nodes) for nodes in self.cells.values())])

    @cached_property
    def _element_areas(self) -> np.ndarray:
        return np.concatenate([_areas(kind, self.points[nodes]) for kind, nodes in self.cells.items()])

    @cached_property
    def _tree(self) -> shapely.STRtree:
        """Boxes around all elements."""
        low, high = (
            np.concatenate([f(_hull(kind, self.points[nodes])) for kind, nodes in self.cells.items()])
            for f in (lambda hull: hull.min(axis=1), lambda hull: hull.max(axis=1))
        )
        margin = TOUCH * np.sqrt(self._element_areas)[:, None]
        return shapely.STRtree(shapely.box(*(low - margin).T, *(high + margin).T))

    @cached_property
    def _boundary(self) -> _Boundary:
        ends, element, xi, curve = [], [], [], []
        for (kind, nodes), first in zip(self.cells.items(), self._first, strict=False):
            edges = ELEMENTS[kind].edges
            on_edge = nodes[:, edges].reshape(-1, edges.shape[1])
            at = self.points[on_edge]
            if edges.shape[1] == 2:
                at = np.concatenate([at, at.mean(axis=1, keepdims=True)], axis=1)
            ends.append(np.sort(on_edge[:, :2], axis=1))
            element.append(first + np.repeat(np.arange(len(nodes)), len(edges)))
            xi.append(np.tile(ELEMENTS[kind].nodes[edges[:, :2]], (len(nodes), 1, 1)))
            curve.append(at)
        pairs, index, count = np.unique(np.concatenate(ends), axis=0, return_index=True, return_counts=True)
        # an edge from a node to itself is a collapsed one
        alone = index[(count == 1) & (pairs[:, 0] < pairs[:, 1])]
        element, xi, curve = (np.concatenate(value)[alone] for value in (element, xi, curve))
        s = np.linspace(0, 1, EDGE_PIECES + 1)
        polylines = _on_edge(curve[:, None], s[None, :])[0]
        return _Boundary(element, xi, curve, shapely.STRtree(shapely.linestrings(polylines)))

    def _by_kind(self, element: np.ndarray):
        """For each type its name and nodes, which of the elements given are of it, and their numbers there."""
        for item, first, end in zip(self.cells.items(), self._first[:-1], self._first[1:], strict=True):
            of_kind = np.flatnonzero((element >= first) & (element < end))
            yield item, of_kind, element[of_kind] - first

    def _locate(self, points: np.ndarray) -> _Places:
        places = _Places(np.full(len(points), -1), np.zeros((len(points), 2)), np.zeros((len(points), 2)))
        which, candidate = self._tree.query(shapely.points(points))
        # Newton's method from the middle finds nearly all; in a strongly distorted element it may take another start
        for start in range(5):
            left = places.element[which] < 0
            which, candidate = which[left], candidate[left]
            if len(which) == 0:
                break
            self._find(points, which, candidate, start, places)
        outside = np.flatnonzero(places.element < 0)
        if len(outside):
            self._project(points, outside, places)
        return places

    def _find(
        self, points: np.ndarray, which: np.ndarray, candidate: np.ndarray, start: int, places: _Places
    ) -> None:
        """Note for points that lie in one of their candidate elements which one it is, and where there."""
        xi, distance = np.zeros((len(which), 2)), np.full(len(which), np.inf)
        for (kind, nodes), of_kind, element in self._by_kind(candidate):
            reference = ELEMENTS[kind]
            if len(of_kind) and start < len(reference.inner_points):
                xi[of_kind], distance[of_kind] = _local_coordinates(
                    reference,
                    self.points[nodes[element]],
                    points[which[of_kind]],
                    reference.inner_points[start],
                )
        distance /= np.sqrt(self._element_areas[candidate])
        order = np.lexsort((distance, which))
        best = order[np.unique(which[order], return_index=True)[1]]
        best = best[distance[best] <= TOUCH]
        places.element[which[best]] = candidate[best]
        places.xi[which[best]] = xi[best]

    def _project(self, points: np.ndarray, outside: np.ndarray, places: _Places) -> None:
        """Note for points outside all elements the nearest place on the boundary."""
        boundary = self._boundary
        edge = boundary.tree.query_nearest(shapely.points(points[outside]), all_matches=False)[1]
        s, nearest = _nearest_on_edge(boundary.curve[edge], points[outside])
        start, end = boundary.xi[edge, 0], boundary.xi[edge, 1]
        places.element[outside] = boundary.element[edge]
        places.xi[outside] = start + s[:, None] * (end - start)
        places.offset[outside] = points[outside] - nearest


def _checked_query(points: np.ndarray) -> np.ndarray:
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(f"points have shape {points.shape}: must be (k, 2)")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise ValueError(f"points[{wrong[0]}] = {points[wrong[0]].tolist()}: must be finite")
    return points


def _checked_cells(kind: str, nodes: np.ndarray, n_points: int) -> np.ndarray:
    """Elements of one type as node numbers, if they are that."""
    if kind not in ELEMENTS:
        raise ValueError(f"cells of type {kind!r}: plane elements are {', '.join(ELEMENTS)}")
    nodes = np.asarray(nodes)
    width = len(ELEMENTS[kind].nodes)
    if nodes.ndim != 2 or nodes.shape[1] != width or not np.issubdtype(nodes.dtype, np.integer):
        raise ValueError(
            f"cells[{kind!r}] has shape {nodes.shape} and type {nodes.dtype}: must be (m, {width}) node numbers"
        )
    nodes = nodes.astype(np.int64)
    wrong = np.argwhere((nodes < 0) | (nodes >= n_points))
    if len(wrong):
        i, j = wrong[0]
        raise ValueError(f"{kind} {i} has node {nodes[i, j]}: nodes are numbered from 0 to {n_points - 1}")
    return nodes


def _projected(points: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Points without z, which must not vary over those used."""
    if points.shape[1] == 3:
        z, extent = points[used, 2], np.ptp(points[used, :2], axis=0).max()
        if np.ptp(z) > 1e-5 * extent:
            raise ValueError(
                f"z varies from {z.min():g} to {z.max():g} mm: a plane model in the x-y plane is needed"
            )
    return np.ascontiguousarray(points[:, :2])


def _oriented(kind: str, nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Elements of one type with nodes counter-clockwise, each of which maps to a piece of the plane."""
    reference = ELEMENTS[kind]
    area = _areas(kind, points[nodes])
    extent = np.ptp(points[nodes], axis=1).max(axis=1)
    flat = np.flatnonzero(np.abs(area) <= 1e-10 * extent**2)
    if len(flat):
        i = flat[0]
        raise ValueError(f"{kind} {i} (nodes {nodes[i].tolist()}) has no area ({len(flat)} such elements)")
    nodes = np.where((area < 0)[:, None], nodes[:, reference.turned], nodes)
    stretch = np.linalg.det(reference.gradients(reference.inner_points) @ points[nodes][:, None])
    folded = np.flatnonzero((stretch <= 0).any(axis=1))
    if len(folded):
        i = folded[0]
        raise ValueError(
            f"{kind} {i} (nodes {nodes[i].tolist()}) is folded over: its determinant changes sign; are its nodes "
            f"in order? ({len(folded)} such elements)"
        )
    return nodes


def _areas(kind: str, corners: np.ndarray) -> np.ndarray:
    """Areas (m,) of elements with nodes (m, k, 2), negative if clockwise: a polygon and a parabola on each edge."""
    edges = ELEMENTS[kind].edges
    # from a corner of its own, so that far from the origin nothing cancels
    corners = corners - corners[:, :1]
    start, end = corners[:, edges[:, 0]], corners[:, edges[:, 1]]
    area = _cross(start, end) / 2
    if edges.shape[1] == 3:
        area -= 2 / 3 * _cross(end - start, corners[:, edges[:, 2]] - (start + end) / 2)
    return area.sum(axis=1)


def _hull(kind: str, corners: np.ndarray) -> np.ndarray:
    """Points (m, k', 2) between which the edges of elements with nodes (m, k, 2) lie: their control polygon."""
    edges = ELEMENTS[kind].edges
    start, end = corners[:, edges[:, 0]], corners[:, edges[:, 1]]
    if edges.shape[1] == 2:
        return start
    return np.concatenate([start, 2 * corners[:, edges[:, 2]] - (start + end) / 2], axis=1)


def _local_coordinates(
    reference: ReferenceElement, corners: np.ndarray, points: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Local coordinates (n, 2) of points (n, 2) in elements with nodes (n, k, 2), clipped to them.

    Also the distance (n,), mm, that is left between the point and the place with these coordinates.
    """
    low, high = reference.nodes.min() - 0.5, reference.nodes.max() + 0.5
    xi = np.tile(start, (len(points), 1))
    active = np.arange(len(points))
    for _ in range(ITERATIONS):
        at = corners[active]
        missing = points[active] - np.einsum("nk,nkd->nd", reference.shape_functions(xi[active]), at)
        (a, b), (c, d) = (reference.gradients(xi[active]) @ at).transpose(1, 2, 0)
        determinant = a * d - b * c
        # at a collapsed corner the map has no inverse: stay there
        safe = np.where(determinant == 0, np.inf, determinant)
        step = np.stack(
            [(d * missing[:, 0] - c * missing[:, 1]) / safe, (a * missing[:, 1] - b * missing[:, 0]) / safe],
            axis=1,
        )
        new = np.clip(xi[active] + step, low, high)
        change = np.abs(new - xi[active]).max(axis=1)
        xi[active] = new
        active = active[change > 1e-13]
        if len(active) == 0:
            break
    xi = reference.clipped(xi)
    reached = np.einsum("nk,nkd->nd", reference.shape_functions(xi), corners)
    return xi, np.linalg.norm(points - reached, axis=1)


def _on_edge(curve: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of edges (start, end, middle) at s in 0 to 1, with first and second derivative by s."""
    start, end, middle = (curve[..., i, :] for i in range(3))
    chord, bulge, s = end - start, 4 * (middle - (start + end) / 2), s[..., None]
    return (
        start + s * chord + s * (1 - s) * bulge,
        chord + (1 - 2 * s) * bulge,
        np.broadcast_to(-2 * bulge, chord.shape),
    )


def _nearest_on_edge(curve: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The s (n,) and the point (n, 2) of each edge (n, 3, 2) that is nearest to a point (n, 2)."""
    samples = np.linspace(0, 1, EDGE_PIECES + 1)
    distance = np.linalg.norm(_on_edge(curve[:, None], samples[None, :])[0] - points[:, None], axis=-1)
    s = samples[distance.argmin(axis=1)]
    for _ in range(ITERATIONS):
        at, slope, bend = _on_edge(curve, s)
        descent = np.sum((at - points) * slope, axis=1)
        length = np.sum(slope * slope, axis=1)
        # where the distance is not convex, and at the end of a quarter-point edge, where it stands still
        curvature = np.maximum(length + np.sum((at - points) * bend, axis=1), 0.25 * length)
        s = np.clip(s - np.divide(descent, curvature, out=np.zeros_like(s), where=curvature > 0), 0, 1)
    return s, _on_edge(curve, s)[0]


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
