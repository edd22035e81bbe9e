"""The body-fitted local model: Kirsch's and Inglis's stress, and an error that covers the true one."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.initiation.body_fitted import VOXELS_PER_ELEMENT, notch_stress, solve_body_fitted
from slmm.scene import gallery

pytest.importorskip("netgen")


@pytest.fixture(scope="module")
def hole():
    scene = gallery.circular_hole(2.0, 400.0, load={"stress": 1.0})
    return scene, solve_body_fitted(scene)


def test_stress_around_a_hole_is_kirschs_and_the_estimate_covers_the_error(hole):
    scene, model = hole
    (stress,) = notch_stress(model, scene.outlines, n=48)
    angle = np.arctan2(stress.points[:, 1] - 200, stress.points[:, 0] - 200)
    hoop = 1 + 2 * np.cos(2 * angle)
    tension = hoop > 0.1
    error = np.abs(stress.sigma_I - hoop)[tension]
    assert error.max() < 3e-3 * 3
    assert np.mean(error <= stress.sigma_I_error[tension] + 1e-3) > 0.95


def test_stress_at_the_tip_of_an_ellipse_is_ingliss():
    holes = [{"shape": "ellipse", "center": [200.0, 200.0], "semi_axes": [4.0, 1.0]}]
    scene = gallery.circular_hole(4.0, 400.0, holes=holes, load={"stress": 1.0})
    sigma, error = solve_body_fitted(scene).stress(np.array([[204.0, 200.0]]))
    assert sigma[0, 1] == pytest.approx(9.0, rel=5e-3) and error[0] < 0.05


def test_there_is_no_stress_in_the_hole(hole):
    _, model = hole
    sigma, _ = model.stress(np.array([[200.0, 200.0], [203.0, 200.0]]))
    assert np.isnan(sigma[0]).all() and np.isfinite(sigma[1]).all()


def test_the_coarser_field_is_that_of_the_coarser_mesh(hole):
    _, model = hole
    points = np.array([[202.5, 200.0], [200.0, 204.0]])
    coarse, fine = model.coarser, model
    assert coarse.displacement(points) == pytest.approx(fine.displacement(points), rel=1e-3)
    assert not np.array_equal(coarse.displacement(points), fine.displacement(points))
    assert coarse.resolution(points) == pytest.approx(2 * fine.resolution(points), rel=0.01)
    assert fine.resolution(points) * VOXELS_PER_ELEMENT == pytest.approx(fine.fine.element_size(points))


def test_points_asked_to_be_fine_are_more_accurate():
    scene = gallery.elliptic_hole(load={"stress": 1.0})
    tip = np.array([[70.0, 50.0]])
    rough, fine = (
        solve_body_fitted(scene, angle_max=0.4, fine_at=where).stress(tip)
        for where in (None, (tip, np.array([0.05])))
    )
    reference = solve_body_fitted(scene, angle_max=0.05).stress(tip)[0]
    assert np.abs(fine[0] - reference).max() < 0.5 * np.abs(rough[0] - reference).max()


def test_cells_on_a_mesh_give_what_cells_on_voxels_give():
    scene = gallery.circular_hole(analysis={"points": [[70.0, 50.0]]})
    on_mesh = scene.with_(analysis={"local_model": "body-fitted"})
    voxels, mesh = (failure_indices(s, "slmm+ac").isel(position=0) for s in (scene, on_mesh))
    assert float(mesh.failure_index) == pytest.approx(float(voxels.failure_index), rel=0.01)
    assert mesh.attrs["local_model"] == "body-fitted" and voxels.attrs["local_model"] == "voxels"
