"""Directions by the name of their criterion."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.criteria.distances import point_distance
from slmm.fracture.directions import BY_INTENSITIES, DIRECTIONS, Direction, along_J, direction_of
from slmm.mechanics.material import Material

RATIOS = st.floats(-2.0, 2.0)
NAMES = st.sampled_from(DIRECTIONS)
PMMA = Material.from_name("PMMA")


def angle(name, K_I, K_II, T=0.0):
    return direction_of(name, PMMA).angle(K_I, K_II, T)


@pytest.mark.parametrize("name", DIRECTIONS)
def test_mode_I_runs_straight(name):
    assert angle(name, 1.0, 0.0) == pytest.approx(0.0, abs=1e-12)


@given(RATIOS, NAMES, st.floats(0.1, 100.0), st.floats(-0.3, 0.3))
def test_mirrored_loads_turn_cracks_the_other_way_whatever_their_size(K_II, name, size, T):
    one, other = angle(name, 1.0, K_II, T), angle(name, size, -size * K_II, size * T)
    assert one == pytest.approx(-other, abs=1e-9)


@given(st.floats(1e-4, 1e-2), NAMES)
def test_all_agree_where_there_is_little_mode_II_and_no_T(K_II, name):
    """To first order the kink is -2 K_II/K_I for every one of them; what is left is of the third."""
    assert angle(name, 1.0, K_II) == pytest.approx(-2 * K_II, abs=10 * K_II**3)


@given(RATIOS, st.sampled_from(sorted(BY_INTENSITIES)), st.floats(-10.0, 10.0))
def test_T_counts_for_the_generalised_criterion_alone(K_II, name, T):
    assert angle(name, 1.0, K_II, T) == BY_INTENSITIES[name](1.0, K_II)
    assert not direction_of(name, PMMA).asks_for_T and direction_of("GMTS", PMMA).asks_for_T


def test_its_distance_is_that_of_the_point_method_or_given():
    assert direction_of("GMTS", PMMA).distance == point_distance(PMMA)
    assert direction_of("GMTS", PMMA, 0.05) == Direction("GMTS", 0.05)


@given(st.floats(0.1, 10.0), st.floats(-0.3, 0.3))
def test_scaled_parts_turn_their_cracks_alike(factor, T):
    """K goes with the root of the length, and r_c with the length."""
    one = Direction("GMTS", 0.1).angle(30.0, 10.0, 100 * T)
    root = math.sqrt(factor)
    assert Direction("GMTS", 0.1 * factor).angle(30.0 * root, 10.0 * root, 100 * T) == pytest.approx(one)


def test_J_is_the_vector_of_its_components():
    assert along_J(2.0, 1.0) == pytest.approx(math.atan2(-4.0, 5.0))


@pytest.mark.parametrize(
    ("name", "distance", "says"),
    [
        ("mts", None, "direction = 'mts': must be one of MTS, MERR"),
        ("MTS", 0.1, "critical_distance = 0.1: belongs to direction = 'GMTS'"),
        ("GMTS", 0.0, "critical_distance = 0.0: must be a positive length"),
        ("GMTS", math.nan, "critical_distance = nan: must be a positive length"),
    ],
)
def test_what_makes_no_criterion_is_refused(name, distance, says):
    with pytest.raises(ValueError, match=says):
        direction_of(name, PMMA, distance)
