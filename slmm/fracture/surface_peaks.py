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
from scipy.signal import find_peaks

from slmm.boundary.contour import Places
from slmm.fracture.exclusion import Exclusion, held, mouths
from slmm.part.part import Part
from slmm.scene.loading import Loading

Array = NDArray[np.float64]

#: peaks between points may be so much higher than at the points; chosen
BETWEEN = 1.1
#: points that a peak is sought by in each of two rounds, and how much the second one is narrower; chosen
SOUGHT, NARROWER = 7, 0.15
#: peaks that are followed, at most: a uniform stress has one at every point; chosen
MOST_PEAKS = 12
#: of several maxima between two points each is a peak that comes so near to the highest one; chosen, so that ties of
#: mirrored places are decided where all are known, and not by round-off here
AS_HIGH = 1e-3
#: and is parted from it by a dip so deep, over its height; round-off
DIP = 1e-7
#: halvings by which the end of a stretch is found between two points, to the last digits of its place
HALVINGS = 40
#: places that are so near to the end of a stretch, over the stretch that was looked at, are the end; round-off
AT_END = 1e-9


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
    excluded : str
        Why no crack is let start there, for all its stress; empty where one may.
    """

    point: Array
    inward: Array
    hole: int
    stress: float
    excluded: str = ""


class Bracket(NamedTuple):
    """A stretch of a curve with a peak in it.

    Attributes
    ----------
    value : float
        At its point, MPa.
    curve : Curve
    low, high : float
        From and to, mm along the curve.
    ends : (bool, bool)
        Whether cracks may start up to there and no farther.
    """

    value: float
    curve: Curve
    low: float
    high: float
    ends: tuple[bool, bool]


StressBelow = Callable[[Places], Array]


def at_peaks(
    sampled: Sequence[Sampled], stress_below: StressBelow, least: float, exclusion: Exclusion
) -> list[Site]:
    """Peaks along curves that may exceed a stress, MPa, at most `MOST_PEAKS`.

    The stress falls on both sides of a peak. Where it rises up to the end of what may crack it belongs to what lies
    beyond, a support's end or a mouth, and has no largest value of its own: such a place comes with the reason why it
    is excluded, at the very end, whatever the points are.

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
    >>> everywhere = Exclusion(np.empty((0, 2)), [], 0.0, Loading(()))
    >>> [site] = at_peaks([edge], below, 0.5, everywhere)
    >>> site.point.round(2).tolist(), round(site.stress, 4)
    ([4.3, 0.0], 1.0)
    """
    tops = [_tops(each) for each in sampled]
    # what rises to an end must not hide the peaks elsewhere
    highest = max(
        (
            float(each.below[top & inner].max(initial=-np.inf))
            for each, (top, inner) in zip(sampled, tops, strict=True)
        ),
        default=-np.inf,
    )
    peaks: list[Bracket] = []
    ends: list[Bracket] = []
    for each, (top, inner) in zip(sampled, tops, strict=True):
        for k in np.flatnonzero(top & (each.below > max(least, highest) / BETWEEN)).tolist():
            (peaks if inner[k] else ends).append(_bracket(each, k, exclusion))
    peaks = sorted(peaks, key=lambda bracket: -bracket.value)[:MOST_PEAKS] + ends
    return _followed(peaks, stress_below, exclusion) if peaks else []


def _tops(sampled: Sampled) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Points (n,) with no higher one beside them, and those between two where cracks may start."""
    _, _, allowed, value = sampled
    value = np.where(allowed, value, -np.inf)
    top = np.isfinite(value) & (value >= np.roll(value, 1)) & (value >= np.roll(value, -1))
    return top, np.roll(allowed, 1) & allowed & np.roll(allowed, -1)


def _bracket(sampled: Sampled, k: int, exclusion: Exclusion) -> Bracket:
    """From the point before another one to the one behind, or to the end of what may crack."""
    curve, way, allowed, value = sampled
    limits, ends = [], []
    for step in (-1, 1):
        beside = (k + step) % len(way)
        reach = float(np.mod(step * (way[beside] - way[k]), curve.length))
        ends.append(not allowed[beside])
        if ends[-1]:
            clear, beyond = 0.0, reach
            for _ in range(HALVINGS):
                middle = 0.5 * (clear + beyond)
                if exclusion.free(curve.at(way[k : k + 1] + step * middle).points)[0]:
                    clear = middle
                else:
                    beyond = middle
            reach = clear
        limits.append(float(way[k]) + step * reach)
    return Bracket(float(value[k]), curve, limits[0], limits[1], (ends[0], ends[1]))


def _followed(brackets: Sequence[Bracket], stress_below: StressBelow, exclusion: Exclusion) -> list[Site]:
    """The peaks within brackets, of which one may have several."""
    low, high = np.array([[bracket.low, bracket.high] for bracket in brackets]).T
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    x = chebyshev.chebpts1(SOUGHT)
    fine = np.linspace(-1.0, 1.0, 401)
    to_fine = chebyshev.chebvander(fine, SOUGHT - 1) @ np.linalg.inv(chebyshev.chebvander(x, SOUGHT - 1))
    for width in (1.0, NARROWER):
        middle = np.clip(middle, low + width * half, high - width * half)
        ways = middle[:, None] + width * half[:, None] * x
        where = _joined([bracket.curve.at(way) for bracket, way in zip(brackets, ways, strict=True)])
        value = stress_below(where).reshape(len(brackets), SOUGHT) @ to_fine.T
        # in the second round there is one, or it was found as a peak of its own
        number, at = _maxima(value) if width == 1.0 else (np.arange(len(value)), value.argmax(axis=1))
        brackets, value = [brackets[k] for k in number], value[number]
        low, high, middle, half = low[number], high[number], middle[number], half[number]
        middle = middle + width * half * _summits(fine, value, at)
    curves = [bracket.curve for bracket in brackets]
    ends = np.array([bracket.ends for bracket in brackets])
    near = np.column_stack([middle - low, high - middle]) <= AT_END * half[:, None]
    at_end = (ends & near).any(axis=1)
    sites = _joined([curve.at(np.array([way])) for curve, way in zip(curves, middle, strict=True)])
    return [
        Site(point, inward, int(hole), float(stress), exclusion.reason(point) if ended else "")
        for point, inward, hole, stress, ended in zip(*sites, value.max(axis=1), at_end, strict=True)
    ]


def _maxima(value: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of the highest value of each row (n, k), and of other maxima that come near to it."""
    number, at = [], []
    for k, row in enumerate(value):
        top = int(row.argmax())
        high = float(row[top])
        others = find_peaks(row, height=high - AS_HIGH * abs(high), prominence=DIP * abs(high))[0].tolist()
        between = [row[min(top, other) : max(top, other) + 1].min() for other in others]
        own = [top, *(o for o, low in zip(others, between, strict=True) if low < high - DIP * abs(high))]
        number += [k] * len(own)
        at += own
    return np.array(number), np.array(at)


def _summits(x: Array, values: Array, top: NDArray[np.int64]) -> Array:
    """Where the rows of values (k, n) at evenly spaced x (n,) are largest beside one of them, by a parabola.

    The largest value alone stands at one point or its neighbour as rounding decides.
    """
    row, inner = np.arange(len(values)), np.clip(top, 1, len(x) - 2)
    low, middle, high = (values[row, inner + k] for k in (-1, 0, 1))
    bend = np.where(top == inner, low - 2 * middle + high, 0.0)
    flat = bend >= 0
    beside = np.where(flat, 0.0, 0.5 * (low - high) / np.where(flat, 1.0, bend))
    return np.asarray(x[top] + beside * (x[1] - x[0]))


def _joined(places: Sequence[Places]) -> Places:
    return Places(*(np.concatenate(values) for values in zip(*places, strict=True)))


def at_corners(part: Part, loading: Loading, stress_below: StressBelow, depth: float) -> list[Site]:
    """Corners that point into the material, along their bisectors, where nothing holds them and no crack begins."""
    found = []
    for k, outline in enumerate(part.outlines):
        s = outline.corners[outline.corner_angles < np.pi] if len(outline.corners) else outline.corners
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
