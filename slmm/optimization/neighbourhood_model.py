"""All neighbours of a design on a fine grid, each by a few unknowns.

From the left and from the right the cantilever is condensed to every line of nodes between columns, once for a design.
Between two lines lies a strip of columns; with what is condensed on both sides its stiffness can be inverted, and the
inverse H is that of the whole beam, restricted to the strip. A neighbour differs in a few cells, whose unknowns are W:

    (1 + H_WW dK) u' = u_W + H_WW df,    sag' = sag + t_W (df - dK u'),

with the change of stiffness dK and of weight df, and the displacements u that a unit force at the corner makes, t
(Woodbury). Unknowns without material have a unit stiffness of their own, so a cell that appears or vanishes changes
no structure.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit, prange

from slmm.optimization.cantilever import MATERIAL, Cantilever
from slmm.optimization.column_kernels import add_column, column_places, eliminate

#: neighbours whose cells lie farther apart than so many columns are solved directly
WIDEST = 8


class Strip(NamedTuple):
    """Some columns of the beam, their unknowns those of the lines and, between them, of the middles of the columns.

    Parameters
    ----------
    H : ndarray (n, n)
        Inverse of the beam's stiffness, restricted to the strip, mm/N.
    u, t : ndarray (n,)
        Displacements under the weight, mm, and under a unit force at the corner, mm/N.
    """

    H: np.ndarray
    u: np.ndarray
    t: np.ndarray


class NeighbourhoodModel:
    """Approximate values of the designs around one.

    Parameters
    ----------
    beam : Cantilever
    centre : ndarray of bool (rows, columns)
        A valid design.

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
        """Condense the centre to every line."""
        self.beam, self.centre = beam, np.ascontiguousarray(centre, dtype=bool)
        self.line, self.middles = 2 * (2 * beam.rows + 1), 2 * (beam.rows + 1)
        self._left, self._right, self.sag = _condensed(self.centre, *beam.cell)
        self._strips: dict[tuple[int, int], Strip] = {}

    def evaluate(self, flips: np.ndarray) -> np.ndarray:
        """Sag (n,) of the valid designs in which these cells (n, k) of the centre are flipped, mm.

        Cells are counted row after row, ``row * columns + column``; -1 is none.
        """
        flips = np.atleast_2d(np.asarray(flips, dtype=np.int64))
        result = np.empty(len(flips))
        column = np.where(flips < 0, -1, flips % self.beam.columns)
        last = column.max(axis=1)
        first = np.where(flips < 0, self.beam.columns, column).min(axis=1)
        # no flip at all is the centre
        first, last = np.minimum(first, self.beam.columns - 1), np.maximum(last, 0)
        width = np.maximum(last - first + 1, 1)
        wide = width > WIDEST
        if wide.any():
            result[wide] = self.beam.endpoint_displacement(self._designs(flips[wide]))
        group = first * (WIDEST + 1) + width
        for key in np.unique(group[~wide]):
            here = np.flatnonzero((group == key) & ~wide)
            start, columns = divmod(int(key), WIDEST + 1)
            strip = self._strip(start, columns)
            result[here] = _changed(
                flips[here],
                self.centre,
                start,
                *strip,
                *self.beam.cell,
                _places(self.beam.rows),
                self.sag,
                MATERIAL.E,
            )
        return result

    def _designs(self, flips: np.ndarray) -> np.ndarray:
        designs = np.repeat(self.centre.reshape(1, -1), len(flips), axis=0)
        row, k = np.nonzero(flips >= 0)
        designs[row, flips[row, k]] ^= True
        return designs.reshape(-1, *self.centre.shape)

    def _strip(self, start: int, columns: int) -> Strip:
        """Made once; the same whatever else was asked for."""
        if (start, columns) not in self._strips:
            step = self.line + self.middles
            n = columns * step + self.line
            A, V = np.zeros((n, n)), np.zeros((n, 2))
            places = _places(self.beam.rows)
            for k in range(columns):
                here = slice(k * step, k * step + step + self.line)
                add_column(A[here, here], V[here], self.centre[:, start + k], places, *self.beam.cell)
            A[: self.line, : self.line] += self._left[0][start]
            V[: self.line] += self._left[1][start]
            A[-self.line :, -self.line :] += self._right[0][start + columns]
            V[-self.line :] += self._right[1][start + columns]
            active = np.flatnonzero(A.diagonal() > 0)
            if start == 0:
                active = active[active >= self.line]  # the held edge
            H = np.zeros((n, n))
            np.fill_diagonal(H, 1 / MATERIAL.E)
            H[np.ix_(active, active)] = np.linalg.inv(A[np.ix_(active, active)])
            u = H @ V
            self._strips[start, columns] = Strip(H, u[:, 0].copy(), u[:, 1].copy())
        return self._strips[start, columns]


@lru_cache(maxsize=1)
def model_around(beam: Cantilever, design: bytes) -> NeighbourhoodModel:
    """The model around a design (its cells as bytes), kept while the same one is asked for."""
    return NeighbourhoodModel(beam, np.frombuffer(design, dtype=bool).reshape(beam.shape))


def _places(rows: int) -> np.ndarray:
    """Places (rows, 16) of cells' unknowns in a column whose lines stand left and right of the middles."""
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    right, between, left = np.split(np.arange(2 * line + middles), [line, line + middles])
    place = np.empty(2 * line + middles, dtype=np.int64)
    place[np.concatenate([left, between, right])] = np.arange(len(place))
    return place[column_places(rows)]


def _condensed(centre, K_cell, f_cell):
    """Stiffness and loads of what is left and right of each line, and the sag of the centre."""
    rows, columns = centre.shape
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    left = np.zeros((columns + 1, line, line)), np.zeros((columns + 1, line, 2))
    right = np.zeros((columns + 1, line, line)), np.zeros((columns + 1, line, 2))
    right[1][columns, 1, 1] = 1.0  # the corner's vertical displacement
    sag = _swept(centre, K_cell, f_cell, _places(rows), column_places(rows), line, middles, *left, *right)
    return left, right, sag


@njit(cache=True, error_model="numpy")
def _swept(centre, K_cell, f_cell, to_right, to_left, line, middles, K_left, V_left, K_right, V_right):
    """Fill what is left and right of each line, column by column; returns the sag."""
    columns = centre.shape[1]
    gone = line + middles
    for column in range(columns):
        A, V = np.zeros((gone + line, gone + line)), np.zeros((gone + line, 2))
        add_column(A, V, centre[:, column], to_right, K_cell, f_cell)
        if column == 0:  # the left edge is held
            A[:line] = 0.0
            A[:, :line] = 0.0
            V[:line] = 0.0
        else:
            A[:line, :line] += K_left[column]
            V[:line] += V_left[column]
        eliminate(A, V, gone)
        for i in range(line):
            V_left[column + 1, i] = V[gone + i]
            for j in range(i, line):
                K_left[column + 1, i, j] = K_left[column + 1, j, i] = A[gone + i, gone + j]
    sag = 0.0
    for column in range(columns - 1, -1, -1):
        A, V = np.zeros((gone + line, gone + line)), np.zeros((gone + line, 2))
        add_column(A, V, centre[:, column], to_left, K_cell, f_cell)
        A[:line, :line] += K_right[column + 1]
        V[:line] += V_right[column + 1]
        if column == 0:
            return sag + eliminate(A[:gone, :gone], V[:gone], gone)
        sag += eliminate(A, V, gone)
        for i in range(line):
            V_right[column, i] = V[gone + i]
            for j in range(i, line):
                K_right[column, i, j] = K_right[column, j, i] = A[gone + i, gone + j]
    return sag


@njit(parallel=True, cache=True, error_model="numpy", fastmath={"contract"})
def _changed(flips, centre, start, H, u, t, K_cell, f_cell, places, sag, unit):
    """Sag of neighbours whose flipped cells all lie in one strip."""
    rows, columns = centre.shape
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    step = line + middles
    result = np.empty(len(flips))
    for q in prange(len(flips)):
        count = 0
        for k in range(flips.shape[1]):
            count += flips[q, k] >= 0
        # the unknowns of the flipped cells, once each, and how many cells there are around them, before and after
        W, own = np.empty(16 * count, dtype=np.int64), np.empty((count, 16), dtype=np.int64)
        n, c = 0, 0
        for k in range(flips.shape[1]):
            if flips[q, k] < 0:
                continue
            row, column = flips[q, k] // columns, flips[q, k] % columns
            for i in range(16):
                at = (column - start) * step + places[row, i]
                found = -1
                for w in range(n):
                    if W[w] == at:
                        found = w
                        break
                if found < 0:
                    W[n], found, n = at, n, n + 1
                own[c, i] = found
            c += 1
        dK, df = np.zeros((n, n)), np.zeros(n)
        c = 0
        for k in range(flips.shape[1]):
            if flips[q, k] < 0:
                continue
            row, column = flips[q, k] // columns, flips[q, k] % columns
            sign = -1.0 if centre[row, column] else 1.0
            for i in range(16):
                df[own[c, i]] += sign * f_cell[i]
                for j in range(16):
                    dK[own[c, i], own[c, j]] += sign * K_cell[i, j]
            c += 1
        _switch(dK, W, n, flips[q], centre, start, step, line, unit)
        M, b = np.zeros((n, n)), np.empty(n)
        for i in range(n):
            b[i] = u[W[i]]
            for k in range(n):
                h = H[W[i], W[k]]
                b[i] += h * df[k]
                for j in range(n):
                    M[i, j] += h * dK[k, j]
            M[i, i] += 1.0
        _solve(M, b)
        change = 0.0
        for i in range(n):
            force = df[i]
            for j in range(n):
                force -= dK[i, j] * b[j]
            change += t[W[i]] * force
        result[q] = sag + change
    return result


@njit(cache=True, error_model="numpy")
def _switch(dK, W, n, flips, centre, start, step, line, unit):
    """Unit stiffness goes where the first material comes, and comes where the last goes."""
    rows, columns = centre.shape
    for w in range(0, n, 2):
        column, place = start + W[w] // step, W[w] % step
        if place < line:  # a node of a line: cells left and right of it
            node = place // 2
            low, high = column - 1, column
        else:  # the middle of a horizontal edge
            node = (place - line) // 2 * 2
            low = high = column
        before = after = False
        for r in range((node - 1) // 2, node // 2 + 1):
            for c in range(low, high + 1):
                if 0 <= r < rows and 0 <= c < columns:
                    flipped = False
                    for cell in flips:
                        flipped |= cell == r * columns + c
                    before |= centre[r, c]
                    after |= centre[r, c] != flipped
        if before != after:
            for i in range(w, w + 2):
                dK[i, i] += unit if before else -unit


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def _solve(M, b):
    """Gauss with partial pivoting, in place: the solution stands in b."""
    n = len(b)
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(M[i, k]) > abs(M[best, k]):
                best = i
        if best != k:
            for j in range(k, n):
                M[k, j], M[best, j] = M[best, j], M[k, j]
            b[k], b[best] = b[best], b[k]
        for i in range(k + 1, n):
            factor = M[i, k] / M[k, k]
            if factor != 0.0:
                for j in range(k + 1, n):
                    M[i, j] -= factor * M[k, j]
                b[i] -= factor * b[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            b[k] -= M[k, j] * b[j]
        b[k] /= M[k, k]
