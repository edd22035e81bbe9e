"""Peaks of the stress at a depth below free surfaces, whatever solved the part: for the point method (Paper D, 2.2.2).

An engine brings the closed curves around the part with points along them, and the principal stress at depth below any
place. Peaks lie between the points: each is followed by polynomials along its curve.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
import shapely
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from slmm.boundary.contour import Places
from slmm.part.part import Part
from slmm.scene.loading import Loading

Array = NDArray[np.float64]

#: peaks between points may be so much higher than at the points; chosen
BETWEEN = 1.1
#: points nearer to the mouth of a crack, or to a corner, than so many depths belong to it; chosen
BESIDE_MOUTH = 2.5
#: points that a peak is sought by in each of two rounds, and how much the second one is narrower; chosen
SOUGHT, NARROWER = 7, 0.15
#: peaks that are followed, at most: a uniform stress has one at every point; chosen
MOST_PEAKS = 12


class Curve(Protocol):
    """A closed curve around a part, the body on its left."""

    @property
    def length(self) -> float:
        """mm."""
        ...

    def at(self, way: Array) -> Places:
        """Places after a way (k,) along the curve, mm, modulo its length."""
        ...


class Sampled(NamedTuple):
    """A curve and what is known at points along it.

    Attributes
    ----------
    curve : Curve
    way : ndarray, shape (n,)
        Ascending, mm.
    allowed : ndarray, shape (n,) of bool
        Where cracks may start.
    below : ndarray, shape (n,)
        Principal stress at depth, MPa; -inf where it was not asked.
    """

    curve: Curve
    way: Array
    allowed: NDArray[np.bool_]
    below: Array


class Site(NamedTuple):
    """Where a crack may start.

    Attributes
    ----------
    point, inward : ndarray, shape (2,)
        mm, and the unit normal into the body.
    hole : int
        Which outline of the part, -1 for a straight outer edge.
    stress : float
        Principal stress at the critical distance under the model's load, MPa.
    """

    point: Array
    inward: Array
    hole: int
    stress: float


StressBelow = Callable[[Places], Array]


def may_start(part: Part, loading: Loading, points: Array, depth: float) -> NDArray[np.bool_]:
    """Which points (n, 2) of free surfaces are beside no mouth of a crack, corner or end of a support."""
    corners = [outline.points(outline.corners[outline.corner_angles < np.pi]) for outline in part.outlines]
    # where a support ends its model has a stress that the support itself would not have
    supports = [condition.ends for condition in loading if any(condition.is_held)]
    special = np.concatenate([np.empty((0, 2)), mouths(part), *corners, *supports])
    if not len(special):
        return np.ones(len(points), dtype=bool)
    return np.asarray(cKDTree(special).query(points)[0] > BESIDE_MOUTH * depth)


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


def at_peaks(sampled: Sequence[Sampled], stress_below: StressBelow, least: float) -> list[Site]:
    """Peaks along curves that may exceed a stress, MPa, at most `MOST_PEAKS`.

    Examples
    --------
    The stress below the edge of a plate has its peak between two points.

    >>> class Edge:
    ...     length = 10.0
    ...
    ...     def at(self, way):
    ...         x = np.mod(way, self.length)
    ...         inward = np.tile([0.0, 1.0], (len(x), 1))
    ...         return Places(np.column_stack([x, 0 * x]), inward, np.full(len(x), -1))
    >>> below = lambda places: 1 - ((places.points[:, 0] - 4.3) / 5) ** 2
    >>> way = np.arange(0.5, 10)
    >>> edge = Sampled(Edge(), way, np.ones(10, dtype=bool), below(Edge().at(way)))
    >>> [site] = at_peaks([edge], below, 0.5)
    >>> site.point.round(2).tolist(), round(site.stress, 4)
    ([4.3, 0.0], 1.0)
    """
    highest = max((float(each.below.max(initial=-np.inf)) for each in sampled), default=-np.inf)
    brackets = []
    for curve, way, allowed, value in sampled:
        before, after = np.roll(value, 1), np.roll(value, -1)
        step_back = np.mod(way - np.roll(way, 1), curve.length)
        step_on = np.mod(np.roll(way, -1) - way, curve.length)
        # not into what belongs to a mouth or a corner
        step_back[np.roll(~allowed, 1)] = 0.0
        step_on[np.roll(~allowed, -1)] = 0.0
        peaks = (value >= before) & (value >= after) & (value > max(least, highest) / BETWEEN)
        brackets += [
            (value[k], curve, way[k] - step_back[k], way[k] + step_on[k]) for k in np.flatnonzero(peaks)
        ]
    brackets.sort(key=lambda bracket: -bracket[0])
    return _followed(brackets[:MOST_PEAKS], stress_below) if brackets else []


def _followed(brackets: Sequence[tuple[float, Curve, float, float]], stress_below: StressBelow) -> list[Site]:
    """The peaks within brackets (value at its point, curve, from, to)."""
    curves = [bracket[1] for bracket in brackets]
    middle = np.array([0.5 * (low + high) for *_, low, high in brackets])
    half = np.array([0.5 * (high - low) for *_, low, high in brackets])
    x = chebyshev.chebpts1(SOUGHT)
    fine = np.linspace(-1.0, 1.0, 401)
    to_fine = chebyshev.chebvander(fine, SOUGHT - 1) @ np.linalg.inv(chebyshev.chebvander(x, SOUGHT - 1))
    for width in (half, NARROWER * half):
        ways = middle[:, None] + width[:, None] * x
        where = _joined([curve.at(way) for curve, way in zip(curves, ways, strict=True)])
        value = stress_below(where).reshape(len(brackets), SOUGHT) @ to_fine.T
        best = value.argmax(axis=1)
        middle = middle + width * fine[best]
    sites = _joined([curve.at(np.array([way])) for curve, way in zip(curves, middle, strict=True)])
    return [
        Site(point, inward, int(hole), float(stress))
        for point, inward, hole, stress in zip(*sites, value.max(axis=1), strict=True)
    ]


def _joined(places: Sequence[Places]) -> Places:
    return Places(*(np.concatenate(values) for values in zip(*places, strict=True)))


def at_corners(part: Part, loading: Loading, stress_below: StressBelow, depth: float) -> list[Site]:
    """Corners that point into the material, along their bisectors, where nothing holds them and no crack begins."""
    found = []
    for k, outline in enumerate(part.outlines):
        s = outline.corners[outline.corner_angles < np.pi]
        if not len(s):
            continue
        points = outline.points(s)
        # a notch that cuts the outer edge has corners outside
        on_surface = shapely.dwithin(shapely.points(points), part.body.boundary, 2 * part.tolerance)
        cut = np.linalg.norm(points[:, None] - mouths(part), axis=-1).min(axis=1, initial=np.inf) <= depth
        here = np.flatnonzero(on_surface & ~held(loading, points) & ~cut)
        if not len(here):
            continue
        where = Places(points[here], outline.normals(s[here]), np.full(len(here), k))
        stress = stress_below(where)
        found += [Site(p, n, k, float(v)) for p, n, v in zip(*where[:2], stress, strict=True)]
    return found
