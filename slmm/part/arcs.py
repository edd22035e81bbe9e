"""Arcs at the tight bends between the stretches of a traced contour. All lengths are in pixels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.cubics import through
from slmm.part.vertices import Vertex

Array = NDArray[np.float64]

#: share of a stretch that the arcs at its ends may use up; chosen
CUT = 0.45
#: points of the arc at a tight bend; chosen
ARC_POINTS = 41


def with_arcs(
    stretches: Sequence[Array], corners: Sequence[Vertex | None]
) -> tuple[list[Array], list[Array | None]]:
    """The pieces of an outline, arcs at its tight bends among them, and the middle of the arc at each corner.

    ``corners[k]`` lies where ``stretches[k]`` begins.
    """
    pieces = list(stretches)
    lengths = [float(np.hypot(*np.diff(piece, axis=0).T).sum()) for piece in pieces]
    arcs: list[Array | None] = [None] * len(pieces)
    for k, vertex in enumerate(corners):
        if vertex is None or vertex.radius == 0.0:
            continue
        before = k - 1
        cut = vertex.radius * np.tan(abs(vertex.turn) / 2)
        cut = min(cut, CUT * lengths[before], CUT * lengths[k])
        pieces[before], end, arriving = _shortened(pieces[before][::-1], cut)
        pieces[before] = pieces[before][::-1]
        pieces[k], start, leaving = _shortened(pieces[k], cut)
        arcs[k] = _arc(end, -arriving, start, leaving)
    result: list[Array] = []
    for piece, arc in zip(pieces, arcs, strict=True):
        result += [piece] if arc is None else [arc, piece]
    return result, [None if arc is None else arc[len(arc) // 2] for arc in arcs]


def _shortened(piece: Array, cut: float) -> tuple[Array, Array, Array]:
    """A piece without its beginning, its new first point, and the tangent (2,) there."""
    if len(piece) == 2:
        tangent = (piece[1] - piece[0]) / np.hypot(*(piece[1] - piece[0]))
        start = piece[0] + cut * tangent
        return np.array([start, piece[1]]), start, tangent
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(piece, axis=0).T))])
    spline = through(along, piece)
    rest = piece[along > cut + 0.5 * (along[1] - along[0])]
    tangent = spline(cut, 1)
    return np.vstack([spline(cut), rest]), spline(cut), tangent / np.hypot(*tangent)


def _arc(start: Array, leaving: Array, end: Array, arriving: Array) -> Array:
    """Points (n, 2) of the curve between two points with given tangents, an arc when it is symmetric (Bezier)."""
    turn = np.arccos(np.clip(leaving @ arriving, -1, 1))
    handle = np.hypot(*(end - start)) / (3 * np.cos(turn / 4) ** 2)
    controls = np.array([start, start + handle * leaving, end - handle * arriving, end])
    t = np.linspace(0, 1, ARC_POINTS)[:, None]
    powers = np.hstack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
    points: Array = powers @ controls
    points[0], points[-1] = start, end
    return points
