"""A span of an outline: what a support or a load acts on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from slmm.part.outline import Outline

Array = NDArray[np.float64]

#: points as near to a span lie on it, as a share of the outline's length; round-off
ON_SPAN = 1e-9
#: samples of a span between which its surface runs along a direction at most once (chosen)
SAMPLES = 401
#: Gauss points on each piece of an outline, for integrals along a span (chosen: exact to the seventh power)
GAUSS_POINTS = 4


@dataclass(frozen=True, eq=False)
class Span:
    """Part of an outline, or all of it, with the body on the left.

    Parameters
    ----------
    outline : Outline
        With the material on its right.
    first, last : float
        Arc lengths at its ends, mm; it is followed down from the first one to the last.

    Examples
    --------
    >>> from slmm.part.shapes import circle
    >>> hole = Outline.through(circle((0, 0), 10.0))
    >>> quarter = Span(hole, hole.length / 4, 0.0)
    >>> quarter.points(np.array([0.0, 1.0])).round(6).tolist()
    [[0.0, 10.0], [10.0, 0.0]]
    >>> quarter.holds(np.array([[10.0, 0.0], [-10.0, 0.0], [7.0, 7.0]])).tolist()
    [True, False, False]
    """

    outline: Outline
    first: float
    last: float

    @property
    def length(self) -> float:
        """mm."""
        return self.first - self.last

    def points(self, share: Array) -> Array:
        """Points (n, 2) at shares (n,) of its length, mm."""
        return self.outline.points(self.first - share * self.length)

    def share(self, points: Array) -> Array:
        """Shares (n,) of its length at points (n, 2) of it; those beside an end by round-off are at that end."""
        around, length = self.outline.length, self.length
        beside = 0.5 * (around - length)
        down = (self.first - self.outline.project(points) + beside) % around - beside
        return np.clip(down / length, 0.0, 1.0)

    def holds(self, points: Array) -> NDArray[np.bool_]:
        """Which points (n, 2) lie on it."""
        near = ON_SPAN * self.outline.length
        low, high = self.outline.box
        inside = np.flatnonzero(((points >= low - near) & (points <= high + near)).all(axis=1))
        found = np.zeros(len(points), dtype=bool)
        if len(inside):
            s = self.outline.project(points[inside])
            away = np.linalg.norm(self.outline.points(s) - points[inside], axis=1)
            back = (self.first - s) % self.outline.length
            back = np.where(
                back > self.outline.length - near, 0.0, back
            )  # before the first point, by round-off
            found[inside] = (away <= near) & (back <= self.length + near)
        return found

    def overlap(self, other: Span) -> float:
        """Length, mm, that two spans of one outline have in common.

        Examples
        --------
        >>> from slmm.part.shapes import circle
        >>> hole = Outline.through(circle((0, 0), 10.0))
        >>> round(Span(hole, 5.0, -5.0).overlap(Span(hole, hole.length - 2.0, 20.0)), 6)
        3.0
        """
        around = self.outline.length
        low, other_low = self.last % around, other.last % around
        common = [
            min(low + self.length, other_low + turn * around + other.length)
            - max(low, other_low + turn * around)
            for turn in (-1, 0, 1)
        ]
        return float(sum(max(length, 0.0) for length in common))

    def outward(self, points: Array) -> Array:
        """Unit normals (n, 2) out of the body at points (n, 2) of the span."""
        s = self.outline.project(points)
        return -self.outline.normals(s)

    @property
    def corners(self) -> Array:
        """Shares (k,) of its length at which the outline has corners."""
        share = ((self.first - self.outline.corners) % self.outline.length) / self.length
        return share[share < 1]

    def square_to(self, direction: Array) -> Array:
        """Points (k, 2) between its ends where the surface runs along a direction (2,)."""
        from scipy.optimize import brentq  # few parts need it, and it takes long to load

        s = np.linspace(self.first, self.last, SAMPLES)
        across = self.outline.normals(s) @ direction
        found = [
            float(brentq(lambda at: float(self.outline.normals(at) @ direction), s[k], s[k + 1], xtol=1e-13))
            for k in np.flatnonzero(across[:-1] * across[1:] < 0)
        ]
        return self.outline.points(np.array(found))

    @cached_property
    def rule(self) -> tuple[Array, Array, Array]:
        """Points (n, 2), normals (n, 2) out of the body and weights (n,), mm, for integrals along the span."""
        breaks = self.outline.breaks
        down = (self.first - breaks) % self.outline.length
        ends = np.unique(np.concatenate([[0.0], down[down < self.length], [self.length]]))
        x, w = leggauss(GAUSS_POINTS)
        half = 0.5 * np.diff(ends)
        s = self.first - (0.5 * (ends[1:] + ends[:-1])[:, None] + half[:, None] * x).ravel()
        return self.outline.points(s), -self.outline.normals(s), (half[:, None] * w).ravel()
