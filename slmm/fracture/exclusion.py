"""Where surfaces are not asked for cracks that start: held, or beside what a stress rises to by itself.

At the end of a support, at a corner, and where a crack begins at a surface the model's stress has no largest value, so
that the stress at a depth says nothing of the strength there. Corners are sites of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.part.part import Part
from slmm.scene.loading import Loading

Array = NDArray[np.float64]

#: points nearer to the mouth of a crack, a corner or the end of a support than so many depths belong to it; chosen
BESIDE = 2.5


class Exclusion(NamedTuple):
    """Places of surfaces where no crack starts.

    Attributes
    ----------
    points : ndarray, shape (k, 2)
        What is kept clear of, mm.
    names : sequence of str
        What each of them is.
    reach : float
        How far, mm.
    loading : Loading
        Where it holds the part, none starts either.
    """

    points: Array
    names: Sequence[str]
    reach: float
    loading: Loading

    @classmethod
    def of(cls, part: Part, loading: Loading, depth: float) -> Exclusion:
        """What a part and its supports exclude, for the stress at a depth, mm.

        Examples
        --------
        >>> from slmm.scene.gallery import tensile_plate
        >>> plate = tensile_plate()
        >>> excluded = Exclusion.of(plate.part, plate.loading, 0.1)
        >>> excluded.free(np.array([[0.0, 40.2], [0.0, 40.3], [40.0, 80.0]])).tolist()
        [False, True, False]
        >>> excluded.reason(np.array([0.0, 40.3]))
        'beside the mouth of a crack at (0, 40)'
        """
        supports = [condition.ends for condition in loading if any(condition.is_held)]
        corners = [
            outline.points(outline.corners[outline.corner_angles < np.pi])
            for outline in part.outlines
            if len(outline.corners)
        ]
        none = np.empty((0, 2))
        groups = {
            "the end of a support": np.concatenate([none, *supports]),
            "the mouth of a crack": mouths(part),
            "a corner": np.concatenate([none, *corners]),
        }
        names = [name for name, points in groups.items() for _ in points]
        return cls(np.concatenate(list(groups.values())), names, BESIDE * depth, loading)

    def free(self, points: Array) -> NDArray[np.bool_]:
        """At which points (n, 2) of surfaces cracks may start."""
        return self.is_clear(points) & ~held(self.loading, points)

    def is_clear(self, points: Array) -> NDArray[np.bool_]:
        """Which points (n, 2) are beside nothing that is kept clear of, whether or not they are held."""
        return np.asarray(self._distances(points).min(axis=1, initial=np.inf) > self.reach)

    def reason(self, point: Array) -> str:
        """What a point (2,) is beside of."""
        k = int(self._distances(point[None])[0].argmin())
        x, y = (round(float(value), 9) + 0.0 for value in self.points[k])
        return f"beside {self.names[k]} at ({x:.4g}, {y:.4g})"

    def _distances(self, points: Array) -> Array:
        (x, y), (at_x, at_y) = points.T, self.points.T
        return np.asarray(np.hypot(x[:, None] - at_x, y[:, None] - at_y))


def mouths(part: Part) -> Array:
    """Ends (k, 2) of cracks on surfaces, mm."""
    ends = [
        point
        for crack in part.cracks
        for end, point in ((crack.start, crack.points[0]), (crack.end, crack.points[-1]))
        if end.kind == "surface"
    ]
    return np.array(ends).reshape(-1, 2)


def held(loading: Loading, points: Array) -> NDArray[np.bool_]:
    """Which points (n, 2) lie where a displacement is prescribed."""
    on = np.zeros(len(points), dtype=bool)
    for condition in loading:
        if any(condition.is_held):
            on |= condition.on(points)
    return on
