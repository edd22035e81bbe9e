"""Nodes of parts that a file has apart, although the parts hang together, become one.

Programs give each element nodes of its own where they allow jumps (discontinuous Galerkin methods, deal.II's output),
and each piece of a mesh that was computed in parallel. Nothing would hang together then, and every edge would be a
crack. What is joined are coincident nodes of *different* parts, within each of which elements share nodes, when they
have the same displacement. The faces of a crack stay apart: in one part because the mesh says so, between two because
they move apart. Where such faces move as one, nothing is released there, and the crack ends where they begin to.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

#: coordinates are the same within this share of the model's size: the digits of a file or of single precision
SAME_PLACE = 1e-6
#: displacements are the same within this share of their range, and this one of the largest, where a rigid motion takes
#: digits away: single precision, or six digits in a text. A crack of 1e-3 of the part is open by more
SAME_IN_RANGE, SAME_OF_LARGEST = 1e-5, 1e-6


def joined(
    points: np.ndarray, cells: Mapping[str, np.ndarray], u: np.ndarray
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Elements whose parts hang together, and which node stands for each.

    Parameters
    ----------
    points, u : ndarray (n, 2 or 3)
        Nodes and their displacements, mm.
    cells : mapping of str to ndarray (m, k)
        Nodes of the elements of each kind.

    Returns
    -------
    cells : dict of str to ndarray (m, k)
    node : ndarray (n,)
        The first of the nodes that are one; its own number for any other.

    Raises
    ------
    ValueError
        When the displacements jump from element to element, so that nothing hangs together.

    Examples
    --------
    Two triangles with an edge in common, each with nodes of its own.

    >>> points = np.array([[0.0, 0], [1, 0], [0, 1], [1, 0], [1, 1], [0, 1]])
    >>> joined(points, {"triangle": np.arange(6).reshape(2, 3)}, 0.01 * points)[0]["triangle"].tolist()
    [[0, 1, 2], [1, 4, 2]]
    """
    n, node = len(points), np.arange(len(points))
    cells = {kind: np.asarray(nodes) for kind, nodes in cells.items()}
    first = [np.repeat(nodes[:, 0], nodes.shape[1] - 1) for nodes in cells.values() if len(nodes)]
    other = [nodes[:, 1:].ravel() for nodes in cells.values() if len(nodes)]
    if not first:
        return cells, node
    part = _components(n, np.concatenate(first), np.concatenate(other))
    used = np.unique(np.concatenate([nodes.ravel() for nodes in cells.values()]))
    used = used[np.isfinite(points[used]).all(axis=1) & np.isfinite(u[used]).all(axis=1)]
    if len(np.unique(part[used])) < 2:
        return cells, node
    size = np.ptp(points[used], axis=0).max()
    pairs = used[cKDTree(points[used]).query_pairs(SAME_PLACE * size, output_type="ndarray")]
    pairs = pairs[part[pairs[:, 0]] != part[pairs[:, 1]]]
    jump = np.abs(u[pairs[:, 0]] - u[pairs[:, 1]]).max(axis=1)
    same = SAME_IN_RANGE * np.ptp(u[used], axis=0).max() + SAME_OF_LARGEST * np.abs(u[used]).max()
    equal = pairs[jump <= same]
    _, of_node = np.unique(_components(n, *equal.T), return_inverse=True)
    lowest = np.full(n, n)
    np.minimum.at(lowest, of_node, node)
    node = lowest[of_node]
    _check_continuous(part, pairs, node, sum(len(nodes) for nodes in cells.values()), jump)
    return {kind: node[nodes] for kind, nodes in cells.items()}, node


def first_of_equal(nodes: np.ndarray) -> np.ndarray:
    """Which of the elements (m, k) have nodes that none before has, in order."""
    return np.sort(np.unique(np.sort(nodes, axis=1), axis=0, return_index=True)[1])


def mean_of_joined(values: np.ndarray, node: np.ndarray) -> np.ndarray:
    """Nodal values (n, ...), those of nodes that are one as their mean."""
    count = np.bincount(node, minlength=len(node))
    flat = values.reshape(len(values), -1)
    means = np.stack([np.bincount(node, column, len(node)) for column in flat.T], axis=1)
    return (means[node] / count[node, None]).reshape(values.shape)


def _check_continuous(
    part: np.ndarray, pairs: np.ndarray, node: np.ndarray, elements: int, jump: np.ndarray
) -> None:
    """Refuse displacements that jump from element to element.

    The sign is places where three parts and more meet, as around every corner of a mesh: of cracks they are the few
    points where one branches.
    """
    if not len(pairs):
        return
    n = len(node)
    _, place = np.unique(_components(n, *pairs.T), return_inverse=True)
    here = np.unique(pairs)
    before = np.bincount(place[here], minlength=n)
    apart = np.unique(np.stack([place[here], node[here]], axis=1), axis=0)
    after = np.bincount(apart[:, 0], minlength=n)
    many = before >= 3
    if (after[many] >= 3).sum() > many.sum() / 2 or (
        not many.any() and len(np.unique(part[here])) == elements and (after[before > 1] > 1).all()
    ):
        raise ValueError(
            f"elements share no nodes, and their displacements jump by up to {jump.max():.3g} mm from one to the next: "
            "a continuous field is needed (projected or averaged by the program that made it)"
        )


def _components(n: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The number of the part that each of n nodes is in, by pairs that hang together."""
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(n, n))
    return connected_components(graph, directed=False)[1]
