"""Factors of a matrix that grows by rows and columns, and loses its last ones."""

from __future__ import annotations

import numpy as np
import scipy.linalg as la
from scipy.linalg.lapack import dtrtrs

from slmm.boundary.rules import Array

#: room for so many rows at first; chosen
ROOM = 1024


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

    def append(self, matrix: Array) -> None:
        """Rows and columns of a matrix (m, m) beyond those that are known, as one block."""
        a, b = self.size, len(matrix)
        if b > len(self._lu):
            room = np.empty((2 * b, 2 * b), order="F")
            room[:a, :a] = self._lu[:a, :a]
            self._lu = room
        lu = self._lu
        block = matrix[a:b, a:b].copy()
        if a:
            right, _ = dtrtrs(lu[:, :a], np.asfortranarray(matrix[self._pivots, a:b]), lower=1, unitdiag=1)
            below, _ = dtrtrs(lu[:, :a], np.asfortranarray(matrix[a:b, :a].T), trans=1)
            block -= below.T @ right
            lu[:a, a:b] = right
        factors, swaps = la.lu_factor(block, overwrite_a=True, check_finite=False)
        order = np.arange(b - a)
        for k, swap in enumerate(swaps.tolist()):
            order[[k, swap]] = order[[swap, k]]
        lu[a:b, a:b] = factors
        if a:
            lu[a:b, :a] = below.T[order]
        self._pivots = np.concatenate([self._pivots, a + order])
        self._begins.append(a)
        self.size = b

    def solve(self, right: Array) -> Array:
        """The solution (m,) for a right-hand side (m,), or (m, k) for k of them."""
        if not self.size:
            return np.empty(right.shape)
        lu = self._lu[:, : self.size]
        sides = right[self._pivots].reshape(self.size, -1)
        x, _ = dtrtrs(lu, np.asfortranarray(sides), lower=1, unitdiag=1)
        x, _ = dtrtrs(lu, x, overwrite_b=1)
        return np.asarray(x).reshape(right.shape)
