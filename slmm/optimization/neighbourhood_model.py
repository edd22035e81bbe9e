"""All neighbours of a design on a fine grid, each by a few unknowns.

A neighbour differs from the centre in a few cells. The stiffness of a cell is L' L with twelve strains L of its 16
unknowns, so that the change is known from the stresses of these cells alone (Woodbury). With the inverse H of the
centre's stiffness, its displacements u under the weight and t under a unit force at the corner, and df the weight that
is added less that which is removed,

    (1 + L_a H L_a') s_a - P v - L_a H L_r' s_r = L_a (u + H df)      cells that are added,
                      P' s_a                    = f_p                 nodes that come with them,
    L_r H L_a' s_a + (1 - L_r H L_r') s_r       = L_r (u + H df)      cells that are removed,

    sag' = sag + t df - L_a t s_a + L_r t s_r,

where P are the strains of added cells by nodes that have had no material, and v the displacements of these. Nodes that
lose all their material leave stresses of removed cells open which do not matter, and are set to zero.

Strains, not displacements, because most of a displacement is that of everything to its left, which strains nothing.
H is made once for a design, near its diagonal: columns are eliminated from the free end, and followed back.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy.linalg.lapack as lapack
import threadpoolctl
from numba import njit, prange

from slmm.optimization.cantilever import Cantilever
from slmm.optimization.column_kernels import add_column, column_places, eliminate

#: neighbours whose cells span more columns and rows than this, added up and less two, are solved directly
WIDEST = 8
#: share of the stiffness against a strain of a removed cell that must be left without it, over the largest flexibility
#: in those of a cell: with less, digits are lost
LEAST = 3e-8
#: error of displacements over the largest one, in units of round-off times the largest flexibility in those of a cell;
#: three times the largest that was seen (validation/neighbourhood.py)
ROUND_OFF = 2000.0


class NeighbourhoodModel:
    """Approximate values of the designs around one.

    Parameters
    ----------
    beam : Cantilever
    centre : ndarray of bool (rows, columns)
        A valid design.

    Attributes
    ----------
    sag : float
        Of the centre, mm.
    error : float
        An estimate of round-off in the sag of neighbours that are no more flexible than the centre, mm.

    Examples
    --------
    >>> beam = Cantilever(8, 5)
    >>> model = NeighbourhoodModel(beam, np.ones((5, 8), dtype=bool))
    >>> flipped = np.ones((5, 8), dtype=bool)
    >>> flipped[2, 3] = flipped[2, 4] = False
    >>> float(abs(model.evaluate(np.array([[19, 20]]))[0] - beam.endpoint_displacement([flipped])[0])) < 1e-12
    True
    """

    def __init__(self, beam: Cantilever, centre: np.ndarray) -> None:
        """Eliminate the centre's columns."""
        self.beam, self.centre = beam, np.ascontiguousarray(centre, dtype=bool)
        self._strains = np.vstack([strains(beam.cell[0]), beam.cell[1]])
        with _blas().limit(limits=1):
            self._inverse = Inverse(beam, self.centre)
        self.sag = float(self._inverse.displacements[-1, self._inverse.corner, 0])
        #: the largest one in those of a cell
        self._flexibility = self._inverse.near[0].diagonal(axis1=1, axis2=2).max() * beam.cell[0].max()
        largest = np.abs(self._inverse.displacements[:, :, 0]).max()
        self.error = float(ROUND_OFF * np.finfo(float).eps * self._flexibility * largest)
        self._own = _of_cells(self._strains, self._inverse.displacements, *_places(beam.rows))
        self._touching = _touching(self.centre)
        #: products of strains of pairs of cells that are not farther apart than the reach
        self._reach, self._pairs = -1, np.empty(0)

    def evaluate(self, flips: np.ndarray) -> np.ndarray:
        """Sag (n,) of the valid designs in which these cells (n, k) of the centre are flipped, mm.

        Cells are counted row after row, ``row * columns + column``; -1 is none. Cells far apart are solved directly,
        and those which have held some of the rest nearly alone.
        """
        flips = np.atleast_2d(np.asarray(flips, dtype=np.int64))
        reach = _reach(flips, self.beam.columns)
        near = reach <= WIDEST
        result = np.full(len(flips), np.nan)
        if near.any():
            self._extend(int(reach[near].max()))
            result[near] = self.sag + _changes(
                flips[near],
                self.centre,
                self._touching,
                self._pairs,
                self._own,
                self._strains,
                LEAST * self._flexibility,
            )
        if (left := np.isnan(result)).any():
            result[left] = self.beam.endpoint_displacement(self._designs(flips[left]))
        return result

    def _designs(self, flips: np.ndarray) -> np.ndarray:
        designs = np.repeat(self.centre.reshape(1, -1), len(flips), axis=0)
        row, k = np.nonzero(flips >= 0)
        designs[row, flips[row, k]] ^= True
        return designs.reshape(-1, *self.centre.shape)

    def _extend(self, reach: int) -> None:
        """Know all pairs of cells in this reach."""
        if reach > self._reach:
            with _blas().limit(limits=1):
                self._inverse.extend(reach + 1)
            self._reach, self._pairs = (
                reach,
                _of_pairs(self._strains, self._inverse.near, reach, *_places(self.beam.rows)),
            )


class Inverse:
    """Inverse of a design's stiffness near its diagonal.

    The unknowns of a column are those of the middles of its horizontal edges and of the line of nodes on its right;
    without material they have no stiffness, and zeros in the inverse.

    Parameters
    ----------
    beam : Cantilever
    centre : ndarray of bool (rows, columns)
    """

    #: `displacements` (columns, m, 2) under the weight and under a unit force at the corner
    displacements: np.ndarray
    #: `near` (k, columns, m, m): of unknowns of a column, and of the one that stands 0, 1, ... columns to the left
    near: np.ndarray

    def __init__(self, beam: Cantilever, centre: np.ndarray) -> None:
        """Eliminate the columns from the free end, and go back."""
        columns = beam.columns
        line, middles = 2 * (2 * beam.rows + 1), 2 * (beam.rows + 1)
        m = middles + line
        self.corner = middles + 1
        self._line = slice(middles, m)
        self._back = np.empty((columns, m, line))
        self.displacements = np.empty((columns, m, 2))
        self.near = np.empty((1, columns, m, m))
        places = _in_order(beam.rows)
        K, V = np.empty((line + m, line + m)), np.empty((line + m, 2))
        rest, load_rest = np.zeros((line, line)), np.zeros((line, 2))
        load_rest[1, 1] = 1.0  # the corner's vertical displacement
        for c in reversed(range(columns)):
            K[:], V[:] = 0.0, 0.0
            add_column(K, V, centre[:, c], places, *beam.cell)
            K[-line:, -line:] += rest
            V[-line:] += load_rest
            missing = np.flatnonzero(K.diagonal()[line:] == 0)
            K[line + missing, line + missing] = 1.0
            lower, info = lapack.dpotrf(K[line:, line:].T, lower=True, clean=True)
            if info:
                raise ValueError("centre: must be a valid design")
            half, _ = lapack.dtrtrs(lower, np.column_stack([K[line:, :line], V[line:]]), lower=True)
            rest = K[:line, :line] - half[:, :line].T @ half[:, :line]
            load_rest = V[:line] - half[:, :line].T @ half[:, line:]
            back, _ = lapack.dtrtrs(lower, half, lower=True, trans=1)
            self._back[c], self.displacements[c] = back[:, :line], back[:, line:]
            inverse, _ = lapack.dpotri(lower, lower=True)
            # the other triangle is zero
            self.near[0, c] = inverse + inverse.T
            self.near[0, c].flat[:: m + 1] = inverse.diagonal()
            self.near[0, c, missing, missing] = 0.0
        for c in range(1, columns):
            before = self.near[0, c - 1, self._line, self._line]
            self.near[0, c] += self._back[c] @ before @ self._back[c].T
            self.displacements[c] -= self._back[c] @ self.displacements[c - 1, self._line]

    def extend(self, k: int) -> None:
        """Know it for columns up to so many apart."""
        known = len(self.near)
        if k < known:
            return
        near = np.zeros((k + 1, *self.near.shape[1:]))
        near[:known] = self.near
        for d in range(known, k + 1):
            for c in range(d, near.shape[1]):
                np.matmul(self._back[c], near[d - 1, c - 1, self._line], out=near[d, c])
                np.negative(near[d, c], out=near[d, c])
        self.near = near


@lru_cache(maxsize=1)
def model_around(beam: Cantilever, design: bytes) -> NeighbourhoodModel:
    """The model around a design (its cells as bytes), kept while the same one is asked for."""
    return NeighbourhoodModel(beam, np.frombuffer(design, dtype=bool).reshape(beam.shape))


@lru_cache(maxsize=1)
def _blas() -> threadpoolctl.ThreadpoolController:
    """Threads cost more than they gain on small matrices."""
    return threadpoolctl.ThreadpoolController().select(user_api="blas")


def strains(K: np.ndarray) -> np.ndarray:
    """L (m, n) with L' L = K (n, n) and no more rows than its rank.

    Examples
    --------
    >>> strains(np.array([[2.0, -2.0], [-2.0, 2.0]])).round(3)
    array([[-1.414,  1.414]])
    """
    values, vectors = np.linalg.eigh(K)
    stiff = values > 1e-9 * values[-1]
    return np.sqrt(values[stiff])[:, None] * vectors[:, stiff].T


def _reach(flips: np.ndarray, columns: int) -> np.ndarray:
    """How many columns and rows the cells (n, k) are apart, added up (n,)."""
    there = flips >= 0
    row, column = np.divmod(flips, columns)
    total = np.zeros(len(flips), dtype=np.int64)
    for place in (row, column):
        high = np.where(there, place, -1).max(axis=1)
        low = np.where(there, place, np.iinfo(np.int64).max).min(axis=1)
        total += np.where(high < 0, 0, high - low)
    return total


def _touching(centre: np.ndarray) -> np.ndarray:
    """How many cells there are around each node (2 rows + 1, 2 columns + 1)."""
    result = np.zeros([2 * n + 1 for n in centre.shape], dtype=np.int64)
    for i in range(3):
        for j in range(3):
            if (i, j) != (1, 1):
                result[i : i + 2 * centre.shape[0] - 1 : 2, j : j + 2 * centre.shape[1] - 1 : 2] += centre
    return result


def _in_order(rows: int) -> np.ndarray:
    """Places (rows, 16) of cells' unknowns among the line on the left, the middles, and the line on the right."""
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    between, right, left = np.split(np.arange(2 * line + middles), [middles, middles + line])
    place = np.empty(2 * line + middles, dtype=np.int64)
    place[np.concatenate([left, between, right])] = np.arange(len(place))
    return place[column_places(rows)]


def _places(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (rows, 16) of cells' unknowns among those of a column, and whether it is the one on the left (16,)."""
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    place = _in_order(rows)
    left = place < line
    return np.where(left, place + middles, place - line), left[0]


@njit(cache=True, error_model="numpy")
def _of_cells(strains, displacements, places, on_left):
    """Strains, and work of the weight, of every cell by both displacements (rows, columns, 13, 2)."""
    columns, rows = len(displacements), len(places)
    result = np.zeros((rows, columns, len(strains), 2))
    for row in range(rows):
        for column in range(columns):
            for a in range(16):
                c = column - on_left[a]
                if c >= 0:
                    for s in range(len(strains)):
                        for k in range(2):
                            result[row, column, s, k] += strains[s, a] * displacements[c, places[row, a], k]
    return result


@njit(parallel=True, cache=True, error_model="numpy", fastmath={"contract"})
def _of_pairs(strains, near, reach, places, on_left):
    """Strains, and work of the weight, of every cell by unit stresses, and by the weight, of those left of it.

    (reach + 1, 2 reach + 1, rows, columns, 13, 13): of the cell at (row, column) by that at (row - j, column - i) where
    i and j + reach are the first places.
    """
    columns, rows = near.shape[1], len(places)
    n = len(strains)
    result = np.empty((reach + 1, 2 * reach + 1, rows, columns, n, n))
    transposed = np.ascontiguousarray(strains.T)
    for column in prange(columns):
        H, half = np.zeros((16, 16)), np.empty((n, 16))
        for i in range(min(reach, column) + 1):
            for row in range(rows):
                for j in range(-(reach - i) if i > 0 else 0, reach - i + 1):
                    other = row - j
                    if other < 0 or other >= rows:
                        continue
                    for a in range(16):
                        c = column - on_left[a]
                        for b in range(16):
                            d = column - i - on_left[b]
                            # the edge at the left is held
                            if c < 0 or d < 0:
                                H[a, b] = 0.0
                            elif c >= d:
                                H[a, b] = near[c - d, c, places[row, a], places[other, b]]
                            else:
                                H[a, b] = near[d - c, d, places[other, b], places[row, a]]
                    found = result[i, j + reach, row, column]
                    for s in range(n):
                        half[s] = 0.0
                        for a in range(16):
                            for b in range(16):
                                half[s, b] += strains[s, a] * H[a, b]
                        found[s] = 0.0
                        for b in range(16):
                            for k in range(n):
                                found[s, k] += half[s, b] * transposed[b, k]
    return result


@njit(parallel=True, cache=True, error_model="numpy")
def _changes(flips, centre, touching, pairs, own, strains, least):
    """What neighbours sag more than the centre (n,)."""
    result = np.empty(len(flips))
    for q in prange(len(flips)):
        result[q] = _change(flips[q], centre, touching, pairs, own, strains, least)
    return result


@njit(cache=True, error_model="numpy")
def _change(flips, centre, touching, pairs, own, strains, least):
    """What one neighbour sags more than the centre."""
    columns = centre.shape[1]
    reach, n = len(pairs) - 1, len(strains) - 1
    # added cells first, then removed ones
    cells, count, added = np.empty((len(flips), 2), dtype=np.int64), 0, 0
    for there in (False, True):
        for cell in flips:
            if cell >= 0 and centre[cell // columns, cell % columns] == there:
                cells[count, 0], cells[count, 1] = cell // columns, cell % columns
                count += 1
        if not there:
            added = count
    new, first_new = _new_nodes(cells[:added], touching), n * added
    first_removed = first_new + 2 * len(new)
    size = first_removed + n * (count - added)
    A, b = np.zeros((size, size)), np.zeros((size, 2))
    change = 0.0
    for i in range(count):
        sign = 1.0 if i < added else -1.0
        at = n * i if i < added else first_removed + n * (i - added)
        strain = own[cells[i, 0], cells[i, 1]]
        change += sign * strain[n, 1]
        for s in range(n):
            b[at + s, 0], b[at + s, 1] = sign * strain[s, 0], sign * strain[s, 1]
            A[at + s, at + s] = sign
        for j in range(count):
            weight = 1.0 if j < added else -1.0
            to = n * j if j < added else first_removed + n * (j - added)
            down, right = cells[i, 0] - cells[j, 0], cells[i, 1] - cells[j, 1]
            if right > 0 or (right == 0 and down >= 0):
                pair = pairs[right, down + reach, cells[i, 0], cells[i, 1]]
                for s in range(n):
                    b[at + s, 0] += sign * weight * pair[s, n]
                if j >= i:
                    for s in range(n):
                        for k in range(n):
                            A[at + s, to + k] += sign * weight * pair[s, k]
            else:
                pair = pairs[-right, reach - down, cells[j, 0], cells[j, 1]]
                for s in range(n):
                    b[at + s, 0] += sign * weight * pair[n, s]
                if j >= i:
                    for s in range(n):
                        for k in range(n):
                            A[at + s, to + k] += sign * weight * pair[k, s]
    for i in range(added):
        _add_new_nodes(A, b, n * i, cells[i], new, first_new, strains)
    _leave_open(A, first_removed, cells[:count], added, touching, strains)
    change -= eliminate(A, b, size)
    for s in range(first_removed, size):
        if abs(A[s, s]) < least:
            return np.nan
    return change


#: where the nodes of a cell stand in the grid of nodes, from its upper left one
_NODES = np.array([(0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0)])


@njit(cache=True, error_model="numpy")
def _new_nodes(added, touching):
    """The nodes of added cells that have had no material (n, 2)."""
    nodes, n = np.empty((8 * len(added), 2), dtype=np.int64), 0
    for cell in range(len(added)):
        for k in range(8):
            row, column = 2 * added[cell, 0] + _NODES[k, 0], 2 * added[cell, 1] + _NODES[k, 1]
            if touching[row, column] == 0 and _found(nodes[:n], row, column) < 0:
                nodes[n, 0], nodes[n, 1] = row, column
                n += 1
    return nodes[:n]


@njit(cache=True, error_model="numpy")
def _found(nodes, row, column):
    """Which of the nodes this is; -1 for none."""
    for i in range(len(nodes)):
        if nodes[i, 0] == row and nodes[i, 1] == column:
            return i
    return -1


@njit(cache=True, error_model="numpy")
def _add_new_nodes(A, b, at, cell, new, first_new, strains):
    """Strains and weight of an added cell at its new nodes."""
    n = len(strains) - 1
    for k in range(8):
        i = _found(new, 2 * cell[0] + _NODES[k, 0], 2 * cell[1] + _NODES[k, 1])
        if i >= 0:
            for xy in range(2):
                for s in range(n):
                    A[at + s, first_new + 2 * i + xy] -= strains[s, 2 * k + xy]
                b[first_new + 2 * i + xy, 0] -= strains[n, 2 * k + xy]


@njit(cache=True, error_model="numpy")
def _leave_open(A, first, cells, added, touching, strains):
    """Set the stresses to zero that removed cells have at nodes which lose all their material."""
    n, removed = len(strains) - 1, cells[added:]
    open_stress = np.empty(n * len(removed))
    for i in range(len(removed)):
        for k in range(8):
            row, column = 2 * removed[i, 0] + _NODES[k, 0], 2 * removed[i, 1] + _NODES[k, 1]
            left, known = touching[row, column], False
            for c in range(len(cells)):
                inside = 0 <= row - 2 * cells[c, 0] <= 2 and 0 <= column - 2 * cells[c, 1] <= 2
                left += (1 if c < added else -1) * inside
                known |= inside and added <= c < added + i
            if left > 0 or known:
                continue
            for xy in range(2):
                open_stress[:] = 0.0
                for c in range(i, len(removed)):
                    for m in range(8):
                        if (
                            2 * removed[c, 0] + _NODES[m, 0] == row
                            and 2 * removed[c, 1] + _NODES[m, 1] == column
                        ):
                            for s in range(n):
                                open_stress[n * c + s] = strains[s, 2 * m + xy]
                for s in range(n * i, len(open_stress)):
                    if open_stress[s] != 0.0:
                        for m in range(s, len(open_stress)):
                            A[first + s, first + m] -= open_stress[s] * open_stress[m]
