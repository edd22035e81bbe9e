import numpy as np
import pytest
import shapely

from slmm.part import shapes
from slmm.part.outline import Outline


def test_circle_and_ellipse_lie_on_their_equations():
    x, y = shapes.circle((1.0, 2.0), 3.0).T
    np.testing.assert_allclose((x - 1) ** 2 + (y - 2) ** 2, 9.0)
    x, y = shapes.ellipse((0.0, 0.0), (4.0, 2.0), 90.0).T
    np.testing.assert_allclose((x / 2) ** 2 + (y / 4) ** 2, 1.0)


@pytest.mark.parametrize("size", [(30.0, 30.0), (30.0, 12.0), (12.0, 30.0), (12.0, 12.0)])
def test_rectangle_has_its_sides_and_round_corners(size):
    points = shapes.rectangle((1.0, 2.0), size, 6.0) - (1.0, 2.0)
    np.testing.assert_allclose(np.ptp(points, axis=0), size)
    beyond = np.abs(points) - (np.array(size) / 2 - 6.0)  # distance from the rectangle of corner centres
    np.testing.assert_allclose(np.hypot(*np.maximum(beyond, 0.0).T), 6.0)
    steps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    assert steps.min() > 0.05 and steps.max() < 1.1


def test_angle_turns_counter_clockwise():
    flat, turned = shapes.rectangle((5, 5), (8, 4), 1.0), shapes.rectangle((5, 5), (8, 4), 1.0, 90.0)
    np.testing.assert_allclose(turned - 5, (flat - 5) @ [[0, 1], [-1, 0]], atol=1e-12)


def test_a_rectangle_whose_corner_radius_vanishes_has_the_sharp_corners():
    sharp = shapes.rectangle_corners((5, 5), (8, 4), 30.0)
    nearly = shapes.rectangle((5, 5), (8, 4), 1e-4, 30.0)
    np.testing.assert_allclose(sharp[0], nearly[0], atol=1e-4)  # both start at the end of the right side
    distance = shapely.distance(shapely.points(nearly), shapely.LinearRing(sharp))
    np.testing.assert_allclose(distance, 0.0, atol=1e-4)


L_SHAPE = np.array([(0.0, 0.0), (6.0, 0.0), (6.0, 2.0), (2.0, 2.0), (2.0, 5.0), (0.0, 5.0)])


@pytest.mark.parametrize("radius", [1e-3, 0.3, 1.0])
def test_corners_of_a_rounded_polygon_are_tangent_arcs_of_exactly_that_radius(radius):
    outline = Outline.of_pieces(shapes.polygon(L_SHAPE, radius))
    assert len(outline.corners) == 0
    kappa = outline.curvatures(outline.breaks[:-1] + 0.5 * np.diff(outline.breaks))
    straight = np.abs(kappa) < 1e-9
    np.testing.assert_allclose(np.abs(kappa[~straight]), 1 / radius, rtol=1e-4)
    on_arcs = np.diff(outline.breaks)[~straight]
    # five corners bulge out as a circle does, at one the material pokes into the hole
    assert on_arcs[kappa[~straight] < 0].sum() == pytest.approx(5 * np.pi / 2 * radius, rel=1e-9)
    assert on_arcs[kappa[~straight] > 0].sum() == pytest.approx(np.pi / 2 * radius, rel=1e-9)
    # each bulging corner loses (1 - pi/4) r^2, the other gains as much
    polygon = shapely.Polygon(outline.polygon(40_000))
    assert polygon.area == pytest.approx(18.0 - 4 * (1 - np.pi / 4) * radius**2, abs=1e-6 * radius**2 + 1e-9)


def test_rounding_may_use_up_a_side_but_not_more():
    full = Outline.of_pieces(shapes.polygon([(0, 0), (4, 0), (4, 2), (0, 2)], 1.0))  # a slot
    assert full.length == pytest.approx(2 * np.pi + 4, rel=1e-9)
    with pytest.raises(
        ValueError, match=r"corner_radius = 1.1: does not fit between points 1 and 2; .* most 1 "
    ):
        shapes.polygon([(0, 0), (4, 0), (4, 2), (0, 2)], 1.1)


def test_rounding_leaves_points_on_a_straight_side_alone():
    outline = Outline.of_pieces(shapes.polygon([(0, 0), (2, 0), (4, 0), (4, 3), (0, 3)], 0.5))
    assert outline.length == pytest.approx(14 - 4 + np.pi, rel=1e-9)
    assert np.abs(outline.points(outline.breaks[:-1]) - (2, 0)).sum(axis=1).min() == 0


@pytest.mark.parametrize(
    ("opening", "radius"), [(0.0, 1.0), (30.0, 0.1), (60.0, 2.0), (120.0, 1.0), (170.0, 3.0)]
)
@pytest.mark.parametrize("direction", [0.0, 77.0, -120.0])
def test_root_of_a_rounded_notch_is_a_tangent_arc_that_reaches_the_tip(opening, radius, direction):
    tip = np.array([12.0, 34.0])
    outline = Outline.of_pieces(shapes.v_notch(tip, direction, opening, radius, 10.0))
    ahead = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    s = outline.project(tip[None])
    np.testing.assert_allclose(outline.points(s)[0], tip, atol=1e-9)
    np.testing.assert_allclose(outline.normals(s)[0], ahead, atol=1e-7)
    depth = (tip - outline.polygon(4000)) @ ahead
    assert depth.min() == pytest.approx(0.0, abs=1e-4 * radius) and depth.max() == pytest.approx(10.0)
    assert len(outline.corners) == 2  # at the back side alone
    np.testing.assert_allclose(outline.corner_angles, np.pi / 2 - np.radians(opening / 2))
    # the arc turns by pi less the opening
    turn = outline.breaks[[1, -3]]
    assert turn[1] - turn[0] == pytest.approx(radius * (np.pi - np.radians(opening)), rel=1e-9)
    on_arc = np.linspace(*turn, 5003)[1:-1]
    assert np.abs(-radius * outline.curvatures(on_arc) - 1).max() < 1e-4
    np.testing.assert_allclose(outline.curvatures([0.5 * turn[0], turn[1] + 0.5 * turn[0]]), 0.0)


def test_a_sharp_notch_is_the_limit_of_vanishing_radius():
    sharp = Outline.of_pieces(shapes.v_notch((0.0, 0.0), 0.0, 60.0, 0.0, 5.0))
    np.testing.assert_allclose(np.degrees(sharp.corner_angles), 60.0)
    np.testing.assert_allclose(sharp.points(sharp.corners[1]), (0.0, 0.0))
    np.testing.assert_allclose(sharp.normals(sharp.corners[1]), (1.0, 0.0), atol=1e-15)
    blunt = Outline.of_pieces(shapes.v_notch((0.0, 0.0), 0.0, 60.0, 1e-3, 5.0))
    assert blunt.length == pytest.approx(sharp.length, abs=4e-3)
