"""A closed curve of panels by the way along it: points at a depth below its surface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.panels import Panels
from slmm.boundary.rules import Array, rule
from slmm.part.part import Part


class Places(NamedTuple):
    """Places on a surface.

    Attributes
    ----------
    points, inward : ndarray, shape (k, 2)
        mm, and unit normals into the body.
    hole : ndarray, shape (k,) of int
        Which of the part's outlines, -1 on a straight outer edge.
    """

    points: Array
    inward: Array
    hole: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Contour:
    """One of the closed curves around a part, the body on its left.

    Parameters
    ----------
    part : Part
    panels : Panels
    number : int
        Which of the closed curves.

    Examples
    --------
    >>> from slmm.boundary.body import Body
    >>> from slmm.mechanics.material import Material
    >>> from slmm.scene.loading import plate_loading
    >>> part = Part.plate(40.0, 60.0)
    >>> body = Body(part, Material.from_name("PMMA"), plate_loading(40.0, 60.0, stress=1.0), 4)
    >>> edge = Contour(part, body.panels, 0)
    >>> where = edge.at(np.array([0.3 * edge.length]))
    >>> edge.length, where.inward.round(9).tolist()
    (200.0, [[-1.0, 0.0]])
    """

    part: Part
    panels: Panels
    number: int

    @cached_property
    def rows(self) -> NDArray[np.int64]:
        """Its panels (m,), one behind the other."""
        return np.flatnonzero(self.panels.contour == self.number)

    @cached_property
    def starts(self) -> Array:
        """Way (m + 1,) to where each panel begins, and the last one ends, mm."""
        return np.concatenate([[0.0], np.cumsum(self.panels.length[self.rows])])

    @property
    def length(self) -> float:
        """mm."""
        return float(self.starts[-1])

    @property
    def nodes(self) -> NDArray[np.int64]:
        """Numbers (n,) of its points among those of all panels."""
        p = self.panels.p
        return (self.rows[:, None] * p + np.arange(p)).ravel()

    @property
    def way(self) -> Array:
        """Way (n,) to each of its points, mm."""
        x, _ = rule(self.panels.p)
        width = np.diff(self.starts)
        return (self.starts[:-1, None] + 0.5 * width[:, None] * (1 + x)).ravel()

    def at(self, way: Array) -> Places:
        """Places after a way (k,) along the curve, mm, modulo its length."""
        way = np.mod(way, self.length)
        k = np.clip(np.searchsorted(self.starts, way, side="right") - 1, 0, len(self.rows) - 1)
        share = (way - self.starts[k]) / np.diff(self.starts)[k]
        row = self.rows[k]
        a, b = self.panels.ends[row].T
        z = a + share * (b - a)
        tangent = (b - a) / np.abs(b - a)
        points, normals = np.column_stack([z.real, z.imag]), np.column_stack([-tangent.imag, tangent.real])
        hole = self.panels.hole[row]
        curved = ~self.panels.straight[row]
        for number in np.unique(hole[curved]):
            here = curved & (hole == number)
            first, last = self.panels.span[row[here]].T
            s = first + share[here] * (last - first)
            outline = self.part.outlines[number]
            points[here], normals[here] = outline.points(s), outline.normals(s)
        return Places(points, normals, hole)
