"""Boundary integrals as local model: strength, critical distances and crack cells without voxels or a mesh."""

import numpy as np
import pytest

from slmm import Scene, failure_indices
from slmm.initiation.boundary_field import solve_boundary
from slmm.initiation.uncracked import UncrackedField, WithStress
from slmm.scene import gallery


def by(scene, local_model, method, **options):
    return failure_indices(
        scene.with_(analysis={"local_model": local_model}), method, positions=16, **options
    )


@pytest.mark.parametrize("make", [gallery.circular_hole, gallery.elliptic_hole, gallery.lobed_notch])
def test_surface_stress_agrees_with_a_body_fitted_mesh_within_both_estimates(make):
    pytest.importorskip("netgen")
    scene = make()
    for method in ("rankine", "point"):
        mesh, lines = by(scene, "body-fitted", method), by(scene, "boundary", method)
        i = int(np.nanargmax(mesh.failure_index))
        x, y = float(mesh.x[i]), float(mesh.y[i])
        at = int(np.hypot(lines.x - x, lines.y - y).argmin())
        gap = abs(float(lines.failure_index[at] - mesh.failure_index[i]))
        assert gap <= float(lines.failure_index_error[at] + mesh.failure_index_error[i])


def test_kirschs_stress_on_the_surface_of_a_hole():
    scene = gallery.circular_hole(1.0, 200.0, load={"stress": 1.0})
    result = failure_indices(
        scene.with_(analysis={"local_model": "boundary", "points": [[101.0, 100.0], [100.0, 101.0]]}),
        "rankine",
    )
    index = result.failure_index.values * scene.material.sigma_c
    assert index[0] == pytest.approx(3.0, rel=4e-4)  # the plate is 200 radii wide
    assert result.attrs["local_model"] == "boundary"


def test_crack_cells_take_their_displacements_from_it():
    scene = gallery.circular_hole()
    voxels, lines = by(scene, "voxels", "slmm+ac"), by(scene, "boundary", "slmm+ac")
    assert float(lines.failure_index.max()) == pytest.approx(float(voxels.failure_index.max()), rel=0.01)


def test_the_field_is_what_predictions_ask_for():
    field = solve_boundary(gallery.circular_hole())
    assert isinstance(field, UncrackedField) and isinstance(field, WithStress)
    corners = np.array([[0.0, 0.0], [100.0, 100.0], [70.0, 50.0]])
    u = field.displacement(corners)
    assert u[:2] == pytest.approx(np.array([[0.0, 0.0], [0.0, 10.0]]), abs=1e-6)
    assert np.isfinite(field.stress(corners)[0]).all()
    assert field.coarser is not None and field.coarser.displacement(corners) == pytest.approx(u, abs=1e-4)


def test_notches_across_the_edge_have_their_stress_too():
    pytest.importorskip("netgen")
    scene = gallery.v_notch(radius=0.5)
    mesh, lines = by(scene, "body-fitted", "rankine"), by(scene, "boundary", "rankine")
    assert float(lines.failure_index.max()) == pytest.approx(float(mesh.failure_index.max()), rel=0.01)


def test_scenes_with_cracks_have_their_stress_too():
    crack = {"points": [[0.0, 20.0], [15.0, 20.0]]}
    scene = gallery.circular_hole().with_(cracks=[crack])
    assert isinstance(scene, Scene)
    result = by(scene, "boundary", "rankine")
    known = np.isfinite(result.failure_index.values)
    assert known.sum() >= 16 and result.failure_index.values[known].max() > 1
