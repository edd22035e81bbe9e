"""What a beam sags more when a few cells are added or removed: kernels of `neighbourhood_model`, whose formulas hold.

Strains of a cell are those of `strains`; the last row beneath them is its weight, which works on its displacements.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from slmm.optimization.cantilever.column_kernels import eliminate
from slmm.running.threaded import threaded

#: where the nodes of a cell stand in the grid of nodes, from its upper left one
_NODES = np.array([(0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0)])


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


def touching(centre: np.ndarray) -> np.ndarray:
    """How many cells there are around each node (2 rows + 1, 2 columns + 1)."""
    result = np.zeros([2 * n + 1 for n in centre.shape], dtype=np.int64)
    for i in range(3):
        for j in range(3):
            if (i, j) != (1, 1):
                result[i : i + 2 * centre.shape[0] - 1 : 2, j : j + 2 * centre.shape[1] - 1 : 2] += centre
    return result


@njit(cache=True, error_model="numpy")
def strains_of_cells(strains, displacements, places, on_left):
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


@threaded(cache=True, error_model="numpy", fastmath={"contract"})
def strains_of_pairs(strains, near, reach, places, on_left):
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


@threaded(cache=True, error_model="numpy")
def sag_changes(flips, centre, touching, pairs, own, strains, least):
    """What neighbours sag more than the centre (n,), and what round-off in the pairs is multiplied by (n,).

    Where less than the least is left of a flexibility of removed cells, digits are lost: NaN.
    """
    change, gain = np.empty(len(flips)), np.empty(len(flips))
    for q in prange(len(flips)):
        change[q], gain[q] = _change(flips[q], centre, touching, pairs, own, strains, least)
    return change, gain


@njit(cache=True, error_model="numpy")
def _change(flips, centre, touching, pairs, own, strains, least):
    """What one neighbour sags more than the centre, and the product of the two stresses there."""
    columns = centre.shape[1]
    reach, n = len(pairs) - 1, len(strains) - 1
    # added cells first, then removed ones
    cells, count, added = np.empty((len(flips), 2), dtype=np.int64), 0, 0
    for there in (False, True):
        for cell in flips:
            if centre[cell // columns, cell % columns] == there:
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
        if A[s, s] > -least:
            return np.nan, np.nan
    _substitute_back(A, b)
    b[first_new:first_removed] = 0.0
    return change, np.sqrt((b[:, 0] ** 2).sum() * (b[:, 1] ** 2).sum())


@njit(cache=True, error_model="numpy")
def _substitute_back(A, V):
    """What V (n, 2) solves for, in place, after the elimination of all unknowns; zero for those without material."""
    for i in range(len(A) - 1, -1, -1):
        for k in range(2):
            if A[i, i] != 0.0:
                for j in range(i + 1, len(A)):
                    V[i, k] -= A[i, j] * V[j, k]
                V[i, k] /= A[i, i]
            else:
                V[i, k] = 0.0


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
