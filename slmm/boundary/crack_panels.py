"""Panels along cracks: straight, graded towards mouths and kinks, with the root of the distance built in at tips."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.polynomial import legendre
from numpy.typing import NDArray

from slmm.boundary.rules import Array, Complex, rule
from slmm.part.crack import TIP
from slmm.part.part import Part

#: last panel before a kink, and the panel at a tip, over the segment's length (chosen on the cases of tests/boundary)
AT_KINK, AT_TIP = 0.02, 0.4
#: a panel over its distance from surfaces, and from other cracks, whose tips make stresses vary most (chosen likewise)
PER_DISTANCE, PER_CRACK = 1.5, 0.75
#: a crack is near itself where it comes back: where points are apart by less than this share of the way between them
#: (chosen; of a half circle's ends it is 0.64)
COMES_BACK = 0.5
#: samples of a segment of a crack that tell how near it is (chosen)
SAMPLES = 100
#: places along a panel that tell how near it is (chosen)
ALONG = np.linspace(0.0, 1.0, 5)
#: of lengths of segments that are equal but for rounding
ROUND_OFF = 1e-6
#: kinks that turn by less need no shorter panels than the segments are, rad: K stays within 1e-4 (chosen)
MILD = 0.35
#: kinks that turn by more, rad, and meetings of cracks need panels so short (chosen on 30 random plates)
SHARP, AT_SHARP = 0.8, 2e-4


class CrackPanels(NamedTuple):
    """Straight panels; one that ``is_tip`` ends at a tip.

    Attributes
    ----------
    p : int
        Points on each panel.
    starts, ends : ndarray, shape (m,)
        mm.
    is_tip : ndarray, shape (m,) of bool
    tip : ndarray, shape (m,) of int
        Which tip of the part it leads to, -1 for none.
    z : ndarray, shape (m p,)
        Points, mm.
    """

    p: int
    starts: Complex
    ends: Complex
    is_tip: NDArray[np.bool_]
    tip: NDArray[np.int64]
    z: Complex

    @property
    def direction(self) -> Complex:
        """Unit vectors (m,)."""
        along = self.ends - self.starts
        return along / np.abs(along)

    def chosen(self, rows: NDArray[np.int64]) -> CrackPanels:
        """Some of them."""
        z = self.z.reshape(-1, self.p)[rows].ravel()
        return CrackPanels(self.p, self.starts[rows], self.ends[rows], self.is_tip[rows], self.tip[rows], z)


@lru_cache
def straight_rule(p: int) -> tuple[Array, Array, Array]:
    """Points, weights and inverse Vandermonde matrix of a panel without a tip."""
    x, w = rule(p)
    return x, w, np.linalg.inv(legendre.legvander(x, p - 1))


@lru_cache
def tip_rule(p: int) -> tuple[Array, Array, Array]:
    """The same over the root of the distance from a tip, (0, 1), for odd Legendre polynomials."""
    x, w = rule(2 * p)
    x, w = x[p:], w[p:]
    return x, w, np.linalg.inv(legendre.legvander(x, 2 * p - 1)[:, 1::2])


@lru_cache
def slope_at_tip(p: int) -> Array:
    """From values at the points of a panel with a tip to their derivative by the root of the distance, at the tip."""
    _, _, inverse = tip_rule(p)
    slopes = np.array([legendre.legval(0.0, legendre.legder(np.eye(2 * p)[k])) for k in range(1, 2 * p, 2)])
    return slopes @ inverse


@lru_cache
def at_tip(p: int) -> Array:
    """From values at the points of a panel with a tip to that at the tip, of what is smooth in the distance."""
    x, _, _ = tip_rule(p)
    r = 2 * x**2 - 1
    return legendre.legvander(np.array([-1.0]), p - 1)[0] @ np.linalg.inv(legendre.legvander(r, p - 1))


def crack_panels(part: Part, around: Complex, p: int, at_mouth: float) -> CrackPanels:
    """Panels along all cracks of a part.

    Parameters
    ----------
    part : Part
    around : ndarray, shape (k,)
        Samples of its surfaces, mm.
    p : int
        Points on each panel.
    at_mouth : float
        The last panel before a mouth, over the length of the crack.

    Raises
    ------
    ValueError
        When a crack, or a segment of one, beside others is so short that its ends are one place of the part.
    """
    found: list[tuple[complex, complex, int]] = []
    number = 0
    lines = [line[:, 0] + 1j * line[:, 1] for line in part.crack_lines]
    for crack, z in zip(part.cracks, lines, strict=True):
        if (np.diff(z) == 0).any():
            length = np.linalg.norm(np.diff(crack.points, axis=0), axis=1).min()
            raise ValueError(
                f"crack {crack.points.tolist()}: a segment of {length:.3g} mm is one place; it must be longer than "
                f"{part.tolerance:.3g} mm, below which lengths of the part count as zero"
            )
    times = Counter(point for z in lines for point in z.tolist())
    near = _Near.of(around, lines)
    for c, (crack, z) in enumerate(zip(part.cracks, lines, strict=True)):
        at_start = at_end = -1
        if crack.start == TIP:
            at_start, number = number, number + 1
        if crack.end == TIP:
            at_end, number = number, number + 1
        last = len(z) - 2
        step = np.diff(z)
        length = np.abs(step)
        shortest = at_mouth * length.sum()
        # at a kink or where cracks meet: as short as the shorter of both segments asks for
        turn = np.abs(np.angle(step[1:] / step[:-1]))
        alone = np.array([times[point] == 1 for point in z[1:-1].tolist()], dtype=bool)
        grade = np.select([~alone | (turn > SHARP), turn > MILD], [AT_SHARP, AT_KINK], 1.0)
        is_clear = near.is_clear(c)
        for k, (a, b) in enumerate(pairwise(z)):
            first_tip, last_tip = (at_start if k == 0 else -1), (at_end if k == last else -1)
            ends = (
                shortest / length[k] if k == 0 else grade[k - 1] * min(1.0, length[k - 1] / length[k]),
                shortest / length[k] if k == last else grade[k] * min(1.0, length[k + 1] / length[k]),
            )
            if max(first_tip, last_tip) < 0 and min(ends) > 1.0 - ROUND_OFF and is_clear[k]:
                found.append((a, b, -1))
            else:
                mouths = k == 0 and crack.start.kind == "surface", k == last and crack.end.kind == "surface"
                found += _segment(a, b, first_tip, last_tip, ends, mouths, near.to(c, k))
    starts, ends_of = (np.array([f[i] for f in found], dtype=complex) for i in (0, 1))
    tip = np.array([f[2] for f in found], dtype=int)
    x, _, _ = straight_rule(p)
    xt, _, _ = tip_rule(p)
    along = ends_of - starts
    z = np.where(
        (tip >= 0)[:, None],
        ends_of[:, None] - along[:, None] * xt**2,
        0.5 * (starts + ends_of)[:, None] + 0.5 * along[:, None] * x,
    )
    return CrackPanels(p, starts, ends_of, tip >= 0, tip, z.ravel())


class _Near(NamedTuple):
    """What cracks may come near: surfaces, other cracks, and themselves where they come back.

    Attributes
    ----------
    surfaces : ndarray, shape (k,)
        Samples, mm.
    starts, ends : ndarray, shape (m,)
        Of the segments of all cracks, mm.
    crack : ndarray, shape (m,) of int
    way : ndarray, shape (m,)
        Along the crack to where a segment begins, mm.
    """

    surfaces: Complex
    starts: Complex
    ends: Complex
    crack: NDArray[np.int64]
    way: Array

    @classmethod
    def of(cls, surfaces: Complex, lines: Sequence[Complex]) -> _Near:
        """Of cracks along lines (n,)."""
        lengths = [np.abs(np.diff(z)) for z in lines]
        return cls(
            surfaces,
            np.concatenate([z[:-1] for z in lines]),
            np.concatenate([z[1:] for z in lines]),
            np.repeat(np.arange(len(lines)), [len(length) for length in lengths]),
            np.concatenate([np.cumsum(length) - length for length in lengths]),
        )

    def is_clear(self, crack: int) -> NDArray[np.bool_]:
        """Whether segments (n,) of a crack may be one panel each as far as their distance from all else goes."""
        own = self.crack == crack
        size = np.abs(self.ends - self.starts)[own]
        to_surfaces, to_segments = self._gaps(own)
        near = (PER_DISTANCE * to_surfaces < size[:, None]).any(axis=1)
        return ~(near | (PER_CRACK * to_segments < size[:, None]).any(axis=1))

    def _gaps(self, own: NDArray[np.bool_]) -> tuple[Array, Array]:
        """How far segments (n,) are at least from surfaces and from all segments that are no continuation of theirs."""
        middle, length = 0.5 * (self.starts + self.ends), np.abs(self.ends - self.starts)
        z, size = middle[own], length[own, None]
        apart, halfway = np.abs(z[:, None] - middle), self.way + 0.5 * length
        same = own & (self.crack == self.crack[own][:, None])
        goes_on = same & (apart >= COMES_BACK * np.abs(halfway[own][:, None] - halfway))
        to_segments = np.where(goes_on, np.inf, apart - 0.5 * (size + length))
        return np.abs(z[:, None] - self.surfaces) - 0.5 * size, to_segments

    def to(self, crack: int, segment: int) -> _NearSegment:
        """Samples of all that may be near a segment of a crack."""
        k = np.flatnonzero(self.crack == crack)[segment]
        alone = np.arange(len(self.crack)) == k
        (to_surfaces,), (to_segments,) = self._gaps(alone)
        size = np.abs(self.ends - self.starts)
        reach = size[k] / min(PER_DISTANCE, PER_CRACK)
        near = (to_segments < reach) & ~alone
        share = np.linspace(0.0, 1.0, SAMPLES)
        z = self.starts[near, None] + share * (self.ends - self.starts)[near, None]
        way = self.way[near, None] + share * size[near, None]
        # the way to other cracks is endless
        way[self.crack[near] != crack] = np.inf
        return _NearSegment(
            self.surfaces[to_surfaces < reach], z.ravel(), way.ravel(), self.starts[k], self.way[k]
        )


class _NearSegment(NamedTuple):
    """Samples of surfaces and of cracks, with the way to them along its own, for a segment.

    That begins at ``start``, after ``begin`` of the way, mm.
    """

    surfaces: Complex
    cracks: Complex
    way: Array
    start: complex
    begin: float

    def longest(self, z: Complex, away: int = 0) -> float:
        """How long a panel through points z (k,) may be, mm; those before ``away`` may lie on a surface."""
        return float(_longest(z, away, self.surfaces, self.cracks, self.way, self.start, self.begin))


@njit(cache=True)
def _longest(z, away, surfaces, cracks, way, start, begin):
    """Kernel of `_NearSegment.longest`."""
    to_surfaces = to_cracks = np.inf
    for i in range(len(z)):
        x, y = z[i].real, z[i].imag
        if i >= away:
            for k in range(len(surfaces)):
                u, v = surfaces[k].real - x, surfaces[k].imag - y
                to_surfaces = min(to_surfaces, u * u + v * v)
        here = begin + abs(z[i] - start)
        for k in range(len(cracks)):
            u, v = cracks[k].real - x, cracks[k].imag - y
            gap = np.sqrt(u * u + v * v)
            # where two segments of a crack meet both are round-off
            if gap < COMES_BACK * abs(here - way[k]) - ROUND_OFF * here:
                to_cracks = min(to_cracks, gap)
    return min(PER_DISTANCE * np.sqrt(to_surfaces), PER_CRACK * to_cracks)


def _segment(
    a: complex,
    b: complex,
    first_tip: int,
    last_tip: int,
    ends: Sequence[float],
    mouths: tuple[bool, bool],
    near: _NearSegment,
) -> list[tuple[complex, complex, int]]:
    """Panels of a segment from a to b, which begins or ends at a mouth: start, end, and the tip at the end or -1."""
    length = abs(b - a)
    low, high = 0.0, 1.0
    panels: list[tuple[complex, complex, int]] = []
    if first_tip >= 0:
        low = _tip_share(a, b, ends[1] if last_tip < 0 else 0.0, near)
        panels.append((a + low * (b - a), a, first_tip))
    if last_tip >= 0:
        high = 1.0 - _tip_share(b, a, ends[0] if first_tip < 0 else 0.0, near)
        panels.append((a + high * (b - a), b, last_tip))
    first = ends[0] if first_tip < 0 else low
    last = ends[1] if last_tip < 0 else 1.0 - high
    # at a mouth the surface itself is near, and where cracks meet the other one: there their grades decide
    graded = [
        end for end, tip in zip(ends, (first_tip, last_tip), strict=True) if tip < 0 and end < 1.0 - ROUND_OFF
    ]
    least = min(graded, default=AT_KINK)
    todo = [(low, high)] if high > low else []
    while todo:
        u, v = todo.pop()
        z = a + ALONG * (v - u) * (b - a) + u * (b - a)
        # of a panel that ends at a mouth, how far from the surface its other end is
        at_mouth = mouths[0] and u == 0.0, mouths[1] and v == 1.0
        away = len(ALONG) - 1 if any(at_mouth) else 0
        longest = near.longest(z[::-1] if at_mouth[1] else z, away)
        allowed = min(max(u, first), max(1.0 - v, last), max(longest / length, least))
        if v - u > allowed * (1 + ROUND_OFF):
            todo += [(u, 0.5 * (u + v)), (0.5 * (u + v), v)]
        else:
            panels.append((a + u * (b - a), a + v * (b - a), -1))
    return panels


def _tip_share(tip: complex, other: complex, grade: float, near: _NearSegment) -> float:
    """Length of the panel at a tip over that of its segment, whose other end needs panels as short as ``grade``."""
    return min(1.0 if grade > 1.0 - ROUND_OFF else AT_TIP, near.longest(np.array([tip])) / abs(other - tip))
