"""Closed splines are those of scipy."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from slmm.part.outline_splines import periodic_spline


@pytest.mark.parametrize("n", [8, 9, 600])
@pytest.mark.parametrize("even", [True, False])
def test_a_closed_spline_is_that_of_scipy_to_the_bit(n, even):
    rng = np.random.default_rng(n)
    steps = np.full(n, 0.1) if even else rng.uniform(0.1, 0.2, n)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    angle = 2 * np.pi * at[:-1] / at[-1]
    points = np.column_stack([40 + 3 * np.cos(angle) + 0.2 * np.cos(5 * angle), 30 + 2 * np.sin(angle)])
    ours, wanted = (
        periodic_spline(at, points),
        CubicSpline(at, np.vstack([points, points[:1]]), bc_type="periodic"),
    )
    assert np.array_equal(ours.c, wanted.c)
    assert np.array_equal(ours.x, wanted.x)
