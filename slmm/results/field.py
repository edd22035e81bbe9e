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

from slmm.results.curved_edges import EDGE_PIECES, nearest_on_edge, on_edge
from slmm.results.plane_elements import PLANE_ELEMENTS

#: a point this close to an element is a point of it, in element sizes: nodes of files have six digits; chosen
TOUCH = 1e-6
#: a point this close to the model is covered by it: how far a notch may bulge over the chord of a linear element
#: that is not too coarse for it (0.4 radii long), in element sizes; chosen
COVERS = 0.05


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
        Node numbers, counted from 0, of the elements of each kind in `slmm.results.plane_elements`: "triangle",
        "triangle6", "quad", "quad8", "quad9", in VTK's order. Clockwise elements are turned around. Nodes without
        element are allowed.
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
            reference = PLANE_ELEMENTS[kind]
            nodal_u = self.u[nodes[element]]
            u[of_kind] = np.einsum("nk,nkd->nd", reference.shape(places.xi[of_kind]), nodal_u)
            outside = places.offset[of_kind].any(axis=1)
            if outside.any():
                at_nodes, nodal_u = self.points[nodes[element[outside]]], nodal_u[outside]
                middle = reference.middle[None]
                slope = np.linalg.solve(
                    reference.derivatives(middle, at_nodes), reference.derivatives(middle, nodal_u)
                )
                index = of_kind[outside]
                u[index] += np.einsum("nd,nde->ne", places.offset[index], slope)
        return u

    def covers(self, points: np.ndarray, tolerance: float = COVERS) -> np.ndarray:
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
        return np.concatenate(
            [PLANE_ELEMENTS[kind].areas(self.points[nodes]) for kind, nodes in self.cells.items()]
        )

    @cached_property
    def _tree(self) -> shapely.STRtree:
        """Boxes around all elements."""
        low, high = (
            np.concatenate(
                [f(PLANE_ELEMENTS[kind].hull(self.points[nodes])) for kind, nodes in self.cells.items()]
            )
            for f in (lambda hull: hull.min(axis=1), lambda hull: hull.max(axis=1))
        )
        margin = TOUCH * np.sqrt(self._element_areas)[:, None]
        return shapely.STRtree(shapely.box(*(low - margin).T, *(high + margin).T))

    @cached_property
    def _boundary(self) -> _Boundary:
        ends, element, xi, curve = [], [], [], []
        for (kind, nodes), first in zip(self.cells.items(), self._first, strict=False):
            edges = PLANE_ELEMENTS[kind].edges
            of_edge = nodes[:, edges].reshape(-1, edges.shape[1])
            at = self.points[of_edge]
            if edges.shape[1] == 2:
                at = np.concatenate([at, at.mean(axis=1, keepdims=True)], axis=1)
            ends.append(np.sort(of_edge[:, :2], axis=1))
            element.append(first + np.repeat(np.arange(len(nodes)), len(edges)))
            xi.append(np.tile(PLANE_ELEMENTS[kind].nodes[edges[:, :2]], (len(nodes), 1, 1)))
            curve.append(at)
        pairs, index, count = np.unique(np.concatenate(ends), axis=0, return_index=True, return_counts=True)
        # an edge from a node to itself is a collapsed one
        alone = index[(count == 1) & (pairs[:, 0] < pairs[:, 1])]
        element, xi, curve = (np.concatenate(value)[alone] for value in (element, xi, curve))
        s = np.linspace(0, 1, EDGE_PIECES + 1)
        polylines = on_edge(curve[:, None], s[None, :])[0]
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
            reference = PLANE_ELEMENTS[kind]
            if len(of_kind) and start < len(reference.inner_points):
                xi[of_kind], distance[of_kind] = reference.local_coordinates(
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
        s, nearest = nearest_on_edge(boundary.curve[edge], points[outside])
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
    if kind not in PLANE_ELEMENTS:
        raise ValueError(f"cells of type {kind!r}: plane elements are {', '.join(PLANE_ELEMENTS)}")
    nodes = np.asarray(nodes)
    width = len(PLANE_ELEMENTS[kind].nodes)
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
    reference = PLANE_ELEMENTS[kind]
    area = reference.areas(points[nodes])
    extent = np.ptp(points[nodes], axis=1).max(axis=1)
    flat = np.flatnonzero(np.abs(area) <= 1e-10 * extent**2)
    if len(flat):
        i = flat[0]
        raise ValueError(f"{kind} {i} (nodes {nodes[i].tolist()}) has no area ({len(flat)} such elements)")
    nodes = np.where((area < 0)[:, None], nodes[:, reference.turned[0]], nodes)
    stretch = np.linalg.det(reference.derivatives(reference.inner_points, points[nodes][:, None]))
    folded = np.flatnonzero((stretch <= 0).any(axis=1))
    if len(folded):
        i = folded[0]
        raise ValueError(
            f"{kind} {i} (nodes {nodes[i].tolist()}) is folded over: its determinant changes sign; are its nodes "
            f"in order? ({len(folded)} such elements)"
        )
    return nodes
