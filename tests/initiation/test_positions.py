"""Where cracks are looked for: equally spaced, at corners, at crack tips, or where the user points at."""

import numpy as np
import pytest

from slmm.initiation.positions import find_positions
from slmm.scene import gallery

CRACK = {"points": [[0.0, 20.0], [10.0, 20.0]]}
CIRCLE = {"shape": "circle", "center": [0.0, 50.0], "radius": 20.0}


def near_outline(scene, where):
    on_holes = where.hole >= 0
    outlines = [scene.outlines[k] for k in where.hole[on_holes]]
    at = [outline.points(s) for outline, s in zip(outlines, where.s[on_holes], strict=True)]
    np.testing.assert_array_equal(where.points[on_holes], at)
    return True


def test_on_smooth_outlines_positions_are_equally_spaced_from_their_start():
    scene = gallery.two_holes()
    where = find_positions(scene, 8)
    assert where.hole.tolist() == [0] * 8 + [1] * 8
    length = scene.outlines[0].length
    np.testing.assert_allclose(where.s, np.tile(np.arange(8) / 8 * length, 2), rtol=1e-12)
    assert np.isnan(where.corner).all() and (where.tip == -1).all()
    assert near_outline(scene, where)


def test_of_an_edge_notch_only_the_part_inside_the_plate_has_positions():
    scene = gallery.circular_hole(holes=[CIRCLE])
    where = find_positions(scene, 20)
    assert len(where.s) == 20 and (where.points[:, 0] > 0).all()
    steps = np.diff(np.sort((where.s + 0.5 * scene.outlines[0].length) % scene.outlines[0].length))
    np.testing.assert_allclose(steps, steps.mean(), rtol=0.03)


def test_every_corner_that_opens_into_the_hole_is_a_position_in_order_of_arc_length():
    corners = [[20, 20], [80, 40], [20, 60], [40, 40]]  # at the last one the material pokes into the hole
    scene = gallery.square_hole(holes=[{"shape": "polygon", "points": corners}])
    (outline,) = scene.outlines
    where = find_positions(scene, 7)
    assert len(where.s) == 7 + 2  # one of the three is the start, where a position was before
    assert (np.diff(where.s) > 0).all()
    evenly = np.arange(7) * outline.length / 7
    assert set(evenly) <= set(where.s)
    at_corner = np.isfinite(where.corner)
    np.testing.assert_allclose(where.points[at_corner], corners[:3], atol=1e-12)
    np.testing.assert_allclose(where.corner[at_corner], outline.corner_angles[:3])
    assert near_outline(scene, where)


def test_corners_outside_the_plate_are_no_positions():
    scene = gallery.v_notch(90.0)
    assert len(scene.outlines[0].corners) == 3
    where = find_positions(scene, 10)
    assert len(where.s) == 11
    (tip,) = np.flatnonzero(np.isfinite(where.corner))
    np.testing.assert_allclose(where.points[tip], (10.0, 60.0))
    assert where.corner[tip] == pytest.approx(np.pi / 2)
    # as many below as above
    assert (where.points[:, 1] < 60 - 1e-9).sum() == (where.points[:, 1] > 60 + 1e-9).sum() == 5


def test_crack_tips_follow_after_all_holes():
    scene = gallery.two_holes(cracks=[CRACK, {"points": [[100.0, 90.0], [90.0, 90.0], [85.0, 85.0]]}])
    where = find_positions(scene, 3)
    assert where.hole.tolist() == [0, 0, 0, 1, 1, 1, -1, -1]
    assert where.tip.tolist() == [-1] * 6 + [0, 1]
    assert where.points[6:].tolist() == [[10.0, 20.0], [85.0, 85.0]]
    assert np.isnan(where.s[6:]).all() and where.corner[6:].tolist() == [0.0, 0.0]


def test_a_scene_with_a_crack_alone_has_its_tip():
    where = find_positions(gallery.edge_crack(10.0))
    assert where.hole.tolist() == [-1] and where.tip.tolist() == [0]
    assert where.points.tolist() == [[10.0, 60.0]]


def test_explicit_points_keep_their_order_and_snap_to_corners_and_tips():
    points = [[10.0, 20.0], [50.0, 70.0], [65.0004, 65.0], [35.0, 35.01], [60.0, 70.0]]
    scene = gallery.square_hole(cracks=[CRACK], analysis={"points": points})
    where = find_positions(scene)
    assert where.tip.tolist() == [0, -1, -1, -1, -1] and where.hole.tolist() == [-1, 0, 0, 0, 0]
    np.testing.assert_allclose(where.points, [(10, 20), (50, 65), (65, 65), (35, 35.01), (60, 65)], atol=1e-9)
    np.testing.assert_allclose(np.degrees(where.corner), [0.0, np.nan, 90.0, np.nan, np.nan])
    assert where.s[2] == 0.0  # exactly the corner


def test_explicit_points_leave_crack_tips_out_that_they_do_not_name():
    scene = gallery.square_hole(cracks=[CRACK], analysis={"points": [[50.0, 65.0], [11.0, 20.0]]})
    assert find_positions(scene).tip.tolist() == [-1, -1]
    # a number of positions takes the place of the points
    assert find_positions(scene, 4).tip.tolist() == [-1] * 4 + [0]


def test_an_explicit_point_goes_to_the_nearest_outline():
    scene = gallery.two_holes(2.0, analysis={"points": [[49.5, 50.0], [50.5, 50.0], [90.0, 50.0]]})
    where = find_positions(scene)
    assert where.hole.tolist() == [0, 1, 1]
    np.testing.assert_allclose(where.points, [(49, 50), (51, 50), (71, 50)], atol=1e-4)


def test_a_point_beyond_a_corner_is_that_corner():
    scene = gallery.square_hole(analysis={"points": [[70.0, 72.0]]})
    where = find_positions(scene)
    assert where.points.tolist() == [[65.0, 65.0]] and np.degrees(where.corner) == pytest.approx(90.0)


def test_scenes_without_any_place_for_a_crack_are_refused():
    with pytest.raises(ValueError, match="has none, and no crack tips"):
        find_positions(gallery.circular_hole(holes=[]))
    with pytest.raises(ValueError, match=r"analysis.points\[1\] = \[12, 60\]: the scene has no hole"):
        find_positions(gallery.edge_crack(10.0, analysis={"points": [[10.0, 60.0], [12.0, 60.0]]}))
    with pytest.raises(ValueError, match="positions = 0: must be at least 1"):
        find_positions(gallery.circular_hole(), 0)


@pytest.mark.parametrize("radius", [0.02, 0.2, 1.0])
def test_the_root_of_a_blunted_notch_is_a_position_however_sharp_it_is(radius):
    where = find_positions(gallery.v_notch(60.0, radius), 10)
    to_root = np.linalg.norm(where.points - [10.0, 60.0], axis=1)
    assert to_root.min() < 0.05 * radius
    assert np.all(np.diff(where.s) > 0)


def test_bends_that_positions_resolve_add_none():
    assert len(find_positions(gallery.circular_hole(), 8).s) == 8
    assert len(find_positions(gallery.elliptic_hole(), 20).s) == 20
    # four positions cannot be meant to find a bend
    assert len(find_positions(gallery.rounded_square(), 4).s) == 4
