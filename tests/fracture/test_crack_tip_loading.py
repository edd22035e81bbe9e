"""The loading of all crack tips of a model: what is known, what is not, and why."""

from dataclasses import replace

import numpy as np
import pytest

from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fracture.loading import CLOSED, CRITERIA, NO_ELASTICITY, OK, crack_tip_loading
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import linear_elastic
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading

PMMA = Material.from_name("PMMA")


def cracked_plate(crack=((0.0, 40.0), (20.0, 40.0)), thickness=1.0, height=80.0, **load):
    mesh = plate_mesh(Part.plate(80.0, height, cracks=[crack]))
    loading = plate_loading(80.0, height, **(load or {"stress": 1.0}))
    return PlateModel(mesh, PMMA, loading, thickness).results


def test_an_edge_crack_in_tension_runs_straight_on():
    loading = crack_tip_loading(cracked_plate(((0.0, 200.0), (24.0, 200.0)), height=400.0))
    assert loading.status.values.tolist() == [OK]
    tip = loading.isel(tip=0)
    # a/W = 0.3, a p-version solution with 1e-4
    assert float(tip.K_I) / np.sqrt(np.pi * 24) == pytest.approx(1.6599, rel=3e-3)
    assert float(tip.G) == pytest.approx(float(tip.K_I) ** 2 / PMMA.E, rel=1e-3)
    assert float(tip.spread) < 2e-3
    assert np.abs(tip.kink).max() < 0.3
    assert tip.criterion.values.tolist() == list(CRITERIA)
    assert {name: tip[name].attrs["units"] for name in ("G", "K_I", "kink", "radius")} == {
        "G": "N/mm",
        "K_I": "MPa sqrt(mm)",
        "kink": "degree",
        "radius": "mm",
    }


def test_all_criteria_turn_the_crack_out_of_the_shear():
    crack = [[26.0, 33.0], [54.0, 47.0]]
    loading = crack_tip_loading(cracked_plate(crack))
    assert loading.sizes["tip"] == 2
    assert (loading.K_II > 0).all()
    assert (loading.kink < -15).all()
    # both tips of a symmetric crack are loaded alike
    np.testing.assert_allclose(loading.K_I[0], loading.K_I[1], rtol=2e-3)
    np.testing.assert_allclose(loading.kink[0], loading.kink[1], atol=0.3)
    # the J vector's length and direction in the plate's axes are those in the crack's
    J = np.hypot(loading.J_x, loading.J_y).median("contour")
    np.testing.assert_allclose(J, np.hypot(loading.G, loading.J_across), rtol=2e-3)


def test_the_release_rate_is_per_area_whatever_the_thickness():
    thin, thick = (crack_tip_loading(cracked_plate(thickness=t)) for t in (1.0, 7.0))
    np.testing.assert_allclose(thick.G, thin.G, rtol=1e-12)
    np.testing.assert_allclose(thick.K_I, thin.K_I, rtol=1e-12)


def test_a_crack_pressed_together_says_so():
    loading = crack_tip_loading(cracked_plate(strain=(0.0, -0.001, 0.0)))
    assert loading.status.values.tolist() == [CLOSED]
    assert float(loading.K_I[0]) < 0
    assert loading.kink.isnull().all()


def test_without_elasticity_the_release_rate_is_all():
    results = cracked_plate()
    loading = crack_tip_loading(replace(results, elasticity=()))
    assert loading.status.values.tolist() == [NO_ELASTICITY]
    np.testing.assert_allclose(loading.G, crack_tip_loading(results).G, rtol=1e-12)
    assert loading.K_I.isnull().all()
    assert loading.J_across.isnull().all()


def test_a_mesh_too_coarse_around_the_tip_says_so():
    # two by two elements, slit to the middle: one edge between the tip and the boundary
    points = np.array([[x, y] for y in (-1, 0, 1) for x in (-1, 0, 1)] + [[-1, 0]], dtype=float)
    cells = {"CPE4": np.array([[0, 1, 4, 3], [1, 2, 5, 4], [9, 4, 7, 6], [4, 5, 8, 7]])}
    results = linear_elastic(points, cells, 1e-3 * points * [0, 1], Elasticity(1000.0, 0.3))
    loading = crack_tip_loading(results)
    assert loading.status.values.tolist() == [
        "fewer than 4 edges of elements between the tip and what lies next to it: mesh too coarse"
    ]
    assert loading.G.isnull().all()


def test_the_material_is_that_at_the_tip():
    """Two halves of one material, told apart, and of which the far one is called another: nothing changes."""
    results = cracked_plate()
    far = results.points[results.cells["CPE6"]][..., 0].min(axis=1) > 60
    mixed = replace(
        results,
        region={"CPE6": far.astype(int)},
        elasticity=(results.elasticity[0], Elasticity(1.0, 0.0, "plane stress")),
    )
    np.testing.assert_allclose(crack_tip_loading(mixed).K_I, crack_tip_loading(results).K_I, rtol=1e-12)


def test_a_body_without_cracks_has_no_tips_and_bad_requests_are_refused():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    whole = linear_elastic(points, {"CPE4": np.array([[0, 1, 2, 3]])}, 0 * points, Elasticity(1.0, 0.0))
    assert crack_tip_loading(whole).sizes["tip"] == 0
    with pytest.raises(ValueError, match="contours = 0: must be 1 at least"):
        crack_tip_loading(whole, contours=0)
    solid = replace(whole, points=np.zeros((4, 3)))
    with pytest.raises(ValueError, match="plane models"):
        crack_tip_loading(solid)
