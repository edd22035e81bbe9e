"""Crack cells are converged, voxels near a body-fitted model."""

import numpy as np
import pytest
from scripts import script


@pytest.mark.slow
def test_crack_cells_are_converged_and_interpolate():
    crack_cells = script("crack_cells")
    for row in crack_cells.mesh_study((-0.5,), (0.3,)):
        assert row["G_inc error"] < 2e-3 and row["stress error"] < 2e-3
    for row in crack_cells.interpolation_study((-0.25,), (0.35,)):
        assert row["G_inc error"] < 1e-3 and row["stress error"] < 1e-3
        assert row["eigenvalue"] > -1e-12


@pytest.mark.slow
def test_voxel_displacements_agree_with_a_body_fitted_model():
    rows = script("voxel_solver").displacement_errors((125,))
    two_away = next(row for row in rows if row["voxels_away"] == 2.0)
    assert np.asarray(two_away["error_rms"]) < 0.15


@pytest.mark.slow
def test_random_voxel_problems_converge_or_are_refused():
    checks = script("voxel_robustness").main(quick=True)
    assert len(checks) == 3
    for check in checks:
        assert check.holds, check
