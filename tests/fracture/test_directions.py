"""Directions by the name of their criterion."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.fracture.directions import DIRECTIONS, along_J

RATIOS = st.floats(-2.0, 2.0)


@pytest.mark.parametrize("name", DIRECTIONS)
def test_mode_I_runs_straight(name):
    assert DIRECTIONS[name](1.0, 0.0) == pytest.approx(0.0, abs=1e-12)


@given(RATIOS, st.sampled_from(sorted(DIRECTIONS)), st.floats(0.1, 100.0))
def test_mirrored_loads_turn_cracks_the_other_way_whatever_their_size(K_II, name, size):
    one, other = DIRECTIONS[name](1.0, K_II), DIRECTIONS[name](size, -size * K_II)
    assert one == pytest.approx(-other, abs=1e-9)


@given(st.floats(1e-4, 1e-2), st.sampled_from(sorted(DIRECTIONS)))
def test_all_agree_where_there_is_little_mode_II(K_II, name):
    """To first order the kink is -2 K_II/K_I for every one of them; what is left is of the third."""
    assert DIRECTIONS[name](1.0, K_II) == pytest.approx(-2 * K_II, abs=10 * K_II**3)


def test_J_is_the_vector_of_its_components():
    assert along_J(2.0, 1.0) == pytest.approx(math.atan2(-4.0, 5.0))
