"""How the curves around a part are divided into panels: by curvature, corners and other surfaces, mouths and tips.

Panels are halved until they are short enough. A mouth of a crack or a tip nearby divides the panels there alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slmm.boundary.panels import Interval, Panels, panels_on
from slmm.boundary.rules import Array, Complex
from slmm.boundary.stretches import Grading, Stretch

#: panel on a straight edge over the part's smaller side, at most (chosen on the cases of tests/boundary)
PER_SIDE = 0.25
#: points along a curve that tell how near others are, and along a panel; chosen
SAMPLES, ALONG = 200, np.linspace(0.0, 1.0, 9)
#: places around a closed curve that tell how long panels may be there, and its panels, at least; chosen
EVEN, LEAST = 400, 4
#: points on all panels, at most: beyond, what is kept takes more than 2 GB (chosen)
MOST_POINTS = 60_000
#: shares of a curve that differ by less are one; round-off
SAME = 1e-9


class TooManyPointsError(ValueError):
    """A part with more outlines than can be solved."""


@dataclass(frozen=True, eq=False)
class Panelling:
    """Curves around a part, and the mouths of cracks that lie on them.

    Parameters
    ----------
    contours : sequence of sequence of Stretch
    side : float
        The part's smaller side, mm.
    near : float
        A mouth as near to a curve lies on it, mm.
    grading : Grading
    mouths : dict
        Of a curve's number: shares of its length at which cracks end, and the shortest panels there, mm.
    """

    contours: Sequence[Sequence[Stretch]]
    side: float
    near: float
    grading: Grading
    mouths: dict[int, list[tuple[float, float]]] = field(default_factory=dict)

    def first(self, p: int) -> Panels:
        """Panels without any crack."""
        found = []
        stretches = [stretch for ring in self.contours for stretch in ring]
        contour = [c for c, ring in enumerate(self.contours) for _ in ring]
        z = np.array([stretch.points(np.linspace(0.0, 1.0, SAMPLES)) for stretch in stretches])
        middle = z.mean(axis=1)
        samples = _Samples(z, np.array(contour), middle, np.abs(z - middle[:, None]).max(axis=1))
        for number, (c, stretch) in enumerate(zip(contour, stretches, strict=True)):
            cuts = self._cuts(stretch, c, samples).tolist()
            found += [Interval(number, a, b, c, stretch) for a, b in pairwise(cuts)]
        _check_number(len(found) * p)
        return panels_on(found, p)

    def _cuts(self, stretch: Stretch, contour: int, samples: _Samples) -> Array:
        """Shares of a stretch at which its panels end."""
        if stretch.closed:
            return self._even_cuts(stretch, contour, samples)
        length = stretch.length

        def allowed(a: Array, b: Array) -> Array:
            share: Array = a[:, None] + (b - a)[:, None] * ALONG
            longest = self._longest(stretch, share.ravel(), contour, samples).reshape(share.shape).min(axis=1)
            # towards both ends panels become as short as their distance from there
            first, last = stretch.last
            return np.minimum(longest, np.minimum(np.maximum(a, first), np.maximum(1.0 - b, last)) * length)

        a, _ = _halved(np.zeros(1), np.ones(1), length, allowed)
        return np.append(a, 1.0)

    def _even_cuts(self, stretch: Stretch, contour: int, samples: _Samples) -> Array:
        """The same of a smooth closed curve: each panel is as good a share of what it may be."""
        share = stretch.shares(EVEN)
        longest = self._longest(stretch, share, contour, samples) / stretch.length
        # beside a short panel none is longer than that and its distance, all round the curve
        way, length = np.concatenate([share - 1.0, share, share + 1.0]), np.tile(longest, 3)
        behind = np.minimum.accumulate(length - way) + way
        ahead = np.minimum.accumulate((length + way)[::-1])[::-1] - way
        longest = np.minimum(behind, ahead)[len(share) : 2 * len(share)]
        density = 1.0 / longest
        number = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(share))])
        n = max(LEAST, int(np.ceil(number[-1] * (1 - SAME))))
        return np.interp(np.arange(n + 1) / n, number / number[-1], share)

    def _longest(self, stretch: Stretch, share: Array, contour: int, samples: _Samples) -> Array:
        """How long panels may be at shares (n,) of a stretch, mm."""
        enough = PER_SIDE * self.side / self.grading.distance
        longest = self.grading.distance * _distance(stretch.points(share), contour, samples, enough)
        if stretch.outline is None:
            return np.asarray(longest)
        bend = stretch.outline.curvatures(stretch.s[0] - share * stretch.length)
        return np.asarray(np.minimum(longest, self.grading.radius / np.maximum(np.abs(bend), 1e-12)))

    def with_mouths(self, points: Iterable[complex]) -> Panelling:
        """With more mouths, mm."""
        mouths = {number: list(known) for number, known in self.mouths.items()}
        stretches = [stretch for ring in self.contours for stretch in ring]
        for point in points:
            places = [(number, _place(stretch, point, self.near)) for number, stretch in enumerate(stretches)]
            here = [(number, share) for number, share in places if share is not None]
            sides = [_shorter_side(stretches[number], share) for number, share in here]
            for number, share in here:
                mouths.setdefault(number, []).append((share, self.grading.side * min(sides)))
        return replace(self, mouths=mouths)

    def divided(self, panels: Panels, tips: Complex) -> Panels:
        """Panels that end at the mouths, and are as short as these and crack tips (k,) ask for."""
        low, high = (np.array([interval[k] for interval in panels.intervals]) for k in (1, 2))
        fine = panels.fine.reshape(len(low), -1)
        asked = np.zeros(len(low), dtype=bool)
        for tip in tips:
            # between a panel's points and ends the distance changes by a share of its length
            asked |= panels.length > 0.5 * self.grading.tip * np.abs(fine - tip).min(axis=1)
        for number, mouths in self.mouths.items():
            here = np.flatnonzero(panels.smooth == number)
            stretch = panels.intervals[here[0]].stretch
            longest = _longest_at(mouths, stretch, low[here], high[here])
            inside = [(low[here] + SAME < share) & (share < high[here] - SAME) for share, _ in mouths]
            asked[here] |= np.any(inside, axis=0) | (panels.length[here] > longest * (1 + SAME))
        more: list[Interval] = []
        for k in np.flatnonzero(asked).tolist():
            parts = self._parts(panels.intervals[k], tips)
            asked[k] = len(parts) > 1
            more += parts if asked[k] else []
        if not more:
            return panels
        kept = np.flatnonzero(~asked)
        _check_number((len(kept) + len(more)) * panels.p)
        return panels.with_new(kept, panels_on(more, panels.p))

    def _parts(self, interval: Interval, tips: Complex) -> list[Interval]:
        """What an interval is divided into."""
        stretch, mouths = interval.stretch, self.mouths.get(interval.smooth, [])

        def allowed(a: Array, b: Array) -> Array:
            longest = _longest_at(mouths, stretch, a, b)
            if len(tips):
                share: Array = a[:, None] + (b - a)[:, None] * ALONG
                z = stretch.points(share.ravel()).reshape(share.shape)
                nearest = np.abs(z[:, :, None] - tips).min(axis=(1, 2))
                longest = np.minimum(longest, self.grading.tip * nearest)
            return longest

        inside = [s for s, _ in mouths if interval.low + SAME < s < interval.high - SAME]
        cuts = np.array([interval.low, *sorted(inside), interval.high])
        a, b = _halved(cuts[:-1], cuts[1:], stretch.length, allowed)
        return [interval._replace(low=u, high=v) for u, v in zip(a.tolist(), b.tolist(), strict=True)]


def _longest_at(mouths: Sequence[tuple[float, float]], stretch: Stretch, a: Array, b: Array) -> Array:
    """How long panels between shares (k,) of a stretch may be beside its mouths, mm."""
    longest = np.full(len(a), np.inf)
    for share, shortest in mouths:
        away = np.maximum(np.maximum(a - share, share - b), 0.0)
        if stretch.closed:
            away = np.minimum(away, np.minimum(np.abs(a + 1 - share), np.abs(share + 1 - b)))
        longest = np.minimum(longest, np.maximum(away * stretch.length, shortest))
    return longest


def _halved(
    a: Array, b: Array, length: float, allowed: Callable[[Array, Array], Array]
) -> tuple[Array, Array]:
    """Shares from a (k,) to b (k,) of a length, mm, halved until they are short enough."""
    done = []
    while len(a):
        long = (b - a) * length > np.maximum(allowed(a, b), 1e-7 * length) * (1 + 1e-9)
        done.append(np.column_stack([a, b])[~long])
        middle = 0.5 * (a + b)[long]
        a, b = np.concatenate([a[long], middle]), np.concatenate([middle, b[long]])
    shares = np.concatenate(done)
    shares = shares[np.argsort(shares[:, 0])]
    return shares[:, 0], shares[:, 1]


def _shorter_side(stretch: Stretch, share: float) -> float:
    """Of the pieces into which a place divides a stretch, the length of the shorter one, mm."""
    if stretch.closed:
        return stretch.length
    return min(side for side in (share, 1.0 - share) if side > SAME) * stretch.length


def _place(stretch: Stretch, point: complex, near: float) -> float | None:
    """At which share of a stretch a point lies, if it does."""
    at = np.array([point.real, point.imag])
    if stretch.outline is None:
        way = ((point - stretch.start) * np.conj(stretch.end - stretch.start)).real / stretch.length
    else:
        low, high = stretch.outline.box
        if ((at < low - near) | (at > high + near)).any():
            return None
        around = stretch.outline.length
        way = np.mod(stretch.s[0] - stretch.outline.project(at[None])[0], around)
        if way - stretch.length > around - way:
            way = 0.0
    share = float(np.clip(way / stretch.length, 0.0, 1.0))
    (foot,) = stretch.points(np.array([share]))
    return share if abs(foot - point) <= near else None


def _check_number(points: int) -> None:
    if points > MOST_POINTS:
        raise TooManyPointsError(
            f"boundary integrals: the outlines need {points} points, and at most {MOST_POINTS} can be solved; "
            "use voxels or a body-fitted model"
        )


class _Samples(NamedTuple):
    """Points (k, s) along curves, the closed curves these are part of, and circles around them."""

    z: Complex
    contour: NDArray[np.int64]
    middle: Complex
    radius: Array


def _distance(z: Complex, contour: int, samples: _Samples, enough: float) -> Array:
    """Distances (n,) of points (n,) to the nearest curves of other contours, or ``enough``, mm."""
    return np.asarray(_nearest_other(z, contour, *samples, enough))


@njit(cache=True, error_model="numpy")
def _nearest_other(z, contour, samples, of, middle, radius, enough):
    """Kernel of `_distance`."""
    result = np.empty(len(z))
    for i in range(len(z)):
        x, y = z[i].real, z[i].imag
        least = enough * enough
        for k in range(len(of)):
            if of[k] == contour:
                continue
            dx, dy = middle[k].real - x, middle[k].imag - y
            away = np.sqrt(dx * dx + dy * dy) - radius[k]
            if away > 0 and away * away >= least:
                continue
            for j in range(samples.shape[1]):
                dx, dy = samples[k, j].real - x, samples[k, j].imag - y
                least = min(least, dx * dx + dy * dy)
        result[i] = np.sqrt(least)
    return result
