"""Where an increment of a crack ends: in the material, or exactly on what it runs into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.part.chords import chords
from slmm.part.part import Part
from slmm.part.rays import Lines, distances_along

Array = NDArray[np.float64]

#: a tip ends where it would be nearer to a surface ahead than this share of the increment: 0.75 mm of 2 mm; published
#: (Paper D, the radius of its tubes)
LOOK_AHEAD = 0.375
#: and it breaks through to a surface beside it that is nearer than this share of the increment; chosen: what is left
#: is as thin as the point method looks deep
THIN = 0.06
#: a line begins on its own surface for so many of the part's tolerances; round-off of chords
BEGINS = 2.0


class Increment(NamedTuple):
    """A straight piece of a crack.

    Attributes
    ----------
    end : ndarray, shape (2,)
        mm.
    arrested : bool
        Whether it ends on a surface or on another crack.
    """

    end: Array
    arrested: bool


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Surfaces that stay while cracks grow.

    Parameters
    ----------
    part : Part
        Its cracks do not matter.
    """

    part: Part

    @cached_property
    def _lines(self) -> Lines:
        rings = [chords(outline) for outline in self.part.outlines]
        return Lines.of(rings if self.part.rim is not None else [*rings, self.part.outer], closed=True)

    @cached_property
    def _surface(self) -> shapely.Geometry:
        surface = self.part.body.boundary
        shapely.prepare(surface)
        return surface

    def room(self, cracks: Part, tip: Array, own: int) -> float:
        """Distance of a tip (2,) from surfaces and other cracks than its own, mm."""
        at = shapely.Point(tip)
        others = [crack.shape for k, crack in enumerate(cracks.cracks) if k != own]
        return min(float(shapely.distance(line, at)) for line in (self._surface, *others))

    def way(self, start: Array, direction: Array, cracks: Sequence[Array]) -> float:
        """Distance from a point (2,) to the next surface or crack in a direction (2,), mm."""
        begins = BEGINS * self.part.tolerance
        return min(
            float(distances_along(start[None], direction[None], lines, beyond=begins)[0])
            for lines in (self._lines, *([Lines.of(cracks)] if cracks else []))
        )

    def increment(
        self, cracks: Part, start: Array, direction: Array, length: float, ahead: float, own: int = -1
    ) -> Increment:
        """Where a crack ends that runs on straight.

        Parameters
        ----------
        cracks : Part
            The part as it is now.
        start, direction : ndarray, shape (2,)
            mm, and a unit vector.
        length, ahead : float
            Of the increment, and how far beyond its end a surface draws it, mm.
        own : int
            The crack that grows, which does not run into itself; -1 for a new one.
        """
        others = [crack for k, crack in enumerate(cracks.cracks) if k != own]
        way = self.way(start, direction, [crack.points for crack in others])
        if way <= length + ahead:
            return Increment(start + way * direction, True)
        end = start + length * direction
        at = shapely.Point(end)
        thin = THIN / LOOK_AHEAD * ahead
        for line in (self._surface, *(crack.shape for crack in others)):
            if shapely.dwithin(line, at, thin):
                return Increment(shapely.get_coordinates(line.interpolate(line.project(at)))[0], True)
        return Increment(end, False)
