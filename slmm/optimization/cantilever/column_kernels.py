"""Kernels on grids of cells: what hangs together, and the elimination of nodes column by column.

A line of nodes between two columns has 2 rows + 1 nodes, its unknowns (x, y) in turn from the top. The unknowns of one
column are those of the rows + 1 nodes in the middle of its cells' horizontal edges, of the line on its right, and of
the line on its left, in this order: the middles are tied to few others and go first, and the line on the left is left
over. Unknowns without material have zero rows and are passed over.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from slmm.running.threaded import threaded

kernel = njit(cache=True, error_model="numpy")


@kernel
def held(design):
    """Which cells (rows, columns) hang together with the upper left one, edge to edge, if that is there."""
    rows, columns = design.shape
    reached = np.zeros((rows, columns), dtype=np.bool_)
    stack = np.empty((rows * columns, 2), dtype=np.int64)
    reached[0, 0], stack[0, 0], stack[0, 1] = True, 0, 0
    top = 1
    while top:
        top -= 1
        i, j = stack[top]
        for k in range(4):
            p, q = i + (k == 0) - (k == 1), j + (k == 2) - (k == 3)
            if 0 <= p < rows and 0 <= q < columns and design[p, q] and not reached[p, q]:
                reached[p, q] = True
                stack[top, 0], stack[top, 1] = p, q
                top += 1
    return reached


@kernel
def connected(design):
    """Whether the left column and the top row are there and every cell hangs on them, edge to edge."""
    rows, columns = design.shape
    for i in range(rows):
        if not design[i, 0]:
            return False
    for j in range(columns):
        if not design[0, j]:
            return False
    reached = held(design)
    for i in range(rows):
        for j in range(columns):
            if design[i, j] and not reached[i, j]:
                return False
    return True


@kernel
def column_places(rows):
    """Places (rows, 16) of each cell's unknowns among those of its column."""
    right = 2 * (rows + 1)
    left = right + 2 * (2 * rows + 1)
    result = np.empty((rows, 16), dtype=np.int64)
    for r in range(rows):
        # corners left top, right top, right bottom, left bottom; then top, right, bottom, left
        nodes = (
            left + 4 * r,
            right + 4 * r,
            right + 4 * r + 4,
            left + 4 * r + 4,
            2 * r,
            right + 4 * r + 2,
            2 * r + 2,
            left + 4 * r + 2,
        )
        for k in range(8):
            result[r, 2 * k], result[r, 2 * k + 1] = nodes[k], nodes[k] + 1
    return result


@kernel
def add_column(A, V, cells, places, K_cell, f_cell):
    """Add the stiffness and the weight of a column's cells to A (n, n) and to the first column of V (n, 2)."""
    for r in range(len(cells)):
        if cells[r]:
            for i in range(16):
                V[places[r, i], 0] += f_cell[i]
                for j in range(16):
                    A[places[r, i], places[r, j]] += K_cell[i, j]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def eliminate(A, V, count):
    """Eliminate the first unknowns of A u = V[:, 0], in place, and return V[:, 1] . u of these with the others zero.

    Of A (n, n) only the upper triangle is used; V (n, 2). Four pivots go together, which saves memory traffic.
    """
    n = len(A)
    value = 0.0
    pivots = np.empty(4, dtype=np.int64)
    k = 0
    while k < count:
        m = 0
        while k < count and m < 4:
            for q in range(m):
                _subtract_row(A, V, pivots[q], k)
            if A[k, k] != 0.0:
                value += V[k, 0] * V[k, 1] / A[k, k]
                pivots[m] = k
                m += 1
            k += 1
        if m < 4:
            for q in range(m):
                for i in range(k, n):
                    _subtract_row(A, V, pivots[q], i)
            continue
        a, b, c, d = pivots
        pa, pb, pc, pd = 1 / A[a, a], 1 / A[b, b], 1 / A[c, c], 1 / A[d, d]
        for i in range(k, n):
            fa, fb, fc, fd = A[a, i] * pa, A[b, i] * pb, A[c, i] * pc, A[d, i] * pd
            if fa != 0.0 or fb != 0.0 or fc != 0.0 or fd != 0.0:
                for j in range(i, n):
                    A[i, j] -= fa * A[a, j] + fb * A[b, j] + fc * A[c, j] + fd * A[d, j]
                for j in range(2):
                    V[i, j] -= fa * V[a, j] + fb * V[b, j] + fc * V[c, j] + fd * V[d, j]
    return value


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _subtract_row(A, V, pivot, i):
    """Take a row's multiple from another one so that its entry below the pivot vanishes."""
    factor = A[pivot, i] / A[pivot, pivot]
    if factor != 0.0:
        for j in range(i, len(A)):
            A[i, j] -= factor * A[pivot, j]
        V[i, 0] -= factor * V[pivot, 0]
        V[i, 1] -= factor * V[pivot, 1]


@kernel
def endpoint_displacement(design, K_cell, f_cell):
    """Sag of the upper right corner, by eliminating column after column from the free end."""
    rows, columns = design.shape
    places = column_places(rows)
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    left = middles + line
    n = left + line
    A, V = np.zeros((n, n)), np.zeros((n, 2))
    V[middles + 1, 1] = 1.0  # the corner's vertical displacement
    value = 0.0
    for column in range(columns - 1, -1, -1):
        add_column(A, V, design[:, column], places, K_cell, f_cell)
        if column == 0:
            # the left edge is held: its unknowns are not there
            value += eliminate(A[:left, :left], V[:left], left)
            break
        value += eliminate(A, V, left)
        # what is left over stands on the right of the next column
        for i in range(line):
            V[middles + i] = V[left + i]
            for j in range(i, line):
                A[middles + i, middles + j] = A[left + i, left + j]
        A[:middles] = 0.0
        V[:middles] = 0.0
        for i in range(line):
            A[middles + i, : middles + i] = 0.0
            A[middles + i, left:] = 0.0
        A[left:] = 0.0
        V[left:] = 0.0
    return value


@threaded(cache=True, error_model="numpy")
def endpoint_displacements(designs, K_cell, f_cell):
    """Sag of each design; NaN for those that are not valid."""
    result = np.empty(len(designs))
    for k in prange(len(designs)):
        if connected(designs[k]):
            result[k] = endpoint_displacement(designs[k], K_cell, f_cell)
        else:
            result[k] = np.nan
    return result


@threaded(cache=True, error_model="numpy")
def all_connected(designs):
    """See `connected`, of each design (n, rows, columns)."""
    result = np.empty(len(designs), dtype=np.bool_)
    for k in prange(len(designs)):
        result[k] = connected(designs[k])
    return result
