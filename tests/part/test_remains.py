"""What is left when pieces fall out: as much material as before, its surfaces on the curves, cracks where they were."""

import pytest

from slmm.part.crack import TIP
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.remains import remains
from slmm.part.shapes import circle

HOLE = Outline.through(circle((20.0, 30.0), 6.0))
NOTCH = Outline.through(circle((40.0, 30.0), 8.0))
LOOP = [
    [(28.0, 12.0), (12.0, 12.0)],
    [(14.0, 10.0), (14.0, 22.0)],
    [(12.0, 20.0), (28.0, 14.0)],
    [(26.0, 10.0), (26.0, 16.0)],
]

PARTS = {
    "a corner": (Part.plate(40.0, 60.0), [[(0.0, 12.0), (7.0, 8.0), (10.0, 0.0)]]),
    "a corner, reaching round two": (Part.plate(40.0, 60.0), [[(0.0, 45.0), (20.0, 50.0), (40.0, 44.0)]]),
    "between a hole and the edge": (
        Part.plate(40.0, 60.0, [HOLE]),
        [[(0.0, 28.0), (20.0, 28.0)], [(0.0, 34.0), (16.0, 32.0)]],
    ),
    "between a hole and a notch": (
        Part.plate(40.0, 60.0, [HOLE, NOTCH]),
        [[(20.0, 28.0), (40.0, 28.0)], [(20.0, 33.0), (40.0, 32.0)]],
    ),
    "beside a notch": (Part.plate(40.0, 60.0, [HOLE, NOTCH]), [[(40.0, 20.0), (36.0, 20.0), (35.0, 26.0)]]),
    "beside a notch over a whole side": (
        Part.plate(40.0, 60.0, [Outline.through(circle((20.0, 0.0), 30.0))]),
        [[(0.0, 35.0), (8.0, 35.0), (9.0, 27.0)]],
    ),
    "with a hole in it": (
        Part.plate(40.0, 60.0, [HOLE]),
        [[(0.0, 20.0), (32.0, 20.0), (32.0, 40.0), (0.0, 42.0)]],
    ),
    "within cracks": (Part.plate(40.0, 60.0, [HOLE]), LOOP),
    "at a curved edge": (
        Part.within(Outline.through(circle((0.0, 0.0), 40.0))),
        [[(-39.0, 15.0), (-25.0, 5.0), (-25.0, -10.0), (-39.0, -14.0)]],
    ),
    "between a hole and a curved edge": (
        Part.within(Outline.through(circle((20.0, 30.0), 25.0)), [HOLE]),
        [[(20.0, 32.0), (60.0, 32.0)], [(20.0, 28.0), (60.0, 27.0)]],
    ),
}


@pytest.mark.parametrize("name", PARTS)
def test_what_is_left_is_the_other_piece(name):
    whole, lines = PARTS[name]
    part = whole.with_cracks(lines)
    kept = max(part.pieces, key=lambda piece: piece.area)
    left = remains(part, kept).part
    assert len(part.pieces) > 1 and len(left.pieces) == 1
    assert left.body.symmetric_difference(kept).area < part.tolerance * kept.length


def test_cracks_that_go_on_begin_at_the_new_surface():
    """Of four that cross, their other ends stay cracks; one of them has two."""
    part = Part.plate(40.0, 60.0).with_cracks(LOOP)
    kept = max(part.pieces, key=lambda piece: piece.area)
    left = remains(part, kept)
    assert left.cracks == (0, 0, 1, 1, 2, 2, 3, 3) and left.holes == (-1,)
    assert sum(crack.start == TIP or crack.end == TIP for crack in left.part.cracks) == 8
    assert len(left.part.tips) == 8 == len(part.tips)
    before, behind = (sorted(tuple(line[-1]) for line in each.tips) for each in (part, left.part))
    assert behind == before


def test_holes_keep_their_order_and_what_is_untouched_is_the_same():
    small = Outline.through(circle((8.0, 50.0), 3.0))
    other = Outline.through(circle((32.0, 50.0), 3.0))
    part = Part.plate(40.0, 60.0, [small, HOLE, other], PARTS["between a hole and the edge"][1])
    left = remains(part, max(part.pieces, key=lambda piece: piece.area))
    assert left.holes == (0, 1, 2)
    assert left.part.holes[0] is small and left.part.holes[2] is other and left.part.holes[1] is not HOLE
