"""Criteria of initiation in a simulation: the coupled one by trial cracks and by cells, against dislocations."""

from pathlib import Path

import numpy as np
import pytest

from slmm import failure_indices
from slmm.boundary.model import BoundaryModel
from slmm.fracture import simulate
from slmm.fracture.events import Kind
from slmm.fracture.first_cracks import INITIATIONS, CoupledCriterion
from slmm.fracture.surface_peaks import Site
from slmm.scene.gallery import circular_hole, square_hole, tensile_plate
from slmm.scene.scene import read_scene

PARTS = Path(__file__).parents[2] / "examples" / "parts"


def first(scene, name, load=np.inf):
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    return min(INITIATIONS[name](scene)(model, load), key=lambda event: event.load)


@pytest.fixture(scope="module")
def hole():
    """A circular hole, and its most critical position by the dislocations of full models."""
    pytest.importorskip("netgen")
    scene = circular_hole()
    event = first(scene, "coupled")
    at = scene.with_(analysis={"points": [event.point.tolist()]})
    return scene, event, failure_indices(at, "dislocations")


def test_trial_cracks_agree_with_dislocations(hole):
    _, event, known = hole
    assert event.load == pytest.approx(float(known.load_factor[0]), rel=2e-3)
    assert event.length == pytest.approx(float(known.crack_length[0]), rel=0.02)
    assert event.criterion == "coupled" and event.kind is Kind.START


def test_cells_agree_with_trial_cracks(hole):
    """Within what crack cells leave open, a per cent."""
    scene, exact, _ = hole
    event = first(scene, "slmm+ac")
    assert event.criterion == "slmm+ac"
    assert event.load == pytest.approx(exact.load, rel=0.01)
    assert event.length == pytest.approx(exact.length, rel=0.05)


def test_where_something_else_happens_first_nothing_is_asked(hole, monkeypatch):
    scene, event, _ = hole
    monkeypatch.setattr("slmm.fracture.first_cracks.TrialCracks", None)  # asked, it would fail
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    assert INITIATIONS["coupled"](scene)(model, 0.3 * event.load) == []


def test_a_corner_cracks_along_its_bisector():
    pytest.importorskip("netgen")
    scene = square_hole()
    event = first(scene, "coupled")
    at = scene.with_(analysis={"points": [event.point.tolist()]})
    known = failure_indices(at, "full-fea")
    assert event.load == pytest.approx(float(known.load_factor[0]), rel=5e-3)


@pytest.mark.parametrize("initiation", ["coupled", "slmm+ac"])
def test_the_crack_behind_a_hole_begins_with_its_own_length(initiation):
    result = simulate(tensile_plate([(38.0, 44.0, 7.0)]), 4.0, initiation, errors=False)
    k = int(np.flatnonzero(result.event == "start")[0])
    start = np.hypot(result.crack_x[1, 1] - result.crack_x[1, 0], result.crack_y[1, 1] - result.crack_y[1, 0])
    irwin = tensile_plate().material.irwin_length
    assert result.criterion.values[k] == initiation
    assert 0.05 * irwin < float(start) < 0.6 * irwin
    assert result.attrs["outcome"] == "the part is severed"


def test_a_ligament_too_thin_for_trial_cracks_is_excluded_and_says_so():
    scene = tensile_plate([(71.9, 40.0, 8.0)])
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    events = INITIATIONS["coupled"](scene)(model, np.inf)
    assert events and all(event.excluded.startswith("in a ligament of") for event in events)


class Released:
    """Trial cracks of which each sets free the more the longer it is, little enough that energy decides."""

    PER_LENGTH = 1e-6
    lengths = np.array([0.1, 1.0])
    K = np.array([[1.0, 0.0], [1.0, 0.0]])

    def __init__(self, *_):
        pass

    def incremental(self, a):
        return self.PER_LENGTH * a


def test_where_longer_cracks_need_less_up_to_the_end_of_a_ligament_the_longest_bounds_the_load(monkeypatch):
    monkeypatch.setattr("slmm.fracture.first_cracks.TrialCracks", Released)
    scene = tensile_plate([(71.0, 40.0, 8.0)])
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    site = Site(np.array([80.0, 40.0]), np.array([-1.0, 0.0]), -1, 1.0)
    [event] = CoupledCriterion(scene).at(model, [site], np.inf)
    assert event.criterion == "coupled, at most" and not event.excluded
    # the outline's chords lie by 1e-4 mm beside it
    assert event.length == pytest.approx(0.8 * 1.0, abs=1e-3)
    expected = np.sqrt(scene.material.G_c / (Released.PER_LENGTH * 0.8))
    assert event.load == pytest.approx(expected, rel=1e-3)


def test_a_crack_whose_faces_would_pass_through_each_other_does_not_start(monkeypatch):
    class Closed(Released):
        K = np.array([[-1.0, 2.0], [-1.0, 2.0]])

    monkeypatch.setattr("slmm.fracture.first_cracks.TrialCracks", Closed)
    scene = tensile_plate([(71.0, 40.0, 8.0)])
    model = BoundaryModel(scene.part, scene.material, scene.loading)
    site = Site(np.array([80.0, 40.0]), np.array([-1.0, 0.0]), -1, 1.0)
    assert CoupledCriterion(scene).at(model, [site], np.inf) == []


def test_cells_are_refused_where_they_know_no_supports():
    with pytest.raises(ValueError, match="crack cells know plates under"):
        simulate(read_scene(PARTS / "compact_tension.toml"), initiation="slmm+ac")


def test_meshes_know_the_point_method_alone():
    with pytest.raises(ValueError, match="engine fem knows 'point' alone"):
        simulate(tensile_plate(), initiation="coupled", engine="fem")
