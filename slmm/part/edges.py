"""Where a plate's edges have material left, between the notches that cut them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Edges(NamedTuple):
    """Stretches of material on the edges of a plate, each (k, 2): from and to along the edge, mm, ascending.

    Attributes
    ----------
    bottom, top : ndarray (k, 2)
        Over x.
    left, right : ndarray (k, 2)
        Over y.
    """

    bottom: Array
    top: Array
    left: Array
    right: Array


def material_on_edges(holes: Sequence[shapely.Polygon], width: float, height: float) -> Edges:
    """The stretches of the edges that no hole covers.

    Examples
    --------
    >>> notch = shapely.box(2.0, -1.0, 3.0, 1.0)
    >>> material_on_edges([notch], 10.0, 5.0).bottom.tolist()
    [[0.0, 2.0], [3.0, 10.0]]
    """
    sides = {
        "bottom": ([(0.0, 0.0), (width, 0.0)], 0),
        "top": ([(0.0, height), (width, height)], 0),
        "left": ([(0.0, 0.0), (0.0, height)], 1),
        "right": ([(width, 0.0), (width, height)], 1),
    }
    stretches = {}
    for name, (ends, axis) in sides.items():
        edge = shapely.LineString(ends)
        cutting = [hole for hole in holes if hole.intersects(edge)]
        rest = edge.difference(shapely.union_all(cutting)) if cutting else edge
        lines = [
            part for part in shapely.get_parts(rest) if part.geom_type == "LineString" and part.length > 0
        ]
        ordered = sorted(sorted(point[axis] for point in line.coords) for line in lines)
        stretches[name] = np.array([(line[0], line[-1]) for line in ordered], dtype=float).reshape(-1, 2)
    return Edges(**stretches)


def share_of_pieces(stretches: Array, length: float, pieces: int) -> Array:
    """Share (pieces,) of equal pieces of an edge that stretches (k, 2) cover.

    Examples
    --------
    >>> share_of_pieces(np.array([[0.0, 2.0], [3.0, 10.0]]), 10.0, 4).tolist()
    [0.8, 0.8, 1.0, 1.0]
    """
    ends = np.linspace(0.0, length, pieces + 1)
    covered = np.clip(ends[:, None], stretches[:, 0], stretches[:, 1]) - stretches[:, 0]
    return np.diff(covered.sum(axis=1)) * (pieces / length)
