"""A part and its cracks: where they end, where they meet, and whether they sever it."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from slmm.part import shapes
from slmm.part.crack import TIP, End
from slmm.part.outline import Outline
from slmm.part.part import Part

EDGE = End("surface")


def hole(x, y, radius):
    return Outline.through(shapes.circle((x, y), radius))


PLATE = Part.plate(100.0, 80.0, [hole(50, 40, 20)])


def test_notches_that_leave_no_single_body_are_refused():
    bar = Outline.through(shapes.rectangle((50, 40), (20, 200), 3.0))
    with pytest.raises(ValueError, match="leaves 2 pieces"):
        _ = Part.plate(100.0, 80.0, [bar]).body
    with pytest.raises(ValueError, match="leaves 0 pieces"):
        _ = Part.plate(10.0, 10.0, [hole(5, 5, 50)]).body


@pytest.mark.parametrize(
    ("points", "ends", "first", "last"),
    [
        ([(10, 10), (20, 10)], (TIP, TIP), (10, 10), (20, 10)),
        ([(0, 10), (20, 10)], (EDGE, TIP), (0, 10), (20, 10)),
        ([(20, 10), (0, 10)], (TIP, EDGE), (20, 10), (0, 10)),
        ([(0, 40), (30, 40)], (EDGE, End("surface", 0)), (0, 40), (30, 40)),
        # what lies in the hole is no crack
        ([(50, 40), (80, 40)], (End("surface", 0), TIP), (70, 40), (80, 40)),
        ([(0, 40), (45, 40)], (EDGE, End("surface", 0)), (0, 40), (30, 40)),
        # near enough
        ([(0.0004, 10), (20, 10)], (EDGE, TIP), (0, 10), (20, 10)),
        ([(0, 40), (29.9996, 40)], (EDGE, End("surface", 0)), (0, 40), (30, 40)),
        ([(0.01, 10), (20, 10)], (TIP, TIP), (0.01, 10), (20, 10)),
    ],
)
def test_the_ends_of_a_crack_are_what_they_lie_on(points, ends, first, last):
    (crack,) = PLATE.with_crack(points).cracks
    assert (crack.start, crack.end) == ends
    assert crack.points[0] == pytest.approx(first, abs=1e-6) and crack.points[-1] == pytest.approx(
        last, abs=1e-6
    )
    assert [tuple(line[-1]) for line in crack.tips] == [
        tuple(crack.points[k]) for k, end in zip((0, -1), ends, strict=True) if end == TIP
    ]


def test_a_crack_from_the_tip_of_another_leaves_no_tip_there():
    part = PLATE.with_crack([(0, 10), (20, 10)]).with_crack([(20, 10), (30, 15)])
    first, second = part.cracks
    assert (first.start, first.end) == (EDGE, End("crack", 1))
    assert (second.start, second.end) == (End("crack", 0), TIP)
    assert [line[-1].tolist() for line in part.tips] == [[30.0, 15.0]]
    assert part.end_at(np.array([25.0, 12.5])) == End("crack", 1)


def test_a_crack_grows_at_either_tip_and_into_a_surface():
    part = Part.plate(100.0, 80.0, cracks=[[(30, 40), (50, 40)], [(0, 10), (10, 10)]])
    longer = part.grown(0, (25, 42)).grown(1, [(55, 41), (60, 45)]).grown(2, (12, 0))
    assert longer.cracks[0].points.tolist() == [[25, 42], [30, 40], [50, 40], [55, 41], [60, 45]]
    assert longer.cracks[1].points.tolist() == [[0, 10], [10, 10], [12, 0]]
    assert longer.cracks[1].end == EDGE and len(longer.tips) == 2
    assert longer.is_severed and longer.holes is part.holes and longer.outer is part.outer
    with pytest.raises(ValueError, match="tip = 3: the part has 3"):
        part.grown(3, (1, 1))


def test_mouths_stay_where_they_are_while_cracks_grow():
    """To the bit: a model that is factorised for these mouths serves on."""
    hollow = [
        (20 + (8 + 2 * np.cos(3 * t)) * np.cos(t), 20 + (8 + 2 * np.cos(3 * t)) * np.sin(t))
        for t in np.linspace(0.0, 2 * np.pi, 90)[:-1]
    ]
    outline = Outline.through(hollow)
    for s in np.linspace(0.0, outline.length, 12, endpoint=False):
        mouth, inward = outline.points(s), outline.normals(s)
        part = Part.plate(40.0, 40.0, [outline], [[mouth, mouth + inward]])
        start = part.cracks[0].points[0]
        assert np.linalg.norm(start - mouth) < 1e-9
        for k in range(2, 6):
            part = part.grown(0, mouth + k * inward)
            assert (part.cracks[0].points[0] == start).all()


def test_cracks_have_a_common_point_where_they_meet_or_cross():
    part = Part.plate(
        100.0, 80.0, cracks=[[(10, 40), (50, 40)], [(30, 20), (30, 60)], [(20, 40.0003), (20, 70)]]
    )
    one, across, on_one = part.crack_lines
    assert one.tolist() == [[10, 40], [20, 40], [30, 40], [50, 40]]
    assert across.tolist() == [[30, 20], [30, 40], [30, 60]]
    assert part.cracks[2].start == End("crack", 0) and on_one[0].tolist() == [20, 40]
    assert len(part.tips) == 5


@pytest.mark.parametrize(
    ("cracks", "pieces"),
    [
        ([[(0, 60), (100, 60)]], 2),
        ([[(0, 40), (30, 40)]], 1),
        ([[(0, 40), (30, 40)], [(70, 40), (100, 40)]], 2),
        ([[(0, 10), (20, 10)], [(20, 10), (20, 0)]], 2),
        ([[(0, 10), (20, 10)], [(15, 5), (15, 0)]], 1),
        ([[(0, 10), (20, 10)], [(15, 20), (15, 0)]], 2),
        ([[(10, 65), (20, 65)], [(20, 65), (20, 75)], [(20, 75), (10, 65)]], 2),
        ([[(50, 60), (50, 80)], [(50, 0), (50, 20)], [(0, 40), (30, 40)]], 3),
    ],
)
def test_severed_parts_know_their_pieces(cracks, pieces):
    part = Part.plate(100.0, 80.0, [hole(50, 40, 20)], cracks)
    assert len(part.pieces) == pieces and part.is_severed == (pieces > 1)
    assert sum(piece.area for piece in part.pieces) == pytest.approx(part.body.area, rel=1e-9)


@given(seed=st.integers(0, 10_000))
def test_whether_a_part_is_severed_is_known_without_its_pieces(seed):
    rng = np.random.default_rng(seed)
    part = Part.plate(100.0, 80.0, [hole(30, 40, 12), hole(70, 40, 12)])
    for _ in range(rng.integers(1, 6)):
        line = rng.uniform(-5, 105, (2, 2)) * (1, 0.8)
        try:
            part = part.with_crack(line)
        except ValueError:
            continue
    assert part.is_severed == (len(part.pieces) > 1)


@given(seed=st.integers(0, 10_000))
def test_a_crack_that_has_grown_is_that_along_its_whole_line(seed):
    rng = np.random.default_rng(seed)
    part = Part.plate(100.0, 80.0, [hole(50, 60, 12)], [[(0, 20), (5, 20)], [(60, 10), (70, 12)]])
    tips = np.array([line[-1] for line in part.tips])
    for _ in range(8):
        tip = int(rng.integers(len(part.tips)))
        part = part.grown(tip, part.tips[tip][-1] + rng.uniform(-1, 6, 2))
        if len(part.tips) < len(tips):
            break
    whole = Part.plate(100.0, 80.0, part.holes, [crack.points for crack in part.cracks])
    for one, other in zip(part.cracks, whole.cracks, strict=True):
        assert np.array_equal(one.points, other.points) and (one.start, one.end) == (other.start, other.end)


@given(
    start=st.tuples(st.floats(1, 99), st.floats(1, 79)),
    end=st.tuples(st.floats(1, 99), st.floats(1, 79)),
)
def test_a_crack_inside_never_severs_and_one_that_is_turned_round_is_the_same(start, end):
    if np.hypot(end[0] - start[0], end[1] - start[1]) < 1:
        return
    part = Part.plate(100.0, 80.0, cracks=[[start, end]])
    assert not part.is_severed and part.cracks[0].start == part.cracks[0].end == TIP
    turned = Part.plate(100.0, 80.0, cracks=[[end, start]])
    assert np.array_equal(turned.cracks[0].points, part.cracks[0].points[::-1])
    assert shapely.equals(turned.body, part.body)


def test_a_crack_in_two_stretches_is_refused():
    with pytest.raises(ValueError, match="in one piece"):
        PLATE.with_crack([(10, 40), (90, 40)])


def test_a_crack_that_is_known_to_grow_inside_is_the_one_that_is_checked():
    part = Part.plate(40.0, 120.0, cracks=[[(0, 60), (20, 60)], [(10, 90), (20, 90)]])
    for tip in range(3):
        end = part.tips[tip][-1] + [1.5, -2.0]
        ours, wanted = (grow(tip, end) for grow in (part.grown_inside, part.grown))
        for one, other in zip(ours.cracks, wanted.cracks, strict=True):
            assert one.points.tolist() == other.points.tolist()
            assert (one.start, one.end) == (other.start, other.end)
