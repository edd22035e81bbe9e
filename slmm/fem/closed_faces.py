"""Faces of cracks in a body-fitted model that would overlap hold each other, node to node and without friction.

Both faces of a slit have the same edges. Where a node has another one on the other face, their distance across an edge
cannot fall below nothing; at a kink it cannot across either edge, and where cracks meet across the edges of each. The
forces of pressures on quadratic edges are of one sign at corners and middles alike, so that a force between two nodes
that pulls is none of contact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from slmm.mechanics.faces_in_contact import ROUND_OFF, closing_pressures

Array = NDArray[np.float64]

#: edges of a crack that turn by less, rad, are straight; round-off of their points
STRAIGHT = 1e-7
#: of a pressure on a quadratic edge its corners and its middle carry so much; also how much of its length a node stands
#: for
SHARES = np.array([1.0, 4.0, 1.0]) / 6.0
#: forces whose displacements are held in memory at once: 100 MB of the finest meshes; chosen
AT_ONCE = 128


class NodePairs(NamedTuple):
    """Nodes of both faces of cracks that lie on each other, once for each direction across.

    Attributes
    ----------
    nodes : ndarray of int, shape (m, 2)
        On the right and on the left face.
    across : ndarray, shape (m, 2)
        Unit vectors from the right to the left face.
    length : ndarray, shape (m,)
        Of the crack that each pair stands for, mm.
    """

    nodes: NDArray[np.int64]
    across: Array
    length: Array

    @classmethod
    def of(cls, points: Array, faces: Sequence[NDArray[np.int64]]) -> NodePairs:
        """Those of cracks, given by the nodes (e, 3, 2) of their edges.

        Examples
        --------
        Two edges in a line that begin at a tip have four pairs.

        >>> points = np.array([[0, 0], [1, 0], [2, 0], [3, 0], [4, 0], [1, 0], [2, 0], [3, 0], [4, 0]], dtype=float)
        >>> pairs = NodePairs.of(points, [np.array([[[0, 0], [1, 5], [2, 6]], [[2, 6], [3, 7], [4, 8]]])])
        >>> pairs.nodes.tolist(), pairs.length.round(3).tolist()
        ([[1, 5], [2, 6], [3, 7], [4, 8]], [1.333, 0.667, 1.333, 0.333])
        """
        nodes: list[tuple[int, int]] = []
        across: list[Array] = []
        length: list[float] = []
        last: dict[tuple[int, int], int] = {}
        for edges in faces:
            along = points[edges[:, 2, 0]] - points[edges[:, 0, 0]]
            size = np.linalg.norm(along, axis=1)
            normal = np.column_stack([-along[:, 1], along[:, 0]]) / size[:, None]
            for edge, n, each in zip(edges.tolist(), normal, size.tolist(), strict=True):
                for (right, left), share in zip(edge, SHARES.tolist(), strict=True):
                    if right == left:
                        continue
                    k = last.get((right, left), -1)
                    if k < 0 or np.abs(across[k] - n).max() > STRAIGHT:
                        k = last[right, left] = len(nodes)
                        nodes.append((right, left))
                        across.append(n)
                        length.append(0.0)
                    length[k] += share * each
        return cls(
            np.array(nodes, dtype=int).reshape(-1, 2), np.array(across).reshape(-1, 2), np.array(length)
        )

    def openings(self, n: int) -> sp.csr_array:
        """From displacements of n nodes to how far the pairs are apart; (m, 2 n)."""
        m = len(self.nodes)
        column = (2 * self.nodes[:, ::-1, None] + np.arange(2)).reshape(m, 4)
        entry = np.concatenate([self.across, -self.across], axis=1)
        row = np.repeat(np.arange(m), 4)
        return sp.csr_array((entry.ravel(), (row, column.ravel())), shape=(m, 2 * n))


def held_closed(
    openings: sp.csr_array, u: Array, solve: Callable[[Array], Array], moves: float
) -> tuple[Array, NDArray[np.bool_]] | None:
    """What faces that hold each other add to displacements (2 n,), and which pairs touch (m,); None where none overlap.

    Parameters
    ----------
    openings : sparse array, shape (m, 2 n)
        See `NodePairs.openings`.
    u : ndarray, shape (2 n,)
        Displacements where faces are free, mm.
    solve : callable
        Displacements (2 n, k) by nodal forces (2 n, k), or (2 n,) by (2 n,).
    moves : float
        How far faces move against each other at most, mm.

    Raises
    ------
    slmm.mechanics.faces_in_contact.ContactError
        When the search for the places that touch does not end.
    """
    gap = openings @ u
    if not (gap < -ROUND_OFF * moves).any():
        return None

    def by_force(places: NDArray[np.int64]) -> Array:
        turns = np.array_split(places, -(-len(places) // AT_ONCE))
        return np.concatenate([openings @ solve(openings[of].T.toarray()) for of in turns], axis=1)

    force, closed = closing_pressures(gap, by_force, moves)
    return solve(openings.T @ force), closed
