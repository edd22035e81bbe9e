"""Which of some points lie nearest to others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Array = NDArray[np.float64]

#: pairs of points up to which all distances are computed, in 10 ms; beyond, a tree pays, although `scipy.spatial`
#: takes a tenth of a second to load (chosen by the time)
PAIRS = 10_000_000


@dataclass(frozen=True, eq=False)
class Nearest:
    """Points (n, 2) among which the nearest ones are sought.

    Examples
    --------
    >>> at = Nearest(np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]]))
    >>> at.numbers(np.array([[1.2, 5.0], [2.5, 0.0]]), 2).tolist()
    [[1, 0], [2, 1]]
    """

    points: Array

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(self.points)

    def numbers(self, of: Array, count: int) -> NDArray[np.int64]:
        """Numbers (k, count) of those next to points (k, 2), the nearest one first."""
        if len(of) * len(self.points) > PAIRS:
            return np.asarray(self._tree.query(of, k=np.arange(1, count + 1))[1])
        found: NDArray[np.int64] = _numbers(
            np.ascontiguousarray(self.points), np.ascontiguousarray(of), count
        )
        return found


@njit(cache=True)
def _numbers(points, of, count):
    found = np.zeros((len(of), count), dtype=np.int64)
    apart = np.empty(count)
    for i in range(len(of)):
        apart[:] = np.inf
        for k in range(len(points)):
            dx, dy = of[i, 0] - points[k, 0], of[i, 1] - points[k, 1]
            gap = dx * dx + dy * dy
            if gap < apart[count - 1]:
                j = count - 1
                while j > 0 and gap < apart[j - 1]:
                    apart[j], found[i, j] = apart[j - 1], found[i, j - 1]
                    j -= 1
                apart[j], found[i, j] = gap, k
    return found
