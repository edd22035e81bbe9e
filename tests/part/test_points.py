import numpy as np
import pytest

from slmm.part import shapes
from slmm.part.points import point_problems, polygon_problems, without_repetition
from slmm.scene.scene import read_scene

RING = shapes.circle((50.0, 50.0), 5.0)[::6]
SQUARE = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)])


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-9, 1.4e-7, 9e-7])
@pytest.mark.parametrize("k", [0, 7, 59])
def test_points_that_differ_by_rounding_are_one(gap, k):
    again = RING[k] + 10 * gap * np.array([0.6, 0.8])  # the ring is 10 mm wide
    twice = np.insert(RING, k + 1, again, axis=0)
    np.testing.assert_array_equal(without_repetition(twice), RING)
    assert point_problems(twice) == []


@pytest.mark.parametrize("gap", [0.0, 1.4e-8, 1e-6])
def test_the_last_point_may_be_the_first_but_for_rounding(gap):
    for points, problems in ((RING, point_problems), (SQUARE, polygon_problems)):
        closed = np.vstack([points, points[0] + gap])
        np.testing.assert_array_equal(without_repetition(closed), points)
        assert problems(closed) == []


def test_small_steps_are_a_distance():
    fine = np.column_stack([np.linspace(0, 1, 4_000_001)[:400], np.zeros(400)])
    points = np.vstack([fine, [(4.0, 4.0)]])
    kept = without_repetition(points)
    assert len(kept) > 20 and np.hypot(*np.diff(kept[:-1], axis=0).T).min() > 4e-6


def test_a_corner_is_named_by_its_number_among_the_points_given():
    ring = np.vstack([RING[:3], RING[2] + 1e-7, RING[3:]])
    ring[20] += (3.0, 3.0)
    (problem,) = point_problems(ring)
    assert (
        "degrees at point 20, " in problem or "degrees at point 19, " in problem or "at point 21, " in problem
    )


def test_the_file_of_the_case_is_a_circle():
    (outline,) = read_scene("../shared/cases/15-near-equal-end-point/a.toml").outlines
    assert outline.length == pytest.approx(10 * np.pi, rel=1e-5)
