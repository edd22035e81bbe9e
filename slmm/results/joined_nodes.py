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

#: coordinates are the same within this share of the model's size: the digits of a file or of single
#: precision; round-off
SAME_PLACE = 1e-6
#: displacements are the same within this share of their range, and this one of the largest, where a rigid motion takes
#: digits away: single precision, or six digits in a text. A crack of 1e-3 of the part is open by more; round-off
SAME_IN_RANGE, SAME_OF_LARGEST = 1e-5, 1e-6
#: places within that distance of a place, on average, beyond which coordinates have too few digits; chosen
MOST_NEIGHBOURS = 10


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
    here = np.zeros(n, dtype=bool)
    for nodes in cells.values():
        here[nodes] = True
    used = np.flatnonzero(here & np.isfinite(points).all(axis=1) & np.isfinite(u).all(axis=1))
    if not len(used) or (part[used] == part[used[0]]).all():
        return cells, node
    part, u = part[used], u[used]
    place = _places(points[used])
    several = _several(place, part)
    same = SAME_IN_RANGE * np.ptp(u, axis=0).max() + SAME_OF_LARGEST * np.abs(u).max()
    group = place
    for component in u.T:
        group = _cut(group, component, same)
    # of nodes that coincide and move as one, those of one part alone are the faces of a crack
    together = _several(group, part)[group]
    lowest = np.full(group.max() + 1, n)
    np.minimum.at(lowest, group, used)
    node[used[together]] = lowest[group[together]]
    elements = sum(len(nodes) for nodes in cells.values())
    _check_continuous(place, several, part, node[used], u, elements)
    return {kind: node[nodes] for kind, nodes in cells.items()}, node


def first_of_equal(nodes: np.ndarray) -> np.ndarray:
    """Which of the elements (m, k) have nodes that none before has, in order."""
    return np.sort(_first_of_equal_rows(np.sort(nodes, axis=1))[0])


def mean_of_joined(values: np.ndarray, node: np.ndarray) -> np.ndarray:
    """Nodal values (n, ...), those of nodes that are one as their mean."""
    count = np.bincount(node, minlength=len(node))
    flat = values.reshape(len(values), -1)
    means = np.stack([np.bincount(node, column, len(node)) for column in flat.T], axis=1)
    return (means[node] / count[node, None]).reshape(values.shape)


def _places(points: np.ndarray) -> np.ndarray:
    """The number of the place at which each node lies."""
    first, of_node = _first_of_equal_rows(points)
    tree = cKDTree(points[first])
    reach = SAME_PLACE * np.ptp(points, axis=0).max()
    if tree.count_neighbors(tree, reach) > MOST_NEIGHBOURS * len(first):
        raise ValueError(
            f"nodes lie closer to each other than {reach:.3g} mm, {SAME_PLACE:g} of the model's size: is one far away?"
        )
    near = tree.query_pairs(reach, output_type="ndarray")
    return _components(len(first), *near.T)[of_node]


def _first_of_equal_rows(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The first of the rows that are equal, and the number of these for each row."""
    order = np.lexsort(rows.T)
    new = np.ones(len(rows), dtype=bool)
    new[1:] = (rows[order[1:]] != rows[order[:-1]]).any(axis=1)
    number = np.empty(len(rows), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    return order[new], number


def _cut(group: np.ndarray, values: np.ndarray, same: float) -> np.ndarray:
    """Groups, each cut where its sorted values have a gap."""
    order = np.lexsort([values, group])
    new = np.zeros(len(group), dtype=bool)
    new[1:] = (np.diff(group[order]) != 0) | (np.diff(values[order]) > same)
    result = np.empty(len(group), dtype=np.int64)
    result[order] = np.cumsum(new)
    return result


def _several(group: np.ndarray, part: np.ndarray) -> np.ndarray:
    """Which groups have nodes of several parts."""
    low = np.full(group.max() + 1, part.max() + 1)
    high = np.full(group.max() + 1, -1)
    np.minimum.at(low, group, part)
    np.maximum.at(high, group, part)
    return low < high


def _check_continuous(
    place: np.ndarray, several: np.ndarray, part: np.ndarray, node: np.ndarray, u: np.ndarray, elements: int
) -> None:
    """Refuse displacements that jump from element to element.

    The sign is places where three parts and more meet, as around every corner of a mesh: of cracks they are the few
    points where one branches.
    """
    here = several[place]
    if not here.any():
        return
    first, _ = _first_of_equal_rows(np.stack([place[here], node[here]], axis=1))
    before = np.bincount(place[here], minlength=len(several))
    after = np.bincount(place[here][first], minlength=len(several))
    many = before >= 3
    loose = len(np.unique(part[here])) == elements and (after[before > 1] > 1).all()
    if (after[many] >= 3).sum() > many.sum() / 2 or (loose and not many.any()):
        low, high = np.full((2, len(several), u.shape[1]), np.inf)
        np.minimum.at(low, place[here], u[here])
        np.minimum.at(high, place[here], -u[here])
        jump = -(low + high)[several].min()
        raise ValueError(
            f"elements share no nodes, and their displacements jump by up to {jump:.3g} mm from one to the next: "
            "a continuous field is needed (projected or averaged by the program that made it)"
        )


def _components(n: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The number of the part that each of n nodes is in, by pairs that hang together."""
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(n, n))
    return connected_components(graph, directed=False)[1]
