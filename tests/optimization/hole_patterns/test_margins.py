"""Margins of designs: tails by hand, steps that part, shifts and forks."""

import numpy as np
import pytest
import xarray as xr

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.margins import (
    SHIFTS,
    hinging_share,
    parted_at,
    parted_upside_down,
    spread_of,
)

ONE = HolePattern(1, "full", increment=4.0, sides="left")


def steps(*events):
    """A simulation with so many steps, of kind, x and y."""
    kinds, x, y = zip(*events, strict=True)
    data = {"event": ("step", np.array(kinds)), "x": ("step", list(x)), "y": ("step", list(y))}
    return xr.Dataset(data, attrs={"increment": 2.0})


def test_a_tail_is_what_comes_when_the_force_stays_low():
    u = np.array([0.0, 1.0, 1.0, 1.5, 1.5, 3.5, 3.5])
    F = np.array([0.0, 10.0, 0.5, 2.0, 0.1, 0.8, 0.0])
    # the rise to 2 N is no tail, for all that the force was at 0.5 N before
    assert hinging_share(u, F) == pytest.approx(0.9 / (5 + 0.625 + 0.9))
    assert hinging_share(u[:3], F[:3]) == 0.0
    assert hinging_share(2 * u, 3 * F) == pytest.approx(hinging_share(u, F))


def test_steps_part_where_another_event_or_place_comes():
    one = steps(("growth", 12.0, 40.0), ("start", 30.0, 41.0), ("growth", 32.0, 41.5))
    assert parted_at(one, one) == -1
    assert parted_at(one, steps(("growth", 12.0, 40.0), ("growth", 30.0, 41.0))) == 1
    assert parted_at(one, steps(("growth", 12.0, 40.0), ("start", 30.0, 41.9))) == 2
    assert parted_at(one, steps(("growth", 12.0, 40.0), ("start", 30.0, 42.1))) == 1
    mirrored = steps(("growth", 12.0, 40.0), ("start", 30.0, 39.0), ("growth", 32.0, 38.5))
    assert parted_at(one, mirrored, upside_down=80.0) == -1 and parted_at(one, mirrored) == 1
    # of a symmetric plate the lower side goes first, upside down or not
    assert parted_upside_down(one, one, 80.0) == parted_upside_down(one, mirrored, 80.0) == -1
    assert parted_upside_down(one, steps(("growth", 12.0, 40.0)), 80.0) == 1


def test_a_change_counts_where_it_changes_what_counts():
    U_T = np.array([400.0, 500.0])
    assert spread_of(U_T, np.array([[400.0, 400.0], [450.0, 600.0]])) == 0.0
    assert spread_of(U_T, np.array([[400.0, 400.0], [450.0, 590.0]]), "mean") == pytest.approx(0.1)


def test_a_plate_with_one_hole_has_no_fork_and_the_margins_of_its_simulations():
    found = ONE.margins([[True]])
    upright = ONE.tensile_toughness([[True]])
    assert found.U_T.values.tolist() == upright.tolist()
    np.testing.assert_allclose(found.U_T_upside_down, upright, rtol=found.attrs["numerical_error"] + 1e-12)
    np.testing.assert_allclose(found.U_T_finer, upright, rtol=2e-3)
    assert found.U_T_shifted.shape == (1, 2) and found.shift_y.values.tolist() == list(SHIFTS)
    assert not found.attrs["forks"] and found.attrs["spread"] < 0.005
    assert found.attrs["margin"] == ONE.level_set(np.array([[True]])).margin()
    # upwards and downwards are mirror images
    down, up = found.U_T_shifted.values[0]
    assert down == pytest.approx(up, rel=2e-3)


def test_shifted_holes_are_where_they_should_be():
    whole = np.eye(3, dtype=bool)
    before, moved = (ONE.plate.scene(whole, shift).outlines for shift in ((0.0, 0.0), (1.0, -0.5)))
    for one, other in zip(before, moved, strict=True):
        np.testing.assert_allclose(one.polygon(50) + np.array([1.0, -0.5]), other.polygon(50), atol=1e-9)
