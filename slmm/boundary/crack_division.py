"""How straight segments of cracks are divided into panels: by what they end at, and by what they come near.

They may come near surfaces, other cracks, and themselves where they come back.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slmm.boundary.rules import Array, Complex

#: last panel before a kink, and the panel at a tip, over the segment's length (chosen on the cases of tests/boundary)
AT_KINK, AT_TIP = 0.02, 0.4
#: a panel over its distance from surfaces, and from other cracks, whose tips make stresses vary most (chosen likewise)
PER_DISTANCE, PER_CRACK = 1.5, 0.75
#: a crack is near itself where it comes back: where points are apart by less than this share of the way between them
#: (chosen; of a half circle's ends it is 0.64)
COMES_BACK = 0.5
#: samples of a segment that tell how near it is, over it, and of a panel (chosen)
SHARES, OF_PANEL = np.linspace(0.0, 1.0, 100), np.linspace(0.0, 1.0, 5)
#: of lengths of segments that are equal but for rounding
ROUND_OFF = 1e-6
#: halvings of a segment, at most: beyond, panels are as short as points of it are apart; round-off
HALVINGS = 60


class Segments(NamedTuple):
    """Straight segments of cracks, one behind the other.

    Attributes
    ----------
    starts, ends : ndarray, shape (m,)
        mm.
    crack : ndarray, shape (m,) of int
    way : ndarray, shape (m,)
        Along the crack to where a segment begins, mm.
    tips : ndarray, shape (m, 2) of int
        The tip at its start and at its end, -1 for none.
    mouths : ndarray, shape (m, 2) of bool
        Whether its start and its end lie on a surface.
    grades : ndarray, shape (m, 2)
        Its last panel before its start and its end, where these are no tips, over its length.
    """

    starts: Complex
    ends: Complex
    crack: NDArray[np.int64]
    way: Array
    tips: NDArray[np.int64]
    mouths: NDArray[np.bool_]
    grades: Array


def divided(segments: Segments, surfaces: Complex) -> tuple[Complex, Complex, NDArray[np.int64]]:
    """Where panels start (n,) and end (n,), mm, and the tip (n,) at that end, -1 for none.

    Parameters
    ----------
    segments : Segments
    surfaces : ndarray, shape (k,)
        Samples of the part's surfaces, mm.

    Examples
    --------
    >>> a, b = np.array([[0j], [8.0]])
    >>> tip, mouth = np.array([[-1, 0]]), np.array([[False, False]])
    >>> segment = Segments(a, b, np.zeros(1, int), np.zeros(1), tip, mouth, np.ones((1, 2)))
    >>> starts, ends, tip = divided(segment, np.array([10.0 + 0j]))
    >>> starts.real.tolist(), ends.real.tolist(), tip.tolist()
    ([5.0, 2.5, 0.0], [8.0, 5.0, 2.5], [0, -1, -1])
    """
    (starts, ends), tip = _panels(*segments, surfaces, SHARES, OF_PANEL)
    return starts, ends, tip


@njit(cache=True)
def _panels(starts, ends, crack, way, tips, mouths, grades, surfaces, shares, of_panel):
    """Kernel of `divided`: start and end (2, n), and tip (n,)."""
    m, samples = len(starts), len(shares)
    found = [(a, a, 0) for a in starts[:0]]
    near_surfaces, near_cracks = np.empty_like(surfaces), np.empty(m * samples, dtype=np.complex128)
    ways, todo = np.empty(m * samples), np.empty((HALVINGS + 2, 2))
    for k in range(m):
        a, along = starts[k], ends[k] - starts[k]
        length = abs(along)
        few, many = _near(k, starts, ends, crack, way, surfaces, shares, near_surfaces, near_cracks, ways)
        near = near_surfaces[:few], near_cracks[:many], ways[:many], a, way[k], ROUND_OFF * length
        low, high = 0.0, 1.0
        first, last = grades[k]
        if tips[k, 0] >= 0:
            low = _tip_share(starts[k], length, grades[k, 1] if tips[k, 1] < 0 else 0.0, near)
            first = low
            found.append((a + low * along, a, tips[k, 0]))
        if tips[k, 1] >= 0:
            high = 1.0 - _tip_share(ends[k], length, grades[k, 0] if tips[k, 0] < 0 else 0.0, near)
            last = 1.0 - high
            found.append((a + high * along, ends[k], tips[k, 1]))
        # at a mouth the surface itself is near, and where cracks meet the other one: there their grades decide
        least = np.inf
        for end in range(2):
            if tips[k, end] < 0 and grades[k, end] < 1.0 - ROUND_OFF:
                least = min(least, grades[k, end])
        if least == np.inf:
            least = AT_KINK
        waiting = 1 if high > low else 0
        todo[0] = low, high
        while waiting:
            waiting -= 1
            u, v = todo[waiting]
            # of a panel that ends at a mouth, how far from the surface its other end is
            seen = -1
            if mouths[k, 0] and u == 0.0:
                seen = len(of_panel) - 1
            elif mouths[k, 1] and v == 1.0:
                seen = 0
            longest = _longest(a + (u + (v - u) * of_panel) * along, near, seen)
            allowed = min(max(u, first), max(1.0 - v, last), max(longest / length, least))
            if v - u > allowed * (1 + ROUND_OFF) and waiting < HALVINGS:
                todo[waiting] = u, 0.5 * (u + v)
                todo[waiting + 1] = 0.5 * (u + v), v
                waiting += 2
                continue
            found.append((a + u * along, a + v * along, -1))
    panels, tip = np.empty((2, len(found)), dtype=np.complex128), np.empty(len(found), dtype=np.int64)
    for n, (start, end, number) in enumerate(found):
        panels[0, n], panels[1, n], tip[n] = start, end, number
    return panels, tip


@njit(cache=True)
def _near(k, starts, ends, crack, way, surfaces, shares, near_surfaces, near_cracks, ways):
    """How many samples of surfaces and of other segments may be near a segment, with the way to these, which it fills.

    Segments of its own crack that go on from it are not among them.
    """
    middle, size = 0.5 * (starts[k] + ends[k]), abs(ends[k] - starts[k])
    reach, few, many = size / min(PER_DISTANCE, PER_CRACK), 0, 0
    for z in surfaces:
        u, v = z.real - middle.real, z.imag - middle.imag
        if u * u + v * v < (reach + 0.5 * size) ** 2:
            near_surfaces[few] = z
            few += 1
    low, high = _going_on(k, starts, ends, crack)
    for j in range(len(starts)):
        along = ends[j] - starts[j]
        length, same = abs(along), crack[j] == crack[k]
        apart = abs(0.5 * (starts[j] + ends[j]) - middle)
        if low <= j < high or apart - 0.5 * (size + length) >= reach:
            continue
        for share in shares:
            near_cracks[many] = starts[j] + share * along
            # the way to other cracks is endless
            ways[many] = way[j] + share * length if same else np.inf
            many += 1
    return few, many


@njit(cache=True)
def _going_on(k, starts, ends, crack):
    """From and up to which segment a crack goes on in about the direction of one: of these none comes back to it.

    Along such a stretch two points are apart by the cosine of the largest turn at least, over the way between them.
    """
    along, found = ends[k] - starts[k], np.array([k, k])
    for side, step in enumerate((-1, 1)):
        j = k
        while 0 <= j < len(starts) and crack[j] == crack[k]:
            turn = (ends[j] - starts[j]) * along.conjugate()
            if turn.real < COMES_BACK * abs(turn):
                break
            found[side] = j
            j += step
    return found[0], found[1] + 1


@njit(cache=True)
def _longest(z, near, seen):
    """How long a panel through points z (k,) of a segment may be by what is near, mm.

    Surfaces count at one of the points alone, unless ``seen`` is -1.
    """
    # ways that differ by less are the same but for rounding, as on both sides of a kink
    surfaces, cracks, ways, start, begin, same = near
    to_surfaces = to_cracks = np.inf
    for i in range(len(z)):
        x, y = z[i].real, z[i].imag
        if seen < 0 or i == seen:
            for k in range(len(surfaces)):
                u, v = surfaces[k].real - x, surfaces[k].imag - y
                to_surfaces = min(to_surfaces, u * u + v * v)
        here = begin + abs(z[i] - start)
        for k in range(len(cracks)):
            u, v = cracks[k].real - x, cracks[k].imag - y
            away = np.sqrt(u * u + v * v)
            if away < COMES_BACK * (abs(here - ways[k]) - same):
                to_cracks = min(to_cracks, away)
    return min(PER_DISTANCE * np.sqrt(to_surfaces), PER_CRACK * to_cracks)


@njit(cache=True)
def _tip_share(tip, length, grade, near):
    """Length of the panel at a tip over that of its segment, whose other end needs panels as short as ``grade``."""
    longest = _longest(np.array([tip]), near, -1)
    return min(1.0 if grade > 1.0 - ROUND_OFF else AT_TIP, longest / length)
