"""Outlines of pieces that may meet at corners."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.part import shapes
from slmm.part.outline import Outline
from slmm.scene.gallery import lobes

LOBED = np.array(lobes((3.0, -2.0), 19.0))


def everywhere(outline, n=3001):
    return np.linspace(0.0, outline.length, n)


RIGHT_TRIANGLE = [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]
#: an arrowhead: three corners open into the hole, at the fourth the material pokes into it
ARROWHEAD = [(0.0, 0.0), (6.0, 2.0), (0.0, 4.0), (2.0, 2.0)]


def outline_of(corners, radius=0.0):
    return Outline.of_pieces(shapes.polygon(corners, radius))


def half_disc(n=400):
    t = np.linspace(0.0, np.pi, n)
    return [[(-1.0, 0.0), (1.0, 0.0)], np.column_stack([np.cos(t), np.sin(t)])]


@st.composite
def polygons(draw):
    """Corners of a simple polygon that goes once round the point (7, -3), in either sense."""
    k = draw(st.integers(3, 8))
    gaps = np.array(draw(st.lists(st.floats(0.3, 1.0), min_size=k, max_size=k)))
    radii = np.array(draw(st.lists(st.floats(1.0, 5.0), min_size=k, max_size=k)))
    t = draw(st.floats(-np.pi, np.pi)) + np.cumsum(gaps) / gaps.sum() * 2 * np.pi
    points = np.column_stack([7 + radii * np.cos(t), -3 + radii * np.sin(t)])
    return points[:: draw(st.sampled_from([1, -1]))]


@given(polygons())
def test_corner_angles_of_a_polygon_sum_to_its_number_of_corners_less_two_times_pi(corners):
    outline = outline_of(corners)
    flat = len(corners) - len(outline.corners)  # corners that turn by less than 1e-3 are none
    assert outline.corner_angles.sum() == pytest.approx(
        (len(outline.corners) - 2) * np.pi, abs=1e-9 + 1e-3 * flat
    )


@given(polygons())
def test_sides_of_a_polygon_are_exactly_straight_and_pass_through_its_corners(corners):
    outline = outline_of(corners)
    assert not outline.coefficients[:2].any()
    assert {tuple(p) for p in outline.points(outline.breaks[:-1])} == {tuple(p) for p in corners}
    perimeter = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).sum()
    assert outline.length == pytest.approx(perimeter, rel=1e-12)
    assert not outline.curvatures(everywhere(outline)).any()


@given(polygons())
def test_the_normal_at_a_corner_is_its_bisector_into_the_material(corners):
    outline = outline_of(corners)
    step = 1e-4 * outline.length
    at, normals = outline.points(outline.corners), outline.normals(outline.corners)
    before = outline.points(outline.corners - step) - at
    after = outline.points(outline.corners + step) - at
    np.testing.assert_allclose(
        (before * normals).sum(axis=1), (after * normals).sum(axis=1), atol=1e-9 * step
    )
    # measured from the normal, the material reaches half of its angle to either side
    half = np.arccos((after * normals).sum(axis=1) / step)
    np.testing.assert_allclose(half, np.pi - outline.corner_angles / 2, atol=1e-6)
    tangents = outline.tangents(outline.corners)
    np.testing.assert_allclose(np.column_stack([tangents[:, 1], -tangents[:, 0]]), normals)


@given(polygons(), st.lists(st.tuples(st.floats(0, 14), st.floats(-10, 4)), min_size=1, max_size=20))
def test_projection_onto_a_polygon_finds_the_nearest_point(corners, points):
    outline = outline_of(corners)
    nearest = np.linalg.norm(outline.points(outline.project(points)) - points, axis=1)
    ring = shapely.LinearRing(corners)
    # two sides may be equally near but for the distance of the samples
    np.testing.assert_allclose(nearest, shapely.distance(ring, shapely.points(points)), atol=1e-5)


def test_a_corner_is_the_nearest_point_to_the_material_in_front_of_it():
    for corners in (RIGHT_TRIANGLE, ARROWHEAD):
        outline = outline_of(corners)
        for k, (corner, angle) in enumerate(zip(outline.corners, outline.corner_angles, strict=True)):
            if angle > np.pi:
                continue
            turn = np.linspace(-0.49, 0.49, 21) * (np.pi - angle)
            n_x, n_y = outline.normals(corner)
            ray = np.column_stack(
                [np.cos(turn) * n_x - np.sin(turn) * n_y, np.sin(turn) * n_x + np.cos(turn) * n_y]
            )
            for distance in (0.0, 1e-6, 0.1):
                s = outline.project(outline.points(corner) + distance * ray)
                assert (s == corner).all() and (outline.corner_at(s) == k).all()


def test_projection_tells_the_flanks_of_a_needle_apart():
    outline = outline_of([(0.0, 0.0), (100.0, -0.1), (100.0, 0.1)])  # two thousandths of a radian wide
    for side in (0, 2):
        s = outline.breaks[side] + np.linspace(0.01, 0.99, 2003) * np.diff(outline.breaks)[side]
        np.testing.assert_allclose(outline.project(outline.points(s)), s, atol=1e-9)


def test_sense_and_first_point_of_pieces():
    for corners in (ARROWHEAD, [ARROWHEAD[0], *ARROWHEAD[:0:-1]]):
        outline = outline_of(corners)
        np.testing.assert_array_equal(outline.points(0.0), ARROWHEAD[0])
        np.testing.assert_array_equal(outline.points(outline.corners), ARROWHEAD)  # counter-clockwise
        angles = outline.corner_angles
        assert (angles < np.pi).tolist() == [True, True, True, False]
        assert angles[1] == pytest.approx(2 * np.arctan(1 / 3)) and angles[3] == pytest.approx(1.5 * np.pi)


def test_pieces_that_meet_tangentially_have_no_corner_between_them():
    quarter = np.linspace(0.0, np.pi / 2, 315)
    arcs = [
        np.column_stack([np.cos(quarter + k * np.pi / 2), np.sin(quarter + k * np.pi / 2)]) for k in range(4)
    ]
    outline = Outline.of_pieces(arcs)
    assert len(outline.corners) == len(outline.corner_angles) == 0
    s = everywhere(outline)
    assert outline.length == pytest.approx(2 * np.pi, rel=1e-10)
    assert np.abs(-outline.curvatures(s) - 1).max() < 3e-5
    np.testing.assert_allclose(outline.normals(s), outline.points(s), atol=1e-7)
    np.testing.assert_allclose(outline.project(1.5 * outline.points(s[:-1])), s[:-1], atol=1e-7)


def test_straight_and_curved_pieces_may_meet_at_a_corner():
    outline = Outline.of_pieces(half_disc())
    np.testing.assert_allclose(outline.corners, [0.0, 2.0], atol=1e-12)
    np.testing.assert_allclose(outline.corner_angles, np.pi / 2, atol=1e-6)
    np.testing.assert_allclose(outline.normals(outline.corners) * np.sqrt(2), [[-1, -1], [1, -1]], atol=1e-6)
    side, arc = outline.curvatures([1.0, 3.0])
    assert side == 0.0 and arc == pytest.approx(-1.0, rel=1e-4)
    # at a corner the curvature is that of the piece which begins there
    assert outline.curvatures(2.0) == pytest.approx(-1.0, rel=1e-4)
    speed = np.linalg.norm(outline._derivatives(everywhere(outline, 20_011), 1)[0], axis=1)
    assert np.abs(speed - 1).max() < 1e-6


@pytest.mark.parametrize("start", [0.0, 0.3, 0.9], ids=["at the corner", "before it", "behind it"])
def test_an_outline_may_have_a_single_corner(start):
    # evenly spaced points of one loop of the lemniscate; s = 0 lies at the corner or elsewhere
    t = np.linspace(0.0, np.pi, 801)
    loop = np.column_stack([np.sin(t), np.sin(t) * np.cos(t)]) / (1 + np.cos(t) ** 2)[:, None]
    loop[[0, -1]] = 0.0
    k = int(start * 800)
    outline = Outline.of_pieces([loop] if k == 0 else [loop[k:], loop[: k + 1]])
    (corner,) = outline.corners
    assert outline.corner_angles[0] == pytest.approx(np.pi / 2, abs=1e-5)
    np.testing.assert_allclose(outline.points(corner), (0.0, 0.0), atol=1e-15)
    np.testing.assert_allclose(outline.normals(corner), (-1.0, 0.0), atol=1e-5)
    assert outline.project([[-0.5, 0.1], [0.0, 0.0]]).tolist() == [corner, corner]
    s = everywhere(outline)[:-1]
    nearest = outline.project(outline.points(s) + 0.1 * outline.normals(s))
    gap = (nearest - s + outline.length / 2) % outline.length - outline.length / 2
    assert np.abs(gap).max() < 1e-7
    assert (outline.points(corner) == outline.polygon(50)).all(axis=1).sum() == 1


@pytest.mark.parametrize("n", [4, 5, 64, 2000])
def test_a_polygon_along_the_outline_has_n_points_and_every_corner(n):
    for outline in (outline_of(ARROWHEAD), Outline.of_pieces(half_disc())):
        points = outline.polygon(n)
        assert points.shape == (n, 2)
        assert {tuple(p) for p in outline.points(outline.corners)} <= {tuple(p) for p in points}
        assert shapely.Polygon(points).exterior.is_ccw
    assert len(outline_of(ARROWHEAD).polygon(2)) == 4


def test_a_polygon_gives_a_small_arc_its_share():
    outline = Outline.of_pieces(shapes.v_notch((0.0, 0.0), 0.0, 60.0, 0.01, 10.0))
    polygon = shapely.Polygon(outline.polygon(400))
    on_arc = np.hypot(*(outline.polygon(400) - (-0.01, 0.0)).T) < 0.01 * (1 + 1e-9)
    assert on_arc.sum() > 100
    # without it, the root of 2e-4 mm^2 would be missing
    assert polygon.area == pytest.approx(shapely.Polygon(outline.polygon(40_000)).area, abs=1e-7)


@settings(max_examples=20, deadline=None)
@given(
    angle=st.floats(-180, 180),
    scale=st.floats(1e-3, 1e3),
    shift=st.tuples(st.floats(-100, 100), st.floats(-100, 100)),
)
def test_turning_and_scaling_the_pieces_turns_and_scales_the_outline(angle, scale, shift):
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s], [s, c]])
    pieces = [*shapes.v_notch((1.0, 2.0), 20.0, 40.0, 0.5, 6.0)]
    one = Outline.of_pieces(pieces)
    other = Outline.of_pieces([scale * (piece @ turn.T + shift) for piece in pieces])
    at = everywhere(one, 200)
    np.testing.assert_allclose(other.breaks, scale * one.breaks, rtol=1e-9)
    np.testing.assert_allclose(other.corners, scale * one.corners, rtol=1e-9)
    np.testing.assert_allclose(other.corner_angles, one.corner_angles, atol=1e-9)
    np.testing.assert_allclose(
        other.points(scale * at), scale * (one.points(at) @ turn.T + shift), atol=1e-9 * scale
    )
    np.testing.assert_allclose(
        other.normals(scale * one.corners), one.normals(one.corners) @ turn.T, atol=1e-9
    )
    np.testing.assert_allclose(other.curvatures(scale * at) * scale, one.curvatures(at), atol=1e-4)


def test_corner_at_knows_corners_by_their_arc_length_all_round():
    outline = outline_of(RIGHT_TRIANGLE)
    s = np.array([0.0, 12.0, -12.0, 24.0, 4.0, 4.0 + 1e-10, 4.01, 9.0 - 12.0, 11.9])
    assert outline.corner_at(s).tolist() == [0, 0, 0, 0, 1, 1, -1, 2, -1]
    assert outline.corner_at(s, within=0.2).tolist() == [0, 0, 0, 0, 1, 1, 1, 2, 0]
    assert outline.corner_at(4.0) == 1
    assert (Outline.through(LOBED).corner_at(s) == -1).all()


def test_arrays_of_an_outline_cannot_be_changed():
    for outline in (outline_of(RIGHT_TRIANGLE), Outline.through(LOBED)):
        for array in (outline.breaks, outline.coefficients, outline.corners):
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0.0


@pytest.mark.parametrize(
    ("pieces", "says"),
    [
        ([], "at least one piece"),
        ([np.zeros((3, 3))], r"piece 0 of the outline has shape \(3, 3\)"),
        ([[(0, 0)]], r"shape \(1, 2\)"),
        ([[(0, 0), (1, np.inf)], [(1, 0), (0, 0)]], "piece 0 .*finite"),
        ([[(0, 0), (1, 0)], [(1, 0), (0, 1)]], r"piece 1 .* ends at \(0, 1\), .* begins at \(0, 0\)"),
        (
            [[(0, 0), (1, 0)], [(1, 0), (0, 1)], [(0, 1), (0, 1), (0, 0)]],
            "points 0 and 1 of piece 2 .*coincide",
        ),
        ([[(0, 0), (1, 0), (1, 1), (0, 0)]], r"piece 0 .* has a corner at \(1, [01]\)"),
        ([[(0, 0), (1, 0)], [(1, 0), (0, 0)]], "enclose no area"),
        (
            [[(0, 0), (2, 0)], [(2, 0), (1, 0)], [(1, 0), (1, 1)], [(1, 1), (0, 0)]],
            r"back on itself at \(2, 0\)",
        ),
    ],
    ids=["none", "shape", "one point", "infinite", "open", "repeated", "corner inside", "no area", "spike"],
)
def test_pieces_that_are_no_outline_are_refused(pieces, says):
    with pytest.raises(ValueError, match=says):
        Outline.of_pieces(pieces)
