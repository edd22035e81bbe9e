"""Increments: long on straight stretches, short where a path bends or a surface is near, or as they were asked for."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.fracture.lengths import GROWTH, LONGEST, OFF_PATH, SHORTEST, Lengths, lengths_of
from slmm.part.part import Part

AUTO = Lengths(2.0, 2.0, 0.75, by_path=True)
FAR = 1e3


def along(lengths, kink, last=2.0, room=FAR, grown=True, rising=False, turned=0.0):
    line = np.array([[-last, 0.0], [0.0, 0.0]])
    return lengths.along(line, grown, np.array([math.cos(kink), math.sin(kink)]), turned, room, rising)


@given(st.floats(0.01, 1.5), st.floats(0.2, 16.0))
def test_a_chord_cuts_no_more_off_a_bend_than_is_allowed(kink, last):
    """An arc of the curvature that the kink shows leaves its tangent by k h^2/2."""
    h = along(AUTO, kink, last)
    assert h * h * kink / last / 2 <= OFF_PATH * AUTO.growth * (1 + 1e-12) or h == SHORTEST * AUTO.growth


@given(st.floats(0.0, 1.5), st.floats(-1.5, 1.5), st.floats(0.2, 16.0))
def test_a_bend_shows_as_a_kink_or_as_what_the_direction_has_turned(kink, turned, last):
    expected = along(AUTO, max(kink, abs(turned)), last)
    assert along(AUTO, kink, last, turned=turned) == pytest.approx(expected, rel=1e-12)


@given(st.floats(-1.5, 1.5), st.floats(0.2, 16.0), st.floats(0.01, 100.0))
def test_either_way_alike_and_within_limits(kink, last, room):
    h = along(AUTO, kink, last, room)
    assert h == pytest.approx(along(AUTO, -kink, last, room), rel=1e-12)
    assert SHORTEST * 2.0 <= h <= min(GROWTH * last, LONGEST * 2.0) or h == SHORTEST * 2.0
    assert h <= max(room, SHORTEST * 2.0)


def test_straight_stretches_are_taken_in_strides_that_double():
    h = [2.0]
    for _ in range(5):
        h.append(along(AUTO, 0.0, h[-1]))
    assert h == [2.0, 4.0, 8.0, 16.0, 16.0, 16.0]


def test_while_the_load_rises_strides_do_not():
    assert along(AUTO, 0.0, 8.0, rising=True) == AUTO.growth


def test_the_kink_of_an_initial_crack_counts_over_the_first_increment():
    assert along(AUTO, 0.2, last=40.0, grown=False) == pytest.approx(along(AUTO, 0.2, last=2.0))


@pytest.mark.parametrize("size", [1.0, 25.0])
def test_lengths_scale_with_the_part(size):
    plate = Part.plate(80.0 * size, 120.0 * size)
    lengths = lengths_of(plate, "auto", None, 0.375)
    assert lengths == Lengths(2.0 * size, 2.0 * size, 0.75 * size, by_path=True)
    assert along(lengths, 0.3, 2.0 * size) == pytest.approx(size * along(AUTO, 0.3))


@pytest.mark.parametrize("increment", [0.0, -1.0, math.nan, 80.0, "long"])
def test_what_is_no_increment_is_refused_by_name(increment):
    with pytest.raises(ValueError, match="increment = "):
        lengths_of(Part.plate(80.0, 80.0), increment, None, 0.375)
