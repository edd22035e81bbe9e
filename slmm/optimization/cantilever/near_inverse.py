"""The inverse of a design's stiffness near its diagonal, column by column.

Columns are eliminated from the free end, and followed back. What stands within a column of the inverse, and between
columns that are near one another, is all that neighbours of the design need (neighbourhood_model).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg.lapack as lapack

from slmm.optimization.cantilever.column_kernels import add_column, column_places
from slmm.running.blas import one_blas_thread

if TYPE_CHECKING:
    from slmm.optimization.cantilever.beam import Cantilever


class NearInverse:
    """Inverse of a design's stiffness near its diagonal.

    The unknowns of a column are those of the middles of its horizontal edges and of the line of nodes on its right;
    without material they have no stiffness, and zeros in the inverse.

    Parameters
    ----------
    beam : Cantilever
    centre : ndarray of bool (rows, columns)
        A valid design.

    Attributes
    ----------
    displacements : ndarray (columns, m, 2)
        Under the weight, mm, and under a unit force at the corner, mm/N.
    near : ndarray (k, columns, m, m)
        The inverse for unknowns of a column and those of the one that stands 0, 1, ... columns to its left, mm/N.
    corner : int
        The unknown of the last column that is the corner's vertical displacement.

    Raises
    ------
    ValueError
        When the design is not valid.

    Examples
    --------
    >>> from slmm.optimization.cantilever.beam import Cantilever
    >>> beam, full = Cantilever(4, 3), np.ones((3, 4), dtype=bool)
    >>> inverse = NearInverse(beam, full)
    >>> inverse.displacements[-1, inverse.corner, :1].round(5), beam.endpoint_displacement([full]).round(5)
    (array([0.01046]), array([0.01046]))
    """

    def __init__(self, beam: Cantilever, centre: np.ndarray) -> None:
        """Find the inverse within each column, and the displacements."""
        with one_blas_thread():
            self._eliminate(beam, centre)

    def _eliminate(self, beam: Cantilever, centre: np.ndarray) -> None:
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
        with one_blas_thread():
            for d in range(known, k + 1):
                for c in range(d, near.shape[1]):
                    np.matmul(self._back[c], near[d - 1, c - 1, self._line], out=near[d, c])
                    np.negative(near[d, c], out=near[d, c])
        self.near = near


def _in_order(rows: int) -> np.ndarray:
    """Places (rows, 16) of cells' unknowns among the line on the left, the middles, and the line on the right."""
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    between, right, left = np.split(np.arange(2 * line + middles), [middles, middles + line])
    place = np.empty(2 * line + middles, dtype=np.int64)
    place[np.concatenate([left, between, right])] = np.arange(len(place))
    return place[column_places(rows)]


def places(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (rows, 16) of cells' unknowns among those of a column, and whether it is the one on the left (16,)."""
    line, middles = 2 * (2 * rows + 1), 2 * (rows + 1)
    place = _in_order(rows)
    left = place < line
    return np.where(left, place + middles, place - line), left[0]
