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
#: a panel over its distance from surfaces and next segments, and from others, whose tips make stresses vary most
#: (chosen likewise)
PER_DISTANCE, PER_CRACK = 1.5, 0.75
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
    """
    found: list[tuple[complex, complex, int]] = []
    number = 0
    lines = [line[:, 0] + 1j * line[:, 1] for line in part.crack_lines]
    times = Counter(point for z in lines for point in z.tolist())
    # of each segment, so that one that is folded back is near, too
    samples = [[_sampled(a, b) for a, b in pairwise(z.tolist())] for z in lines]
    for c, (crack, z) in enumerate(zip(part.cracks, lines, strict=True)):
        others = [piece for k, own in enumerate(samples) if k != c for piece in own]
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
        for k, (a, b) in enumerate(pairwise(z)):
            first_tip, last_tip = (at_start if k == 0 else -1), (at_end if k == last else -1)
            ends = (
                shortest / length[k] if k == 0 else grade[k - 1] * min(1.0, length[k - 1] / length[k]),
                shortest / length[k] if k == last else grade[k] * min(1.0, length[k + 1] / length[k]),
            )
            if max(first_tip, last_tip) < 0 and min(ends) > 1.0 - ROUND_OFF:
                found.append((a, b, -1))
                continue
            # the next segments have their kink in common, whose grade takes care
            next_to = [piece for i, piece in enumerate(samples[c]) if abs(i - k) == 1]
            apart = others + [piece for i, piece in enumerate(samples[c]) if abs(i - k) > 1]
            near = _Near(np.concatenate([around, *next_to]), np.array(apart, dtype=complex).ravel())
            found += _segment(a, b, first_tip, last_tip, ends, near)
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
    """Samples of what is around a segment: surfaces and the segments next to it, and all others."""

    surfaces: Complex
    cracks: Complex

    def longest(self, z: Complex) -> float:
        """How long a panel through points z (k,) may be, mm."""
        return min(
            share * _nearest(z, those)
            for share, those in ((PER_DISTANCE, self.surfaces), (PER_CRACK, self.cracks))
            if len(those)
        )


@njit(cache=True)
def _nearest(z, those):
    """The least distance of points (k,) from others (n,)."""
    least = np.inf
    for i in range(len(z)):
        for k in range(len(those)):
            x, y = z[i].real - those[k].real, z[i].imag - those[k].imag
            least = min(least, x * x + y * y)
    return np.sqrt(least)


def _segment(
    a: complex, b: complex, first_tip: int, last_tip: int, ends: Sequence[float], near: _Near
) -> list[tuple[complex, complex, int]]:
    """Panels of a segment from a to b: start, end, and the tip at the end or -1."""
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
    todo = [(low, high)] if high > low else []
    while todo:
        u, v = todo.pop()
        z = a + np.linspace(u, v, 5) * (b - a)
        # at a mouth the surface itself is near
        allowed = min(max(u, first), max(1.0 - v, last), max(near.longest(z) / length, min(first, last)))
        if v - u > allowed * (1 + ROUND_OFF):
            todo += [(u, 0.5 * (u + v)), (0.5 * (u + v), v)]
        else:
            panels.append((a + u * (b - a), a + v * (b - a), -1))
    return panels


def _tip_share(tip: complex, other: complex, grade: float, near: _Near) -> float:
    """Length of the panel at a tip over that of its segment, whose other end needs panels as short as ``grade``."""
    return min(1.0 if grade > 1.0 - ROUND_OFF else AT_TIP, near.longest(np.array([tip])) / abs(other - tip))


@lru_cache(maxsize=1024)
def _sampled(a: complex, b: complex) -> Complex:
    """Points along a segment; segments stay while cracks grow."""
    return a + np.linspace(0.0, 1.0, 100) * (b - a)
