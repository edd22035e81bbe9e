"""Small elements where supports begin and end, and where the stress along the surface is finite but not smooth.

Stresses grow without bound at the ends of supports, as at corners of the material. Where tractions change they have a
jump or a kink, and in corners that jut out by less than a right angle they fall to nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from slmm.fem.boundary import Piece, boundary_pieces
from slmm.fem.element_size import SizePolicy
from slmm.part.outline import SMALLEST_TURN
from slmm.part.part import Part
from slmm.scene.loading import Loading
from slmm.scene.supports import Held, held_at, is_singular

#: share of a side over which the direction at its end is taken; round-off
SHORT = 1e-6
#: places before and behind the end of a side where tractions are compared, over the shorter of both sides, and by what
#: they are off a straight line at a jump or a kink, over the largest there: around a hole they are off by 1e-4, where
#: they begin to rise over a side by 2e-3 and more; both chosen
PLACES, UNSMOOTH = 1e-3, 1e-3


class _Side(NamedTuple):
    """A smooth part of the boundary between points where conditions may change."""

    piece: Piece
    s: tuple[float, float]
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

    def wanted(before: _Side, behind: _Side) -> bool:
        return is_singular(before.held, behind.held, _turn(before, behind))

    return _where(part, loading, share, wanted)


def at_unsmooth_stress(
    part: Part, loading: Loading, policy: SizePolicy | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, 2) where the surface's stress is finite but not smooth, and the element sizes (k,) wanted there, mm.

    Tractions have a jump or a kink there while the surface goes straight on, or it juts out by less than a right angle,
    where the stress falls to nothing with a low power of the distance. The energy of the part hardly depends on the
    elements there; stresses recovered from patches of them do. The sizes are `SizePolicy.at_kinks` of the shorter side.

    Examples
    --------
    >>> from slmm.scene.loading import Condition
    >>> foot, top = Condition((2.0, 0.0), (8.0, 0.0), pressure=1.0), Condition((20.0, 9.0), (0.0, 9.0), pressure=0.3)
    >>> at_unsmooth_stress(Part.plate(20.0, 9.0), Loading((foot, top)))[0].tolist()
    [[2.0, 0.0], [8.0, 0.0]]
    """
    share = (policy or SizePolicy()).at_kinks

    def wanted(before: _Side, behind: _Side) -> bool:
        turn = _turn(before, behind)
        if SMALLEST_TURN < turn < 0.5 * np.pi - SMALLEST_TURN:
            return True
        return abs(turn) < SMALLEST_TURN and _tractions_change(before, behind, part, loading)

    return _where(part, loading, share, wanted)


def _where(
    part: Part, loading: Loading, share: float, wanted: Callable[[_Side, _Side], bool]
) -> tuple[np.ndarray, np.ndarray]:
    """Ends of sides (k, 2) that are wanted, and shares (k,) of the shorter side that meets there, mm."""
    points, sizes = [], []
    for ring in boundary_pieces(part.body, part.outlines, loading.ends):
        sides = [side for piece in ring for side in _sides(piece, part, loading)]
        for before, behind in zip([sides[-1], *sides[:-1]], sides, strict=True):
            if wanted(before, behind):
                points.append(behind.start)
                sizes.append(share * min(before.length, behind.length))
    return np.array(points).reshape(-1, 2), np.array(sizes)


def _turn(before: _Side, behind: _Side) -> float:
    """By which the surface turns between two sides, rad, positive where it juts out."""
    return float(np.angle(behind.first / before.last))


def _tractions_change(before: _Side, behind: _Side, part: Part, loading: Loading) -> bool:
    """Whether tractions have a jump or a kink between two sides."""
    step = PLACES * min(before.length, behind.length)
    a, b = before.s[1], behind.s[0]
    back, on = np.sign(before.s[0] - a) * step, np.sign(behind.s[1] - b) * step
    at = np.concatenate(
        [
            before.piece.points(np.array([a + 2 * back, a + back]), part.outlines),
            behind.piece.points(np.array([b + on, b + 2 * on]), part.outlines),
        ]
    )
    acts = np.zeros((4, 2))
    for condition in loading:
        here = condition.on(at)
        if condition.is_loaded and here.any():
            acts[here] += condition.tractions(at[here], condition.outward(at[here]))
    # each pair of places is extended by the two steps to the nearer one of the other pair
    expected = acts[1] + 2 * (acts[1] - acts[0]), acts[2] + 2 * (acts[2] - acts[3])
    off = max(np.abs(expected[0] - acts[2]).max(), np.abs(expected[1] - acts[1]).max())
    return bool(off > UNSMOOTH * np.abs(acts).max())


def _sides(piece: Piece, part: Part, loading: Loading) -> list[_Side]:
    """A piece, cut at its prescribed points."""
    sides = []
    for a, b in pairwise(piece.s):
        at = piece.points(a + np.array([0.0, SHORT, 0.5, 1 - SHORT, 1.0]) * (b - a), part.outlines)
        z = at[:, 0] + 1j * at[:, 1]
        held = held_at(loading, (float(at[2, 0]), float(at[2, 1])))
        sides.append(
            _Side(piece, (float(a), float(b)), at[0], z[1] - z[0], z[4] - z[3], float(abs(b - a)), held)
        )
    return sides
