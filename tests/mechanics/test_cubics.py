"""Splines: what they reproduce, how fast they converge, how smooth they are, and those of scipy beside them."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from slmm.mechanics.cubics import closed_through, through

UNEVEN = np.cumsum(np.random.default_rng(3).uniform(0.4, 1.6, 24))


@pytest.mark.parametrize("n, degree", [(2, 1), (3, 2), (4, 3), (5, 3), (24, 3)])
def test_polynomials_are_reproduced_beyond_the_ends_too(n, degree):
    x, s = UNEVEN[:n], np.linspace(UNEVEN[0] - 1, UNEVEN[n - 1] + 1, 50)
    polynomial = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.25][: degree + 1])
    curve = through(x, np.column_stack([polynomial(x), -polynomial(x)]))
    for order, values in enumerate(curve.derivatives(s, 0, 1, 2)):
        wanted = polynomial.deriv(order)(s) if order else polynomial(s)
        scale = np.abs(wanted).max(initial=1.0)
        np.testing.assert_allclose(values, np.column_stack([wanted, -wanted]), atol=1e-11 * scale)


@pytest.mark.parametrize("shape", [(), (2,), (3, 2)])
@pytest.mark.parametrize("n", [2, 3, 4, 24])
def test_open_splines_are_those_of_scipy(n, shape):
    x, y = UNEVEN[:n], np.random.default_rng(n).normal(size=(n, *shape))
    ours, theirs = through(x, y), CubicSpline(x, y)
    np.testing.assert_allclose(ours.coefficients, theirs.c, atol=1e-13 * np.abs(theirs.c).max())
    for s in (x, 0.7, np.linspace(x[0] - 1, x[-1] + 1, 12).reshape(3, 4)):
        for order in (0, 1, 2):
            wanted = theirs(s, order)
            assert ours(s, order).shape == wanted.shape
            np.testing.assert_allclose(ours(s, order), wanted, atol=1e-12 * np.abs(wanted).max(initial=1.0))


@pytest.mark.parametrize("shape", [(), (2,)])
@pytest.mark.parametrize("n", [3, 4, 23])
def test_closed_splines_are_those_of_scipy(n, shape):
    x, y = UNEVEN[: n + 1], np.random.default_rng(n).normal(size=(n, *shape))
    theirs = CubicSpline(x, np.concatenate([y, y[:1]]), bc_type="periodic").c
    np.testing.assert_allclose(closed_through(x, y).coefficients, theirs, atol=1e-12 * np.abs(theirs).max())


def test_a_closed_curve_begins_as_it_ends():
    turn = 2 * np.pi * np.arange(40) / 40
    curve = closed_through(np.linspace(0.0, 1.0, 41), np.column_stack([np.cos(turn), np.sin(2 * turn)]))
    for begins, ends in zip(curve.derivatives(0.0, 0, 1, 2), curve.derivatives(1.0, 0, 1, 2), strict=True):
        np.testing.assert_allclose(begins, ends, atol=1e-10)


def test_a_circle_converges_with_the_fourth_power():
    def error(n):
        turn = np.linspace(0.0, 2 * np.pi, n + 1)
        curve = closed_through(turn, np.column_stack([np.cos(turn), np.sin(turn)])[:-1])
        return np.abs(np.linalg.norm(curve(np.linspace(0.0, 2 * np.pi, 1001)), axis=1) - 1).max()

    assert 14 < error(20) / error(40) < 18
