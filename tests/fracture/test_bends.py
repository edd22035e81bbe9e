"""How paths bend: increments that lead their next turn ahead stay on smooth paths, and kinks are no bends."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.fracture import simulate
from slmm.fracture.bends import Bend, ahead, bend_at
from slmm.fracture.events import Event, Kind
from slmm.fracture.history import Step
from slmm.scene.gallery import tensile_plate


def growth(point, angle):
    return Event(
        1.0, Kind.GROWTH, np.asarray(point, float), np.array([math.cos(angle), math.sin(angle)]), tip=0
    )


def step(event, end, crack=0):
    length = float(np.linalg.norm(np.subtract(end, event.point)))
    return Step(1.0, 1.0, event, crack, tuple(map(float, end)), "", length, math.nan, False, ())


def steps_along(angles, length=1.0):
    """Increments of one length in directions, and the place that they lead to."""
    steps, at = [], np.zeros(2)
    for angle in angles:
        event = growth(at, angle)
        at = at + length * event.direction
        steps.append(step(event, at))
    return steps, at


@given(st.floats(-0.2, 0.2), st.floats(0.1, 10.0))
def test_on_an_arc_the_rate_is_its_curvature(turn, length):
    steps, at = steps_along(turn * np.arange(4), length)
    bend = bend_at(steps, growth(at, 4 * turn))
    assert bend.turned == pytest.approx(turn, abs=1e-12)
    assert bend.rate == pytest.approx(turn / length, abs=1e-12)


def test_increments_that_lead_ahead_stay_on_an_arc():
    """Chords of an arc of radius 10 lead half of the next turn ahead of the tangent, and end on it to third order."""
    tangent, bend = np.array([1.0, 0.0]), Bend(0.0, 0.1)
    off = []
    for length in (2.0, 1.0):
        end = length * ahead(tangent, bend, length)
        off.append(abs(np.hypot(end[0], end[1] - 10.0) - 10.0))
    assert off[0] < 1e-3 * 2.0 and off[0] / off[1] > 7.0
    straight = np.hypot(2.0, 10.0) - 10.0
    assert off[0] < 0.01 * straight


@given(st.floats(0.01, 0.5), st.floats(0.01, 0.5))
def test_turns_to_different_sides_are_corrections_and_none_is_expected(one, other):
    steps, at = steps_along([1.0, 0.0, one])
    assert bend_at(steps, growth(at, one - other)).rate == 0.0


@given(st.floats(0.01, 0.5), st.floats(0.01, 0.5))
def test_of_two_rates_the_slower_one_counts(one, other):
    steps, at = steps_along([1.0, 0.0, one])
    assert bend_at(steps, growth(at, one + other)).rate == pytest.approx(min(one, other))


def test_the_first_kink_of_a_crack_is_no_bend():
    assert bend_at([], growth([0.0, 0.0], 1.0)) == Bend(0.0, 0.0)
    steps, at = steps_along([1.0])
    assert bend_at(steps, growth(at, 1.2)) == Bend(0.0, 0.0)
    steps, at = steps_along([1.0, 1.1])
    bend = bend_at(steps, growth(at, 1.2))
    assert bend.turned == pytest.approx(0.1) and bend.rate == 0.0


def test_the_other_tip_of_a_crack_and_other_cracks_do_not_count():
    steps, at = steps_along([0.0, 0.1, 0.2, 0.3])
    others = [step(growth([50.0, 50.0 + k], -0.3 * k), [51.0, 50.0 + k]) for k in range(3)]
    mixed = [each for pair in zip(steps, [*others, others[0]], strict=True) for each in pair]
    event = growth(at, 0.4)
    assert bend_at(mixed, event) == bend_at(steps, event) != Bend(0.0, 0.0)


@given(st.lists(st.floats(-0.3, 0.3), min_size=4, max_size=4), st.floats(-3.0, 3.0))
def test_turned_and_mirrored_paths_bend_alike(angles, turn):
    steps, at = steps_along(np.cumsum(angles))
    bend = bend_at(steps, growth(at, sum(angles)))
    turned, its = steps_along(np.cumsum(angles) + turn)
    assert bend_at(turned, growth(its, sum(angles) + turn)) == pytest.approx(bend, abs=1e-9)
    mirrored, its = steps_along(-np.cumsum(angles))
    assert bend_at(mirrored, growth(its, -sum(angles))) == pytest.approx([-x for x in bend], abs=1e-9)


def test_increments_chosen_by_themselves_go_the_way_of_much_finer_ones_past_a_hole():
    """Fixed ones follow the tangent where they begin and are off in the first order: the limit of 1 and 0.5 mm."""
    scene = tensile_plate([(40.0, 58.0, 8.0)]).with_(material={"sigma_c": 1000.0})
    x = np.linspace(15.0, 75.0, 61)

    def path(increment):
        result = simulate(scene, increment, errors=False)
        known = np.isfinite(result.crack_x.values[0])
        return np.interp(x, result.crack_x.values[0, known], result.crack_y.values[0, known]), known.sum()

    (coarse, _), (fine, most), (chosen, few) = (path(increment) for increment in (1.0, 0.5, "auto"))
    limit = 2 * fine - coarse
    assert np.ptp(limit) > 4.0  # it bends
    assert np.abs(fine - limit).max() == pytest.approx(np.abs(coarse - limit).max() / 2, rel=0.2)
    assert np.abs(chosen - limit).max() < 0.1
    assert few < most / 4
