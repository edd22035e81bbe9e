"""Where an index is small or zero its estimated error still is what the stress around leaves: an error in MPa."""

import json
from pathlib import Path

import numpy as np
import pytest

from slmm import Scene, failure_indices
from slmm.criteria.coupled_curves import criticals
from slmm.criteria.path_curves import PathCurves
from slmm.mechanics.material import Material
from slmm.scene import gallery

CASE = Path(__file__).parents[3] / "shared" / "cases" / "r17-error-estimate-too-small" / "scene.json"
MATERIAL = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.01)


def curves_of(sigma, sigma_error):
    a = np.linspace(0.0, 1.0, len(sigma))[None]
    return PathCurves(a, 0.1 * a, np.array([sigma]), np.full(a.shape, 0.01), np.array([sigma_error]))


def test_cells_cover_their_error_where_the_surface_stress_all_but_vanishes():
    """Full FEA has 0.01066 at this position; cells have 0.0004 where the field around leaves them +- 0.02."""
    result = failure_indices(Scene.from_dict(json.loads(CASE.read_text())), "slmm+ac").isel(position=-1)
    assert abs(float(result.failure_index) - 0.01066) < float(result.failure_index_error)


def test_dislocations_cover_theirs():
    pytest.importorskip("netgen")
    result = failure_indices(Scene.from_dict(json.loads(CASE.read_text())), "dislocations").isel(position=-1)
    assert abs(float(result.failure_index) - 0.01066) < float(result.failure_index_error) < 0.003


def test_the_error_is_that_of_the_stress_that_limits_the_crack():
    """The stress rises from 0.01 MPa at the mouth, where it is known to 0.5 MPa: so is the stress over the crack."""
    sigma = 0.01 + np.linspace(0.0, 20.0, 201)
    found = criticals(curves_of(sigma, 0.5 / sigma), MATERIAL, False)
    index = 1 / found.load_factor[0]
    assert found.error[0] * index == pytest.approx(0.5 / MATERIAL.sigma_c, rel=0.01)


@pytest.mark.parametrize(("at_mouth", "allowed"), [(-0.1, 0.04), (-3.0, 0.0)])
def test_an_index_of_zero_has_the_error_that_the_stress_leaves(at_mouth, allowed):
    sigma = at_mouth + np.linspace(0.0, -20.0, 201)
    found = criticals(curves_of(sigma, 0.5 / np.abs(sigma)), MATERIAL, False)
    assert np.isinf(found.load_factor[0])
    assert found.error[0] == pytest.approx(allowed)


def test_a_method_without_estimates_has_none_for_zero_either():
    sigma = np.full(201, -1.0)
    assert np.isnan(criticals(curves_of(sigma, np.full(201, np.nan)), MATERIAL, False).error[0])


def test_every_surface_stress_has_an_error_also_under_compression():
    scene = gallery.circular_hole(load={"stress": 20.0}, analysis={"positions": 16, "voxels": 40000})
    for method in ("rankine", "mises"):
        result = failure_indices(scene, method)
        ok = result.status == "ok"
        assert ok.all() and np.isfinite(result.failure_index_error).all()
    # at the poles Kirsch's hoop stress is -20 MPa, in a wide plate
    poles = result.isel(position=[4, 12])
    assert np.all(poles.failure_index_error > 0)
