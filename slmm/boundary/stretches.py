"""The closed curves around a part, as smooth stretches that tell how far panels shrink towards their ends."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from slmm.boundary.rules import Array, Complex
from slmm.fem.boundary import Piece, boundary_pieces
from slmm.part.outline import AT_CORNER, SMALLEST_TURN, Outline
from slmm.part.outline_splines import curvature_jumps
from slmm.part.part import Part
from slmm.scene.loading import Condition, Loading
from slmm.scene.supports import held_at, is_singular

#: the last panel before a corner that juts out, and one that points into the material, over the length of the side:
#: solutions are rougher there by turns (chosen on the cases of tests/boundary); of mouths see `Grading`
JUTTING, REENTRANT = 0.25, 1e-5
#: the same where tractions change on a straight edge, where a support ends on one, and at a corner between a held side
#: and a free one: stresses have a jump, grow with r^-1/2, and with r^-0.3 (chosen)
CHANGE, SUPPORT, HELD = 0.05, 1e-5, 1e-3
#: points of a curve that tell whether it is straight (chosen), and how far these may lie beside it, over its length
STRAIGHT_SAMPLES, ROUND_OFF = 7, 1e-13
#: a bend so much sharper than beside it has to be seen, unless it turns the curve by less than so many rad from one
#: sample to the next; both chosen
UNSEEN, SEEN = 1.5, 0.1


class Grading(NamedTuple):
    """How short panels are.

    Attributes
    ----------
    side : float
        The last one on a surface before the mouth of a crack, over the length of the side.
    crack : float
        And on the crack, over its length.
    radius : float
        On a curve, over its smallest radius of curvature there.
    distance, tip : float
        Over the distance from other surfaces, and from crack tips.
    """

    side: float
    crack: float
    radius: float
    distance: float
    tip: float


#: for stress intensities of cracks as short as they may be (chosen on the cases of tests/boundary)
FINE = Grading(0.01, 0.01, 0.6, 1.0, 1.0)
#: for stiffness and tips away from mouths: solutions are smooth enough (chosen on validation/fracture_references.py)
COARSE = Grading(0.1, 0.2, 0.8, 1.5, 2.0)
#: for U_T to some thousandths: of 40 random patterns of 5 x 5 to 8 x 8 points it is within 4.3e-3, in the median 3e-4,
#: of that of order 8; with panels half as long at mouths and tips within the same, in the median 2e-4. With twice as
#: long ones of cracks at their mouths, one step of 38,000 made a plate 7 % stiffer (all chosen on these)
ROUGH = COARSE._replace(side=0.4, tip=5.0)


class Stretch(NamedTuple):
    """A smooth curve of the boundary, the body on its left.

    Attributes
    ----------
    start, end : complex
        Its ends, mm.
    outline : Outline or None
        None for a straight one.
    hole : int
        Which of the part's outlines, -1 for a straight one.
    s : (float, float)
        Arc lengths on the outline, mm, descending.
    last : (float, float)
        Length of the last panel before either end over that of the curve.
    closed : bool
        A whole outline.
    """

    start: complex
    end: complex
    outline: Outline | None = None
    hole: int = -1
    s: tuple[float, float] = (0.0, 0.0)
    last: tuple[float, float] = (JUTTING, JUTTING)
    closed: bool = False

    @property
    def length(self) -> float:
        """mm."""
        return abs(self.end - self.start) if self.outline is None else self.s[0] - self.s[1]

    def points(self, share: Array) -> Complex:
        """Points (n,) at shares (n,) of the length."""
        if self.outline is None:
            return np.asarray(self.start + share * (self.end - self.start))
        x, y = self.outline.points(self.s[0] - share * self.length).T
        return np.asarray(x + 1j * y)

    def shares(self, n: int) -> Array:
        """Shares of the length from 0 to 1: n even steps, and more where these do not see how sharply it bends."""
        even = np.linspace(0.0, 1.0, n + 1)
        if self.outline is None:
            return even
        inside = np.sort((self.s[0] - self.outline.breaks[:-1]) % self.outline.length / self.length)
        inside = inside[inside < 1.0]
        seen, bend = (np.abs(self.outline.curvatures(self.s[0] - at * self.length)) for at in (even, inside))
        step = np.clip((inside * n).astype(int), 0, n - 1)
        unseen = bend > np.maximum(UNSEEN * np.maximum(seen[step], seen[step + 1]), SEEN * n / self.length)
        return np.unique(np.concatenate([even, inside[unseen]]))

    def at(self, share: Array) -> tuple[Complex, Complex, Array]:
        """Points (n,), tangents (n,) and curvatures (n,), positive to the left, at shares of the length.

        At corners the tangent is that of this stretch.
        """
        if self.outline is None:
            along = (self.end - self.start) / abs(self.end - self.start)
            return self.points(share), np.full(len(share), along), np.zeros(len(share))
        s = self.s[0] - share * self.length
        # a corner's own tangent is that half way between its sides
        inset = 2 * AT_CORNER * self.outline.length
        tx, ty = self.outline.tangents(np.clip(s, self.s[1] + inset, self.s[0] - inset)).T
        return self.points(share), -(tx + 1j * ty), self.outline.curvatures(s)


def boundary_of(part: Part, loading: Loading) -> list[list[Stretch]]:
    """The closed curves around a part, each of stretches that end at corners and where conditions do."""
    jumps = (hole.points(curvature_jumps(hole.breaks, hole.coefficients)) for hole in part.outlines)
    wanted = np.concatenate([loading.ends, *jumps])
    return [
        _graded([stretch for piece in ring for stretch in _stretches(piece, part)], loading)
        for ring in boundary_pieces(part.body, part.outlines, wanted)
    ]


def _stretches(piece: Piece, part: Part) -> list[Stretch]:
    """A piece of the boundary, cut at its prescribed points."""
    x, y = piece.points(piece.s, part.outlines).T
    z = x + 1j * y
    if piece.outline < 0:
        return [Stretch(a, b) for a, b in pairwise(z.tolist())]
    hole = part.outlines[piece.outline]
    found = []
    for a, b, first, last in zip(z, z[1:], piece.s.tolist(), piece.s[1:].tolist(), strict=False):
        x, y = hole.points(np.linspace(first, last, STRAIGHT_SAMPLES)).T
        bulge = np.abs(((x + 1j * y - a) * np.conj(b - a)).imag).max()
        is_straight = bulge < ROUND_OFF * abs(b - a) ** 2
        found.append(Stretch(a, b) if is_straight else Stretch(a, b, hole, piece.outline, (first, last)))
    return found


def _acting(z: complex, loading: Loading) -> list[Condition]:
    """The conditions at a point."""
    return [condition for condition in loading if condition.on(np.array([[z.real, z.imag]]))[0]]


def _graded(stretches: list[Stretch], loading: Loading) -> list[Stretch]:
    """The stretches of a closed curve, with how far panels shrink towards their ends."""
    middles = [stretch.points(np.array([0.5]))[0] for stretch in stretches]
    acting = [_acting(z, loading) for z in middles]
    held = [held_at(loading, (z.real, z.imag)) for z in middles]
    ends = np.array([0.0, 1.0])
    tangents = [stretch.at(ends)[1] for stretch in stretches]
    grade = []
    for k in range(len(stretches)):
        turn = float(np.angle(tangents[k][0] / tangents[k - 1][1]))
        changes = abs(turn) < SMALLEST_TURN and acting[k] != acting[k - 1]
        singular = is_singular(held[k - 1], held[k], turn)
        if changes:
            grade.append(SUPPORT if singular else CHANGE)
        elif turn < -SMALLEST_TURN:
            grade.append(REENTRANT)
        else:
            grade.append(HELD if singular else JUTTING)
    alone = len(stretches) == 1 and stretches[0].outline is not None
    if alone and abs(np.angle(tangents[0][0] / tangents[0][1])) < SMALLEST_TURN and grade[0] == JUTTING:
        return [stretches[0]._replace(closed=True)]
    length = [stretch.length for stretch in stretches]
    # beside a short stretch panels are as short as that asks for
    return [
        stretch._replace(
            last=(
                grade[k] * min(1.0, length[k - 1] / length[k]),
                grade[k + 1 - len(grade)] * min(1.0, length[k + 1 - len(grade)] / length[k]),
            )
        )
        for k, stretch in enumerate(stretches)
    ]
