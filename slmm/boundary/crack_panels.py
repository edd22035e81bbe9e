"""Panels along cracks: straight, graded towards mouths and kinks, with the root of the distance built in at tips."""

from __future__ import annotations

from collections import Counter
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from slmm.boundary.crack_division import AT_KINK, Segments, divided
from slmm.boundary.rules import Array, Complex, rule
from slmm.part.crack import TIP
from slmm.part.part import Part

#: kinks that turn by less need no shorter panels than the segments are, rad: K stays within 1e-4 (chosen)
MILD = 0.35
#: kinks that turn by more, rad, and meetings of cracks need panels so short (chosen on 30 random plates)
SHARP, AT_SHARP = 0.8, 2e-4


class CrackPanels(NamedTuple):
    """Straight panels; one that ``is_tip`` ends at a tip, and these come last.

    Attributes
    ----------
    p : int
        Points on each panel.
    starts, ends : ndarray, shape (m,)
        mm.
    is_tip : ndarray, shape (m,) of bool
    tip : ndarray, shape (m,) of int
        Which tip of the part it leads to, -1 for none.
    direction : ndarray, shape (m,)
        Unit vectors.
    z : ndarray, shape (m p,)
        Points, mm.
    """

    p: int
    starts: Complex
    ends: Complex
    is_tip: NDArray[np.bool_]
    tip: NDArray[np.int64]
    direction: Complex
    z: Complex

    @classmethod
    def between(cls, starts: Complex, ends: Complex, tip: NDArray[np.int64], p: int) -> CrackPanels:
        """Panels of p points from starts (m,) to ends (m,), mm, and the tip (m,) that each leads to, -1 for none."""
        order = np.argsort(tip >= 0, kind="stable")
        starts, ends, tip = starts[order], ends[order], tip[order]
        along, others = ends - starts, np.count_nonzero(tip < 0)
        straight = 0.5 * (starts + ends)[:others, None] + 0.5 * along[:others, None] * straight_rule(p)[0]
        at_tip = ends[others:, None] - along[others:, None] * tip_rule(p)[0] ** 2
        z = np.concatenate([straight.ravel(), at_tip.ravel()])
        return cls(p, starts, ends, tip >= 0, tip, along / np.abs(along), z)

    def chosen(self, rows: NDArray[np.int64]) -> CrackPanels:
        """Some of them, in their order."""
        z = self.z.reshape(-1, self.p)[rows].ravel()
        return CrackPanels(
            self.p,
            self.starts[rows],
            self.ends[rows],
            self.is_tip[rows],
            self.tip[rows],
            self.direction[rows],
            z,
        )


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
    return CrackPanels.between(*divided(_segments(part, at_mouth), around), p)


def _segments(part: Part, at_mouth: float) -> Segments:
    """The straight segments of all cracks, with how short panels are at their ends."""
    lines = [line[:, 0] + 1j * line[:, 1] for line in part.crack_lines]
    for crack, z in zip(part.cracks, lines, strict=True):
        if (np.diff(z) == 0).any():
            length = np.linalg.norm(np.diff(crack.points, axis=0), axis=1).min()
            raise ValueError(
                f"crack {crack.points.tolist()}: a segment of {length:.3g} mm is one place; it must be longer than "
                f"{part.tolerance:.3g} mm, below which lengths of the part count as zero"
            )
    times = Counter(point for z in lines for point in z.tolist())
    m = sum(len(z) - 1 for z in lines)
    starts, ends, way = np.empty(m, dtype=complex), np.empty(m, dtype=complex), np.empty(m)
    number, tips, grades = np.empty(m, dtype=int), np.full((m, 2), -1), np.empty((m, 2))
    mouths = np.zeros((m, 2), dtype=bool)
    first, tip = 0, 0
    for c, (crack, z) in enumerate(zip(part.cracks, lines, strict=True)):
        its = slice(first, first + len(z) - 1)
        step = np.diff(z)
        length = np.abs(step)
        for k, end, place in ((0, crack.start, first), (1, crack.end, its.stop - 1)):
            mouths[place, k] = end.kind == "surface"
            if end == TIP:
                tips[place, k], tip = tip, tip + 1
        # at a kink or where cracks meet: as short as the shorter of both segments asks for
        turn = np.abs(np.angle(step[1:] / step[:-1]))
        alone = np.array([times[point] == 1 for point in z[1:-1].tolist()], dtype=bool)
        grade = np.where(~alone | (turn > SHARP), AT_SHARP, np.where(turn > MILD, AT_KINK, 1.0))
        shortest = at_mouth * length.sum()
        grades[first, 0], grades[its.stop - 1, 1] = shortest / length[0], shortest / length[-1]
        grades[first + 1 : its.stop, 0] = grade * np.minimum(1.0, length[:-1] / length[1:])
        grades[first : its.stop - 1, 1] = grade * np.minimum(1.0, length[1:] / length[:-1])
        starts[its], ends[its], number[its] = z[:-1], z[1:], c
        way[its] = np.cumsum(length) - length
        first = its.stop
    return Segments(starts, ends, number, way, tips, mouths, grades)
