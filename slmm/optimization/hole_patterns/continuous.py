"""Support values of a design as continuous variables: those that symmetry makes equal are one, and the spacing is one.

The topology stays: the same support points lie in the same holes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.optimization.hole_patterns.patterns import SIDES, Design
from slmm.optimization.hole_patterns.plate import CrackedPlate
from slmm.part.level_set import IslandError, LevelSet

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ContinuousPattern:
    """The plates near a design.

    Parameters
    ----------
    plate : CrackedPlate
    whole : ndarray of bool (grid, grid)
        The design's whole grid.
    sides : {"all", "left"}
        From which the crack may come; what is different then is not tied by symmetry.
    """

    plate: CrackedPlate
    whole: Design
    sides: str = "all"

    @cached_property
    def tied(self) -> NDArray[np.int64]:
        """Number (grid, grid) of the variable that each support point has its value from.

        Examples
        --------
        >>> ContinuousPattern(CrackedPlate(), np.eye(3, dtype=bool)).tied.tolist()
        [[0, 1, 2], [1, 3, 1], [2, 1, 0]]
        """
        number = np.arange(self.whole.size).reshape(self.whole.shape)
        least = number
        for k in range(SIDES[self.sides]):
            for step in (1, -1):
                if (np.rot90(self.whole, k)[::step] == self.whole).all():
                    least = np.minimum(least, np.rot90(number, k)[::step])
        _, tied = np.unique(least, return_inverse=True)
        return np.asarray(tied.reshape(self.whole.shape))

    @property
    def start(self) -> Array:
        """Variables (n,) of the design: its support values and, the last one, the spacing over its own."""
        _, first = np.unique(self.tied, return_index=True)
        return np.append(self.whole.ravel()[first].astype(float), 1.0)

    def values(self, variables: Sequence[float] | Array) -> Array:
        """Support values (grid, grid)."""
        return np.asarray(variables, dtype=float)[self.tied]

    def plate_of(self, variables: Sequence[float] | Array) -> CrackedPlate:
        """The plate with the frame that the spacing leaves.

        Raises
        ------
        ValueError
            When it leaves none.
        """
        side = self.plate.side
        return replace(self.plate, frame=side / 2 - (side / 2 - self.plate.frame) * float(variables[-1]))

    def alike(self, directions: int) -> list[int]:
        """For each of so many directions, in quarter turns, the first one that is equal by the design's own symmetry.

        Examples
        --------
        >>> ContinuousPattern(CrackedPlate(), np.eye(3, dtype=bool)).alike(4)
        [0, 0, 0, 0]
        """
        turned = [np.rot90(self.whole, k) for k in range(directions)]
        return [
            next(k for k, other in enumerate(turned) if any((one == other[::step]).all() for step in (1, -1)))
            for one in turned
        ]

    def keeps_topology(self, variables: Sequence[float] | Array) -> bool:
        """Whether the same support points lie in the same holes."""
        found = connected(self.plate.level_set(self.values(variables)))
        return found is not None and bool((found == self._connected).all())

    @cached_property
    def _connected(self) -> NDArray[np.int64]:
        found = connected(self.plate.level_set(self.whole))
        if found is None:
            raise ValueError("whole: has no holes, or ones without a support point, or an island of material")
        return found


def connected(level_set: LevelSet) -> NDArray[np.int64] | None:
    """Number (n, n), from 1 on, of the hole in which each support point lies, 0 of material.

    None where there is a hole without a support point, an island of material, or no hole at all.

    Examples
    --------
    >>> connected(CrackedPlate().level_set(np.array([[1, 0, 1], [1, 0, 0], [0, 0, 1]]))).tolist()
    [[1, 0, 2], [1, 0, 0], [0, 0, 3]]
    """
    try:
        holes = [shapely.Polygon(places) for places in level_set.contours()]
    except IslandError:
        return None
    x, y = np.meshgrid(level_set.axis[1:-1], level_set.axis[-2:0:-1])
    inside = np.array([shapely.contains_xy(hole, x, y) for hole in holes])
    if not len(holes) or not inside.any(axis=(1, 2)).all():
        return None
    number = np.where(inside.any(axis=0), inside.argmax(axis=0) + 1, 0)
    # in the order in which they come in rows
    _, first = np.unique(number[number > 0], return_index=True)
    order = np.zeros(len(holes) + 1, dtype=int)
    order[number[number > 0][np.sort(first)]] = np.arange(1, len(holes) + 1)
    return np.asarray(order[number])
