"""The coupled criterion on curves whose answer is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm import Material, coupled_criterion

MATERIAL = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)
A = np.linspace(0.0, 4.0, 81)


def test_constant_stress_and_linear_release_meet_where_both_limits_agree():
    # stress: lf = 1/2; energy: lf = sqrt(0.1/(0.2 a)) = 1/2 at a = 2
    r = coupled_criterion(A, 0.2 * A, np.full_like(A, 20.0), MATERIAL)
    assert r.load_factor == pytest.approx(0.5, rel=1e-6)
    assert r.crack_length == pytest.approx(2.0, rel=1e-3)
    assert r.failure_index == pytest.approx(2.0, rel=1e-6)


def test_falling_stress_governs_together_with_energy():
    # 20/(1 + a) and 0.2 a: sqrt(0.1/(0.2 a)) = (1 + a)/2 at the root of a (1 + a)^2 = 2
    stress = 20 / (1 + A)
    a_c = np.real(np.roots([1, 2, 1, -2])[np.abs(np.imag(np.roots([1, 2, 1, -2]))) < 1e-9])[0]
    r = coupled_criterion(A, 0.2 * A, stress, MATERIAL)
    assert r.governed_by == "stress and energy"
    assert r.crack_length == pytest.approx(a_c, rel=1e-3)
    assert r.load_factor == pytest.approx((1 + a_c) / 2, rel=1e-4)


def test_energy_alone_governs_where_the_release_has_a_maximum():
    G = 0.2 * A * np.exp(1 - A)  # largest, 0.2, at a = 1, where the stress is ample
    r = coupled_criterion(A, G, np.full_like(A, 200.0), MATERIAL)
    assert r.governed_by == "energy"
    assert r.crack_length == pytest.approx(1.0, abs=0.02)
    assert r.load_factor == pytest.approx(np.sqrt(0.5), rel=1e-4)


def test_curves_that_end_too_early_give_no_number():
    r = coupled_criterion(A, 1e-4 * A, np.full_like(A, 200.0), MATERIAL)
    assert np.isnan(r.load_factor) and np.isnan(r.failure_index) and r.governed_by == "none"


@pytest.mark.parametrize("stress", [-5.0 * np.ones_like(A), -5.0 + A])
def test_compression_at_the_mouth_starts_no_crack(stress):
    r = coupled_criterion(A, 0.2 * A, stress, MATERIAL)
    assert r.load_factor == np.inf and r.failure_index == 0.0


def test_rising_stress_counts_with_its_least_value():
    rising = coupled_criterion(A, 10 * A, 20.0 + 10 * A, MATERIAL)
    constant = coupled_criterion(A, 10 * A, np.full_like(A, 20.0), MATERIAL)
    assert rising.load_factor == pytest.approx(constant.load_factor, rel=1e-9)


@given(k=st.floats(1e-3, 1e3), slope=st.floats(0.0, 3.0))
def test_load_factor_is_inverse_to_the_load(k, slope):
    stress = 20 / (1 + slope * A)
    one = coupled_criterion(A, 0.2 * A, stress, MATERIAL)
    other = coupled_criterion(A, k**2 * 0.2 * A, k * stress, MATERIAL)
    if np.isnan(one.load_factor):
        assert np.isnan(other.load_factor)
    else:
        assert other.load_factor * k == pytest.approx(one.load_factor, rel=1e-9)


@given(slope=st.floats(0.1, 3.0))
def test_mean_stress_never_asks_for_more_load_than_the_point_stress(slope):
    stress = 20 / (1 + slope * A)
    point = coupled_criterion(A, 2 * A, stress, MATERIAL)
    mean = coupled_criterion(A, 2 * A, stress, MATERIAL, average=True)
    assert mean.load_factor <= point.load_factor * (1 + 1e-9)


# Circular hole in an unbounded plate, two symmetric cracks: Kirsch's stress and Tada's K, about 1 %
R_OVER_L = (0.1, 0.2, 0.5, 1, 2, 5, 10)
AVERAGED = (0.873, 0.784, 0.624, 0.508, 0.427, 0.372, 0.353)
POINT = (0.983, 0.915, 0.707, 0.571, 0.476, 0.400, 0.369)


@pytest.mark.parametrize("average, expected", [(True, AVERAGED), (False, POINT)])
def test_circular_hole_under_tension(average, expected):
    for ratio, strength in zip(R_OVER_L, expected, strict=True):
        material = Material(E=1000.0, nu=0.3, sigma_c=1.0, G_c=1 / 1000.0)  # l_ch = 1 mm
        R = ratio
        a = np.linspace(0.0, 6 * max(R, 1.0), 20001)
        x = 1 + a / R
        stress = 1 + 0.5 / x**2 + 1.5 / x**4
        s = a / (R + a)
        K2 = (0.5 * (3 - s) * (1 + 1.243 * (1 - s) ** 3)) ** 2 * np.pi * a
        energy = np.concatenate([[0.0], np.cumsum(0.5 * (K2[1:] + K2[:-1]) * np.diff(a))]) / material.E
        G = np.divide(energy, a, out=np.zeros_like(a), where=a > 0)
        result = coupled_criterion(a, G, stress, material, average=average)
        assert result.load_factor == pytest.approx(strength, rel=0.01), ratio


@pytest.mark.parametrize(
    "a, G, s, named",
    [
        ([0, 1], [0, 1], [1, 1, 1], "shapes"),
        ([0, 1], [0, np.nan], [1, 1], "G_inc"),
        ([0, 1, 1], [0, 1, 1], [1, 1, 1], "ascend"),
        ([-1, 1], [0, 1], [1, 1], "ascend"),
    ],
)
def test_wrong_curves_are_named(a, G, s, named):
    with pytest.raises(ValueError, match=named):
        coupled_criterion(a, G, s, MATERIAL)
