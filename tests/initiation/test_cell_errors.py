"""Estimates of a crack cell's errors: they grow with each thing seen to matter, and never vanish."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm import failure_indices
from slmm.initiation.cell_errors import (
    ENERGY_FLOOR,
    STRESS_FLOOR,
    energy_error,
    reference_stress,
    relative_change,
    stress_error,
)
from slmm.scene import gallery

change = st.floats(0.0, 1.0)


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        ({"strain": [0.01, -0.02, 0.0]}, 3 * 2960 * 0.02),
        ({"displacement": -0.5}, 3 * 2960 * 0.005),
        ({"stress": -7.0}, 21.0),
    ],
)
def test_reference_stress_is_that_of_a_hole_under_the_load(load, expected):
    assert reference_stress(gallery.circular_hole(load=load)) == pytest.approx(expected)


def test_relative_change_stays_a_change_of_stress_where_the_stress_vanishes():
    new, old = np.array([2.0, 1.0, 0.0, 0.0, -1.0]), np.array([1.0, 1.0, 0.0, 5.0, 9.0])
    assert (relative_change(new, old) * np.maximum(np.abs(new), 1e-300)).tolist() == [
        1.0,
        0.0,
        0.0,
        5.0,
        10.0,
    ]
    assert relative_change(np.array([1e-6]), np.array([3.0])) == pytest.approx(3e6)


@given(of_cell=change, of_model=change, fade=st.floats(1.0, 1e3))
def test_stress_is_never_said_to_be_exact(of_cell, of_model, fade):
    error = stress_error(*(np.array([[x]]) for x in (of_cell, of_model, fade)))[0, 0]
    assert error >= STRESS_FLOOR
    more = stress_error(*(np.array([[x]]) for x in (of_cell + 0.1, of_model, fade)))[0, 0]
    assert more > error


@given(of_cell=change, of_model=change, bracket=st.floats(-0.1, 9.0), support=st.floats(-0.5, 1.0))
def test_energy_is_never_said_to_be_exact_and_a_wide_cell_is_trusted_less(
    of_cell, of_model, bracket, support
):
    def error(wide):
        arrays = (np.array([[x]]) for x in (of_cell, of_model, 1.0, bracket))
        return energy_error(*arrays, np.array([support]), wide)[0, 0]

    assert ENERGY_FLOOR <= error(False) < error(True)


def test_coarser_voxels_are_said_to_be_less_accurate_and_are():
    estimates, errors = [], []
    scene = gallery.circular_hole(analysis={"points": [[70.0, 50.0]]})
    truth = float(failure_indices(scene, "dislocations").failure_index[0])
    for n in (64, 512):
        result = failure_indices(scene.with_(analysis={"voxels": n * n}), "slmm+ac").isel(position=0)
        estimates.append(float(result.failure_index_error) / truth)
        errors.append(abs(float(result.failure_index) / truth - 1))
    assert estimates[0] > estimates[1] and errors[0] > errors[1]
    assert all(error < estimate for error, estimate in zip(errors, estimates, strict=True))


def test_the_papers_settings_have_no_estimate():
    scene = gallery.circular_hole(analysis={"points": [[70.0, 50.0]]})
    result = failure_indices(scene, "slmm+ac", settings="published")
    assert result.status.values.tolist() == ["ok"] and np.isnan(result.failure_index_error[0])
