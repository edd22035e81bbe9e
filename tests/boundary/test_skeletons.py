"""Skeletons stand for all that a cluster causes and feels, wherever its surroundings are."""

import numpy as np
import pytest

from slmm.boundary.skeletons import BEYOND, TERMS, Circle, skeleton


def test_shares_of_kept_columns_give_all():
    rng = np.random.default_rng(0)
    matrix = rng.normal(size=(80, 12)) @ rng.normal(size=(12, 40))
    kept, shares = skeleton(matrix, rng.uniform(0.1, 1.0, 40))
    assert len(kept) == 12
    np.testing.assert_allclose(matrix[:, kept] @ shares, matrix, atol=1e-9)
    np.testing.assert_array_equal(shares[:, kept], np.eye(12))


def test_lone_rows_among_many_count():
    rng = np.random.default_rng(0)
    matrix = np.zeros((400, 40))
    lone = rng.choice(400, 12, replace=False)
    matrix[lone] = rng.normal(size=(12, 40))
    kept, shares = skeleton(matrix, np.ones(40))
    assert len(kept) == 12
    np.testing.assert_allclose(matrix[:, kept] @ shares, matrix, atol=1e-9)


@pytest.mark.parametrize("angle", [0.0, 1.0, 2.5])
def test_what_comes_from_far_is_among_the_series(angle):
    kappa, rng = 2.1, np.random.default_rng(1)
    z = 3 - 2j + 1.5 * np.sqrt(rng.uniform(0, 1, 60)) * np.exp(2j * np.pi * rng.uniform(0, 1, 60))
    circle = Circle(3 - 2j, 1.5)
    source = circle.centre + BEYOND * circle.radius * np.exp(1j * angle)
    # a point force beyond the circle
    gap = z - source
    w = 2 * kappa * np.log(np.abs(gap)) - gap / gap.conj()
    values = np.column_stack([w.real, w.imag]).ravel()
    series = circle.taylor(z, kappa)
    assert series.shape == (120, 4 * TERMS)
    rest = values - series @ np.linalg.lstsq(series, values, rcond=1e-15)[0]
    assert np.abs(rest).max() < 1e-9
