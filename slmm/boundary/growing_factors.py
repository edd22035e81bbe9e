"""Factors of a matrix that grows by rows and columns, and loses its last ones."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.linalg.lapack import dgetrf, dtrtrs

from slmm.boundary.rules import Array

#: room for so many rows at first; chosen: columns a power of two apart have to share the cache
ROOM = 300


class GrowingFactors:
    """L and U of a matrix, block by block; pivots are sought within each block alone.

    Examples
    --------
    >>> S = np.array([[2.0, 1.0, 0.0], [1.0, 3.0, 1.0], [0.0, 1.0, 4.0]])
    >>> factors = GrowingFactors()
    >>> factors.append(S[:2, :2])
    >>> factors.append(S)
    >>> bool(np.allclose(S @ factors.solve(np.ones(3)), 1.0))
    True
    >>> factors.truncate(2)
    >>> factors.size
    2
    """

    def __init__(self) -> None:
        """Of a matrix without rows."""
        self.size = 0
        self._begins: list[int] = []
        self._pivots = np.empty(0, dtype=int)
        self._lu = np.empty((ROOM, ROOM), order="F")

    def truncate(self, size: int) -> None:
        """Forget the blocks that have rows from ``size`` on."""
        while self._begins and self.size > size:
            self.size = self._begins.pop()
        self._pivots = self._pivots[: self.size]

    def append(self, matrix: Array, *sizes: int) -> None:
        """Rows and columns of a matrix (m, m) beyond those that are known, as one block or several.

        Parameters
        ----------
        matrix : ndarray, shape (m, m)
        sizes : int
            Where further blocks begin.
        """
        a, m = self.size, len(matrix)
        self._make_room(m)
        lu = self._lu
        rest = np.array(matrix[a:m, a:m], order="F")
        if a:
            # what is known acts on all new blocks at once
            right, _ = dtrtrs(lu[:, :a], np.asfortranarray(matrix[self._pivots, a:m]), lower=1, unitdiag=1)
            below, _ = dtrtrs(lu[:, :a], np.asfortranarray(matrix[a:m, :a].T), trans=1)
            rest -= below.T @ right
            lu[:a, a:m], lu[a:m, :a] = right, below.T
        for begin, end in pairwise((a, *sizes, m)):
            here, beyond = slice(begin - a, end - a), slice(end - a, None)
            factors, swaps, _ = dgetrf(rest[here, here])
            order = np.arange(end - begin)
            for k, swap in enumerate(swaps.tolist()):
                order[[k, swap]] = order[[swap, k]]
            lu[begin:end, begin:end] = factors
            lu[begin:end, :begin] = lu[begin + order, :begin]
            if end < m:
                right, _ = dtrtrs(factors, np.asfortranarray(rest[here, beyond][order]), lower=1, unitdiag=1)
                below, _ = dtrtrs(factors, np.asfortranarray(rest[beyond, here].T), trans=1)
                rest[beyond, beyond] -= below.T @ right
                lu[begin:end, end:m], lu[end:m, begin:end] = right, below.T
            self._pivots = np.concatenate([self._pivots, begin + order])
            self._begins.append(begin)
        self.size = m

    def _make_room(self, size: int) -> None:
        if size <= len(self._lu):
            return
        a, old = self.size, self._lu
        self._lu = np.empty((2 * size, 2 * size), order="F")
        self._lu[:a, :a] = old[:a, :a]

    def solve(self, right: Array) -> Array:
        """The solution (m,) for a right-hand side (m,), or (m, k) for k of them."""
        if not self.size:
            return np.empty(right.shape)
        lu = self._lu[:, : self.size]
        sides = right[self._pivots].reshape(self.size, -1)
        x, _ = dtrtrs(lu, np.asfortranarray(sides), lower=1, unitdiag=1)
        x, _ = dtrtrs(lu, x, overwrite_b=1)
        return np.asarray(x).reshape(right.shape)
