"""Holes that are tiny against the plate: the methods agree, and a mesher that fails costs its positions alone."""

from pathlib import Path

import numpy as np
import pytest

from slmm import failure_indices, read_scene
from slmm.fem.triangulation import MesherError
from slmm.scene import gallery

pytest.importorskip("netgen")

CASES = Path(__file__).parents[3] / "shared" / "cases"


@pytest.fixture
def no_mesh(monkeypatch):
    def never(*_):
        raise MesherError("the mesher failed: meshing failed")

    monkeypatch.setattr("slmm.fem.mesh.triangulated", never)


@pytest.mark.parametrize(("case", "index"), [("23-auto-tiny-hole", 0.2842), ("24-mesher-failed", 0.2966)])
@pytest.mark.parametrize("method", ["auto", "dislocations"])
def test_a_tiny_hole_has_the_index_of_full_fea_on_both_sides(case, index, method):
    result = failure_indices(read_scene(CASES / case / "a.toml"), method)
    assert result.failure_index.values == pytest.approx(index, rel=1e-3)
    assert np.all(np.abs(result.failure_index - index) <= result.failure_index_error + 1e-4)


@pytest.mark.parametrize("per_side", [20, 300, 2000])
def test_auto_covers_its_error_however_small_the_hole(per_side):
    scene = gallery.circular_hole(100.0 / per_side, load={"stress": 20.0})
    side = scene.outlines[0].points(np.array([0.0])).tolist()
    scene = scene.with_(analysis={"points": side})
    auto, dislocations = (
        failure_indices(scene, method).isel(position=0) for method in ("auto", "dislocations")
    )
    difference = abs(float(auto.failure_index - dislocations.failure_index))
    assert difference <= float(auto.failure_index_error + dislocations.failure_index_error)


@pytest.mark.parametrize("method", ["dislocations", "full-fea", "asymptotics", "rankine", "slmm+ac"])
def test_a_mesh_that_fails_is_a_status(no_mesh, method):
    result = failure_indices(
        gallery.square_hole(analysis={"positions": 8, "local_model": "body-fitted"}), method
    )
    assert np.isnan(result.failure_index).all()
    said = [str(status) for status in result.status.values]
    assert any("no mesh: the mesher failed" in status for status in said)
    assert "ok" not in said


def test_auto_needs_no_mesh(no_mesh):
    result = failure_indices(gallery.square_hole(analysis={"positions": 2}), "auto")
    assert (result.status == "ok").all()


def test_crack_tips_without_a_mesh_have_a_status(no_mesh):
    scene = gallery.circular_hole(cracks=[{"points": [[0.0, 50.0], [10.0, 50.0]]}])
    for method in ("griffith", "asymptotics"):
        status = str(failure_indices(scene, method).status.values[-1])
        assert status.startswith("no mesh: the mesher failed")
