"""Small elements where supports begin and end: stresses grow without bound there, as at corners of the material."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from slmm.fem.boundary import Piece, boundary_pieces
from slmm.fem.element_size import SizePolicy
from slmm.part.part import Part
from slmm.scene.loading import Loading
from slmm.scene.supports import Held, held_at, is_singular

#: share of a side over which the direction at its end is taken; round-off
SHORT = 1e-6


class _Side(NamedTuple):
    """A smooth part of the boundary between points where conditions may change."""

    start: np.ndarray
    first: complex
    last: complex
    length: float
    held: Held


def at_supports(
    part: Part, loading: Loading, policy: SizePolicy | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, 2) where supports leave stresses singular, and the element sizes (k,) wanted there, mm.

    The sizes are those at corners of the material, `SizePolicy.at_tips` of the shorter of both sides.

    Examples
    --------
    >>> from slmm.scene.loading import Affine, Condition
    >>> foot = Condition((2.0, 0.0), (8.0, 0.0), (Affine(), Affine()))
    >>> points, sizes = at_supports(Part.plate(20.0, 10.0), Loading((foot,)))
    >>> points.tolist(), sizes.tolist()
    ([[2.0, 0.0], [8.0, 0.0]], [0.002, 0.006])
    """
    share = (policy or SizePolicy()).at_tips
    points, sizes = [], []
    for ring in boundary_pieces(part.body, part.outlines, loading.ends):
        sides = [side for piece in ring for side in _sides(piece, part, loading)]
        for before, behind in zip([sides[-1], *sides[:-1]], sides, strict=True):
            turn = float(np.angle(behind.first / before.last))
            if is_singular(before.held, behind.held, turn):
                points.append(behind.start)
                sizes.append(share * min(before.length, behind.length))
    return np.array(points).reshape(-1, 2), np.array(sizes)


def _sides(piece: Piece, part: Part, loading: Loading) -> list[_Side]:
    """A piece, cut at its prescribed points."""
    sides = []
    for a, b in pairwise(piece.s):
        at = piece.points(a + np.array([0.0, SHORT, 0.5, 1 - SHORT, 1.0]) * (b - a), part.outlines)
        z = at[:, 0] + 1j * at[:, 1]
        held = held_at(loading, (float(at[2, 0]), float(at[2, 1])))
        sides.append(_Side(at[0], z[1] - z[0], z[4] - z[3], float(abs(b - a)), held))
    return sides
