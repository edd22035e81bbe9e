"""Directions from K_I, K_II and T: the largest tension, the bifurcation in mode I, and what is refused."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.fracture.generalised_tangential import BIFURCATION, generalised_tangential_stress, lower_fork
from slmm.fracture.kinking import maximum_tangential_stress

K_IS = st.floats(0.0, 1.0)
OTHERS = st.floats(-1.0, 1.0)
ALL_ROUND = np.linspace(-np.pi, np.pi, 20001)


def tension(angle, K_I, K_II, T_root):
    """Times sqrt(2 pi r), from sigma_theta of K_I, K_II and of T along the crack."""
    c, s = np.cos(angle / 2), np.sin(angle / 2)
    return K_I * c**3 - 3 * K_II * s * c**2 + T_root * np.sin(angle) ** 2


@given(K_IS, OTHERS, OTHERS)
def test_no_other_direction_has_more_tension(K_I, K_II, T):
    if max(K_I, abs(K_II)) < 1e-3:
        return
    found = tension(generalised_tangential_stress(K_I, K_II, T), K_I, K_II, T)
    assert found >= tension(ALL_ROUND, K_I, K_II, T).max() - 1e-12


@given(K_IS, st.floats(1e-3, 1.0))
def test_without_T_it_is_the_largest_tangential_stress(K_I, K_II):
    assert generalised_tangential_stress(K_I, K_II, 0.0) == pytest.approx(
        maximum_tangential_stress(K_I, K_II), abs=1e-12
    )


@given(st.floats(-1e-3, 1e-3), st.floats(-1.0, 0.3))
def test_small_kinks_are_those_of_the_linear_law(K_II, T):
    """The tension's derivative at angle 0: (2 T - 3/4 K_I) angle - 3/2 K_II."""
    expected = -2 * K_II / (1 - T / BIFURCATION)
    third_order = 20 * abs(expected) ** 3
    assert generalised_tangential_stress(1.0, K_II, T) == pytest.approx(expected, abs=third_order + 1e-12)


@given(st.floats(0.05, 2.0))
def test_T_turns_a_crack_farther_aside_and_compression_along_it_less(K_II):
    kinks = [abs(generalised_tangential_stress(1.0, K_II, T)) for T in (-0.2, -0.1, 0.0, 0.1, 0.2)]
    assert kinks == sorted(kinks) and kinks[0] < kinks[-1]


@pytest.mark.parametrize("T", [-10.0, 0.0, 0.3, BIFURCATION * (1 - 1e-6)])
def test_mode_I_runs_straight_below_the_bifurcation(T):
    assert generalised_tangential_stress(1.0, 0.0, T) == 0.0
    assert lower_fork(1.0, 0.0, T) == pytest.approx(0.0, abs=1e-12)


@given(st.floats(1e-4, 1.0))
def test_beyond_it_mode_I_forks_to_either_side_and_goes_left(excess):
    """The slope over sin(angle/2) cos(angle/2) vanishes: 4 T cos(angle) = 3/2 K_I c, c = cos(angle/2)."""
    T = BIFURCATION + excess
    kink = generalised_tangential_stress(1.0, 0.0, T)
    c = (1.5 + math.sqrt(2.25 + 128 * T**2)) / (16 * T)
    assert kink == pytest.approx(2 * math.acos(c), abs=1e-6)
    assert lower_fork(1.0, 0.0, T) == pytest.approx(1.0, abs=1e-9)
    assert tension(kink, 1.0, 0.0, T) > tension(0.0, 1.0, 0.0, T)


@given(st.floats(1e-4, 1.0), st.floats(1e-6, 1e-3), st.sampled_from([-1, 1]))
def test_a_little_mode_II_decides_the_fork(excess, K_II, side):
    kink = generalised_tangential_stress(1.0, side * K_II, BIFURCATION + excess)
    assert math.copysign(1.0, kink) == -side


@pytest.mark.parametrize("K", [(0.0, 0.0, 1.0), (-1.0, 0.5, 0.0), (1.0, math.nan, 0.0), (1.0, 0.0, math.inf)])
def test_closed_cracks_and_what_is_no_number_are_refused(K):
    with pytest.raises(ValueError, match="= "):
        generalised_tangential_stress(*K)
