import numpy as np
import pytest

from slmm.contours import shapes


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
