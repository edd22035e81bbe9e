"""Method boundary: trial cracks without a mesh, against full FEA, known values, and where it has nothing to say."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.initiation import by_choice
from slmm.scene import gallery


def index(scene, method):
    result = failure_indices(scene, method).isel(position=0)
    assert result.status == "ok", (method, str(result.status.values))
    return float(result.failure_index), float(result.failure_index_error)


@pytest.mark.parametrize(
    ("make", "point"),
    [
        (gallery.circular_hole, (70.0, 50.0)),
        (gallery.elliptic_hole, (70.0, 50.0)),
        (gallery.square_hole, (65.0, 65.0)),
        (gallery.v_notch, (10.0, 60.0)),
        (gallery.edge_crack, (10.0, 60.0)),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_within_what_full_fea_tells_of_itself(make, point):
    """At smooth surfaces, corners and crack tips; 0.01 % where that tells more."""
    pytest.importorskip("netgen")
    scene = make(analysis={"points": [point]})
    (value, error), (truth, own) = index(scene, "boundary"), index(scene, "full-fea")
    assert abs(value - truth) < min(error + own, 2e-4 * truth)


def test_griffiths_criterion_is_that_by_intensities():
    pytest.importorskip("netgen")
    scene = gallery.edge_crack(10.0)
    by_energy = failure_indices(scene, "boundary", criterion="griffith").isel(position=0)
    value, _ = index(scene, "griffith")
    assert float(by_energy.failure_index) == pytest.approx(value, rel=2e-3)


def test_under_pressure_no_crack_is_asked_for():
    scene = gallery.circular_hole(e_yy=-0.01, analysis={"points": [[70.0, 50.0]]})
    result = failure_indices(scene, "boundary").isel(position=0)
    assert result.status == "ok" and result.failure_index == 0


def test_auto_without_a_mesher_has_values_where_cells_have_none(monkeypatch):
    """At a corner, where no cell fits."""
    monkeypatch.setattr(by_choice, "find_spec", lambda name: None)
    scene = gallery.square_hole(analysis={"points": [[65.0, 65.0], [50.0, 65.0]]})
    result = failure_indices(scene, "auto")
    assert (result.status == "ok").all()
    assert result.used_method.values[0] == "boundary"
    assert np.isfinite(result.failure_index).all()


def test_a_thin_ligament_is_no_matter_of_the_parts_tolerance():
    """No crack of it meets both conditions before it has gone through: it goes at once."""
    scene = gallery.two_holes(0.005)
    at = 50.0 - 0.0025
    result = failure_indices(scene.with_(analysis={"points": [[at, 50.0]]}), "boundary").isel(position=0)
    assert result.status == "ok"
    assert float(result.crack_length) == pytest.approx(0.005, rel=0.01)


def test_a_ligament_too_thin_for_a_crack_from_a_corner_says_so():
    at = [50.0, 50.0]
    square = {
        "shape": "rectangle",
        "center": [42.93, 50.0],
        "size": [10.0, 10.0],
        "angle": 45.0,
        "corner_radius": 0.0,
    }
    hole = {"shape": "circle", "center": [60.006, 50.0], "radius": 10.0}
    scene = gallery.circular_hole(holes=[square, hole], analysis={"points": [at]})
    result = failure_indices(scene, "boundary").isel(position=0)
    assert "is too thin, at least" in str(result.status.values)
