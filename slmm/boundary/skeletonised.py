"""A fast direct solver: clusters of panels act on each other through their skeletons, pairs of these again, and so on.

Hierarchical scattering (Bremer, Gillman and Martinsson, BIT Numer. Math. 55 (2015) 367-397): of a cluster is known what
the unknowns y of its skeleton become by its own loads, c, and by what the skeleton feels of others, z: y = c - E z.
Clusters with z = S y, entries of the matrix, have (1 + E S) y = c - E z' by what others cause, z', and are one again.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as la

from slmm.boundary.equations import Equations
from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, Complex
from slmm.boundary.skeletons import Around, Numbers, Skeleton

#: points of the smallest clusters and of the runs of panels that these are made of, and unknowns of skeletons up to
#: which all that is left is factorised (chosen by the time)
LEAF, RUN, MOST_LEFT = 240, 60, 3000


class Skeletonised:
    """Solves the equations of a body cluster by cluster.

    Parameters
    ----------
    equations : Equations
    moves : ndarray, shape (2 n, k)
        What motions that nothing holds add to the equations.
    felt : ndarray, shape (k, 2 n)
        How much of each the unknowns are.
    """

    def __init__(self, equations: Equations, moves: Array, felt: Array) -> None:
        """Join cluster by cluster, and factorise what is left."""
        around = Around(equations, moves, felt)
        clusters = [_leaf(around, equations.panels, which) for which in _leaves(equations.panels)]
        while len(clusters) > 1:
            _reduce(around, clusters)
            if sum(len(c.columns) for c in clusters) <= MOST_LEFT:
                break
            clusters = [
                _joined(around, list(pair)) for pair in zip(clusters[::2], clusters[1::2], strict=True)
            ]
        self._top = clusters[0] if len(clusters) == 1 else _joined(around, clusters)

    def solve(self, right: Array) -> Array:
        """Solutions of the same shape as right-hand sides (2 n,) or (2 n, k)."""
        x = np.empty_like(right)
        y, own = self._top.alone(right)
        self._top.settle(y, own, x)
        return x


class _Cluster:
    """Equations and unknowns of panels, or of the skeletons of clusters that are its parts.

    Parameters
    ----------
    rows, columns : ndarray of int
        Equations and unknowns.
    matrix : ndarray
        What is to be solved inside.
    parts : sequence of _Cluster
    between : ndarray
        What the parts' unknowns cause at other parts.

    Attributes
    ----------
    rows, columns : ndarray of int
        Once it is reduced those of its skeleton.
    answer : ndarray
        What the latter lose by what the former feel of other clusters.
    """

    def __init__(
        self,
        rows: Numbers,
        columns: Numbers,
        matrix: Array,
        parts: list[_Cluster] | None = None,
        between: Array | None = None,
    ) -> None:
        """Factorise."""
        self.rows, self.columns, self._unknowns = rows, columns, columns
        self._parts, self._between = parts or [], between
        # transposed it is stored as LAPACK wants it
        self._lu = la.lu_factor(matrix.T, overwrite_a=True, check_finite=False)
        self.answer = self._by_felt = self._of_rows = self._of_columns = np.empty((0, 0))

    def reduce(self, equations: Skeleton, unknowns: Skeleton) -> None:
        """Be known to others by skeletons."""
        self.rows, self.columns = self.rows[equations.kept], self.columns[unknowns.kept]
        self._of_rows, self._of_columns = equations.shares.T, unknowns.shares
        felt = (
            _by_parts([part.answer for part in self._parts], self._of_rows) if self._parts else self._of_rows
        )
        self._by_felt = la.lu_solve(self._lu, felt, trans=1, check_finite=False)
        self.answer = self._of_columns @ self._by_felt

    def alone(self, right: Array) -> tuple[Array, list[Any]]:
        """What its unknowns are without others by right-hand sides of the whole, and the same of its parts."""
        own = [part.alone(right) for part in self._parts]
        loads = [part._of_columns @ y for part, (y, _) in zip(self._parts, own, strict=True)]
        load = np.concatenate(loads) if loads else right[self._unknowns]
        return la.lu_solve(self._lu, load, trans=1, check_finite=False), own

    def settle(self, y: Array, own: list[Any], x: Array, felt: Array | None = None) -> None:
        """Write its share of the solution x, with what its skeleton feels of others."""
        if felt is not None:
            y = y - self._by_felt @ felt
        if not self._parts:
            x[self._unknowns] = y
            return
        inside = self._between @ y
        if felt is not None:
            inside += self._of_rows @ felt
        stops = np.cumsum([len(part.rows) for part in self._parts])[:-1]
        for part, of_part, z in zip(self._parts, own, np.split(inside, stops), strict=True):
            part.settle(of_part[0], of_part[1], x, z)


def _leaf(around: Around, panels: Panels, which: Numbers) -> _Cluster:
    """Some panels."""
    unknowns = (which[:, None] * 2 * panels.p + np.arange(2 * panels.p)).ravel()
    return _Cluster(unknowns, unknowns, around.entries(unknowns, unknowns))


def _joined(around: Around, parts: list[_Cluster]) -> _Cluster:
    """Several that are reduced as one."""
    rows, columns = (np.concatenate([getattr(c, name) for c in parts]) for name in ("rows", "columns"))
    between = np.zeros((len(rows), len(columns)))
    first, begin = 0, 0
    for part in parts:
        own, inner = slice(first, first + len(part.rows)), np.arange(begin, begin + len(part.columns))
        others = np.delete(np.arange(len(columns)), inner)
        between[own, others] = around.entries(part.rows, columns[others])
        first, begin = own.stop, begin + len(part.columns)
    matrix = _by_parts([part.answer for part in parts], between)
    matrix[np.diag_indices(len(columns))] += 1.0
    return _Cluster(rows, columns, matrix, parts, between)


def _by_parts(blocks: list[Array], right: Array) -> Array:
    """A matrix of blocks on its diagonal times another."""
    stops = np.cumsum([block.shape[1] for block in blocks])[:-1]
    return np.concatenate([block @ some for block, some in zip(blocks, np.split(right, stops), strict=True)])


def _reduce(around: Around, clusters: list[_Cluster]) -> None:
    """All to their skeletons, one after the other."""
    for cluster in clusters:
        circle = around.circle(cluster.rows, cluster.columns)
        others = [c for c in clusters if c is not cluster]
        rows, columns = (np.concatenate([getattr(c, name) for c in others]) for name in ("rows", "columns"))
        cluster.reduce(
            around.of_equations(cluster.rows, circle, columns),
            around.of_unknowns(cluster.columns, circle, rows),
        )


def _leaves(panels: Panels) -> list[Numbers]:
    """Panels of the smallest clusters, two to the power of something, of which each two neighbours are joined next."""
    edges = np.flatnonzero(np.diff(panels.contour, prepend=-1, append=-1))
    most = max(1, RUN // panels.p)
    runs = [
        run
        for curve in np.split(np.arange(len(panels.ends)), edges[1:-1])
        for run in np.array_split(curve, -(-len(curve) // most))
    ]
    middle = np.array([panels.ends[run].mean() for run in runs])
    length = np.array([len(run) for run in runs])
    groups = [np.arange(len(runs))]
    while max(length[group].sum() for group in groups) * panels.p > LEAF and min(map(len, groups)) > 1:
        groups = [half for group in groups for half in _halves(group, middle[group], length[group])]
    return [np.concatenate([runs[k] for k in group]) for group in groups]


def _halves(group: Numbers, middle: Complex, length: Numbers) -> tuple[Numbers, Numbers]:
    """Runs of panels left and right, or below and above, of which both have about the same length."""
    order = np.argsort(middle.real if np.ptp(middle.real) >= np.ptp(middle.imag) else middle.imag)
    along = np.cumsum(length[order])
    half = 1 + int(np.abs(along[:-1] - along[-1] / 2).argmin())
    return group[order[:half]], group[order[half:]]
