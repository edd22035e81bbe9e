"""Where a position has no value, its index has an upper bound, which the verdict goes by."""

import numpy as np
import pytest

import slmm
from slmm.initiation.summary import verdict
from slmm.initiation.verdict import conclude
from slmm.scene import gallery

CASES = "../shared/cases/01-verdict-without-values"


@pytest.fixture(scope="module")
def two_holes():
    return slmm.read_scene(f"{CASES}/two_holes.toml")


def test_the_ligament_without_a_cell_leaves_no_verdict(two_holes):
    result = slmm.failure_indices(two_holes, "slmm+ac", positions=8)
    missing = result.status != "ok"
    assert missing.any() and float(result.failure_index.max()) < 0.5
    # full FEA: 1.2531
    assert 1.25 < float(result.failure_index_bound[missing].max()) < 1.4
    assert conclude(result).is_open
    assert 'ask method "auto"' in verdict(result)


def test_the_default_method_answers_there(two_holes):
    result = slmm.failure_indices(two_holes, positions=8)
    assert result.attrs["method"] == "auto" and (result.status == "ok").all()
    assert float(result.failure_index.max()) == pytest.approx(1.2531, rel=2e-3)
    assert "A crack starts there" in verdict(result)
    assert "trial cracks at once" in result.attrs["cost"]


def test_a_bound_lies_above_the_value(two_holes):
    values = slmm.failure_indices(two_holes, "slmm+ac", positions=8)
    ok = values.status == "ok"
    assert (values.failure_index_bound[ok] >= values.failure_index[ok]).all()
    truth = slmm.failure_indices(
        two_holes.with_(analysis={"points": [[49.75, 50.0], [50.25, 50.0]]}), "full-fea"
    )
    missing = values.failure_index_bound[~ok].max()
    assert float(missing) > float(truth.failure_index.max())


def test_a_tough_material_that_no_method_answers_is_safe_by_its_strength():
    scene = slmm.read_scene(f"{CASES}/tough.toml")
    result = slmm.failure_indices(scene, "slmm+ac", positions=8)
    assert (result.status != "ok").any()
    # three times the stress of 10 MPa over 70.5 MPa, and a little for the plate's width
    assert float(result.failure_index_bound.max()) == pytest.approx(30.8 / 70.5, rel=0.02)
    assert "No crack starts under this load" in verdict(result) and not conclude(result).is_open
    assert conclude(slmm.failure_indices(scene.with_(load={"stress": 30.0}), "slmm+ac", positions=8)).is_open


def test_a_mean_stress_is_bounded_by_the_largest_on_the_path():
    tough = {"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "K_Ic": 28.0}
    scene = gallery.circular_hole(load={"stress": 1.0}, material=tough)
    averaged = slmm.failure_indices(scene, "slmm+ac", positions=4, average=True)
    missing = averaged.status != "ok"
    assert missing.any()
    largest = slmm.failure_indices(scene, "rankine", positions=4).failure_index.max()
    assert float(averaged.failure_index_bound[missing].max()) == pytest.approx(float(largest), rel=0.02)


def test_nothing_bounds_a_corner_or_what_knows_no_strength():
    scene = gallery.square_hole()
    cells = slmm.failure_indices(scene, "slmm+ac", positions=4)
    corner = cells.status == "no cell: sharp corner"
    assert corner.any() and np.isinf(cells.failure_index_bound[corner]).all()
    assert conclude(cells).is_open or float(cells.failure_index.max()) >= 1
    griffith = slmm.failure_indices(gallery.edge_crack(), "griffith")
    assert np.isfinite(griffith.failure_index_bound[griffith.status == "ok"]).all()


def test_without_the_mesher_boundary_integrals_bound_what_has_no_value(monkeypatch):
    from slmm.initiation import bounds

    scene = gallery.circular_hole(
        5.0,
        material={"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "K_Ic": 40.0},
        load={"strain": [0.0, 0.005, 0.0]},
    )
    meshed = slmm.failure_indices(scene, "slmm+ac", positions=8)
    monkeypatch.setattr(bounds, "find_spec", lambda name: None)
    result = slmm.failure_indices(scene, "slmm+ac", positions=8)
    missing = result.status.values != "ok"
    assert missing.any()
    found = result.failure_index_bound.values[missing]
    np.testing.assert_allclose(found, meshed.failure_index_bound.values[missing], rtol=0.01, atol=1e-3)
