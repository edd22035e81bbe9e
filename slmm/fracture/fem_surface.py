"""The closed curves around a part, by the way along them, and what a mesh knows below them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slmm.boundary.contour import Places
from slmm.fem.boundary import Piece, boundary_pieces
from slmm.fem.mesh import PlateMesh
from slmm.part.outline import Outline
from slmm.part.part import Part

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Ring:
    """A closed curve around a part, the body on its left, a `slmm.fracture.surface_peaks.Curve`.

    Parameters
    ----------
    pieces : sequence of Piece
        One behind the other.
    outlines : sequence of Outline
        The curves that pieces are part of.

    Examples
    --------
    >>> [edge] = rings(Part.plate(40.0, 60.0))
    >>> where = edge.at(np.array([10.0, 70.0]))
    >>> edge.length, where.points.tolist(), (where.inward + 0.0).round(9).tolist()
    (200.0, [[10.0, 0.0], [40.0, 30.0]], [[0.0, 1.0], [-1.0, 0.0]])
    """

    pieces: Sequence[Piece]
    outlines: Sequence[Outline]

    @cached_property
    def starts(self) -> Array:
        """Way (m + 1,) to where each piece begins, and the last one ends, mm."""
        return np.concatenate([[0.0], np.cumsum([abs(piece.s[-1] - piece.s[0]) for piece in self.pieces])])

    @property
    def length(self) -> float:
        """mm."""
        return float(self.starts[-1])

    def at(self, way: Array) -> Places:
        """Places after a way (k,) along the curve, mm, modulo its length."""
        way = np.mod(way, self.length)
        number = np.clip(np.searchsorted(self.starts, way, side="right") - 1, 0, len(self.pieces) - 1)
        points, inward = np.empty((len(way), 2)), np.empty((len(way), 2))
        for k in np.unique(number).tolist():
            here, piece = number == k, self.pieces[k]
            along = way[here] - self.starts[k]
            if piece.direction is not None:
                points[here] = piece.start + along[:, None] * piece.direction
                inward[here] = [-piece.direction[1], piece.direction[0]]
            else:
                outline, s = self.outlines[piece.outline], piece.s[0] - along
                points[here], inward[here] = outline.points(s), outline.normals(s)
        hole = np.array([piece.outline for piece in self.pieces])[number]
        return Places(points, inward, hole)

    def nodes(self, mesh: PlateMesh) -> Array:
        """Ways (n,) to the vertices of a mesh on the curve, and half way between them, mm."""
        ways = []
        for start, piece in zip(self.starts, self.pieces, strict=False):
            span = abs(piece.s[-1] - piece.s[0])
            if piece.direction is not None:
                from_start = mesh.vertices - piece.start
                x, y = piece.direction
                along = from_start @ piece.direction
                on = np.abs(from_start @ [-y, x]) <= 1e-9 * span
            else:
                s = mesh.edge_s[mesh.edge_outline == piece.outline].ravel()
                along = np.mod(piece.s[0] - s, self.outlines[piece.outline].length)
                on = np.ones(len(s), dtype=bool)
            ways.append(start + along[on & (along >= 0) & (along <= span)])
        way, same = np.concatenate(ways), 1e-9 * self.length
        way = np.sort(np.where(way > self.length - same, 0.0, way))
        way = way[np.diff(way, prepend=-self.length) > same]
        step = np.mod(np.roll(way, -1) - way, self.length)
        return np.sort(np.mod(np.concatenate([way, way + 0.5 * step]), self.length))


def rings(part: Part) -> list[Ring]:
    """The closed curves around a part; its cracks do not matter."""
    none = np.empty((0, 2))
    return [Ring(pieces, part.outlines) for pieces in boundary_pieces(part.body, part.outlines, none)]
