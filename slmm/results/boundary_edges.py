"""Edges of one element only: the boundary of a mesh of plane elements."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from slmm.mechanics.elements import element_named


def boundary_edges(points: np.ndarray, cells: Mapping[str, np.ndarray]) -> np.ndarray:
    """Nodes (e, 3) of the edges on the boundary, the material on their left: start, end, and middle or else -1.

    Parameters
    ----------
    points : ndarray (n, 2)
        Nodes, mm.
    cells : mapping of str to ndarray (el, k)
        Nodes of the elements of each type, anticlockwise.

    Raises
    ------
    ValueError
        For elements that are not plane, or have more than one node between the ends of an edge.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> boundary_edges(square, {"CPE3": np.array([[0, 1, 2], [0, 2, 3]])})[:, :2].tolist()
    [[0, 1], [1, 2], [2, 3], [3, 0]]
    """
    found = []
    for name, nodes in cells.items():
        local = element_named(name).edges
        if local.shape[1] > 3:
            raise ValueError(
                f"edges of {name} have {local.shape[1]} nodes: a boundary has two or three on each edge"
            )
        edges = np.asarray(nodes)[:, local].reshape(-1, local.shape[1])
        found.append(np.pad(edges, ((0, 0), (0, 3 - edges.shape[1])), constant_values=-1))
    edges = np.concatenate(found)
    # collapsed elements have edges without length
    edges = edges[np.any(points[edges[:, 0]] != points[edges[:, 1]], axis=1)]
    _, of_edge, count = np.unique(
        np.sort(edges[:, :2], axis=1), axis=0, return_inverse=True, return_counts=True
    )
    return edges[count[of_edge.ravel()] == 1]
