"""The boundary of a mesh of plane elements, edge after edge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from slmm.results.boundary_edges import boundary_edges

#: nodes closer than this share of the shortest boundary edge lie on each other; chosen
COINCIDENT = 1e-4
#: a turn to the left by nearly half a turn would be a needle of material without thickness: it is one to the right, of
#: faces that overlap by rounding, rad; chosen
NEEDLE = 0.02


@dataclass(frozen=True)
class BoundaryChain:
    """Edges of the boundary, the material on their left, and in which order one runs along them.

    Parameters
    ----------
    edges : ndarray (e, 3)
        Nodes: start, end, middle or else -1.
    along : ndarray (e, 2)
        From start to end, mm.
    after, before : ndarray (e,)
        The next edge and the one before, -1 where there is none.
    turn : ndarray (e,)
        Angle from an edge to the next one, rad, positive to the left: -pi at the tip of a slit.
    place : ndarray (n,)
        For each node the first one that lies where it does.
    """

    edges: np.ndarray
    along: np.ndarray
    after: np.ndarray
    before: np.ndarray
    turn: np.ndarray
    place: np.ndarray

    @property
    def length(self) -> np.ndarray:
        """Of the edges (e,), mm."""
        return np.hypot(*self.along.T)


def boundary_chain(points: np.ndarray, cells: Mapping[str, np.ndarray]) -> BoundaryChain:
    """The boundary of a mesh, in order.

    Where several parts of the boundary meet in a node, the void beside an edge says which edge is its next one.
    Elements that are collapsed may have several nodes at one place.

    Parameters
    ----------
    points : ndarray (n, 2)
    cells : mapping of str to ndarray (el, k)

    Raises
    ------
    ValueError
        For elements that are not plane.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> chain = boundary_chain(square, {"CPE4": np.array([[0, 1, 2, 3]])})
    >>> chain.after.tolist(), np.degrees(chain.turn).round(9).tolist()
    ([1, 2, 3, 0], [90.0, 90.0, 90.0, 90.0])
    """
    edges = boundary_edges(points, cells)
    place = _places(points, edges)
    along = points[edges[:, 1]] - points[edges[:, 0]]
    angle = np.arctan2(along[:, 1], along[:, 0])
    by_node: dict[int, list[int]] = {}
    by_place: dict[int, list[int]] = {}
    for k, start in enumerate(edges[:, 0].tolist()):
        by_node.setdefault(start, []).append(k)
        by_place.setdefault(int(place[start]), []).append(k)
    after, before = np.full(len(edges), -1), np.full(len(edges), -1)
    for k, end in enumerate(edges[:, 1].tolist()):
        leaving = by_node.get(end) or by_place.get(int(place[end]), [])
        if len(leaving) > 1:
            # the void is on the right: the first edge anticlockwise from the way back
            gap = (angle[leaving] - angle[k] - np.pi + 1e-6) % (2 * np.pi)
            leaving = [leaving[int(np.argmin(gap))]]
        if leaving:
            after[k] = leaving[0]
            before[leaving[0]] = k
    turn = (angle[after] - angle + np.pi) % (2 * np.pi) - np.pi
    turn[turn > np.pi - NEEDLE] -= 2 * np.pi
    return BoundaryChain(edges, along, after, before, turn, place)


def _places(points: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """For each node (n,) the first node that lies where it does; only boundary nodes are looked at."""
    nodes = np.unique(edges[:, :2])
    shortest = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1).min()
    close = cKDTree(points[nodes]).query_pairs(COINCIDENT * shortest, output_type="ndarray")
    graph = sp.coo_array((np.ones(len(close)), close.T), shape=(len(nodes), len(nodes)))
    _, group = connected_components(graph, directed=False)
    place = np.arange(len(points))
    place[nodes] = nodes[np.unique(group, return_index=True)[1][group]]
    return place
