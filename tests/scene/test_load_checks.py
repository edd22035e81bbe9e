"""Loads that reach nothing or do not balance are refused before any method starts; others are computed."""

import numpy as np
import pytest
import shapely

from slmm import Scene, SceneError, failure_indices, read_scene
from slmm.initiation.methods import METHODS
from slmm.part.edges import material_on_edges, share_of_pieces
from slmm.scene import gallery

CASES = "../shared/cases"
#: notches that leave nothing of an edge
OF_TOP = {"shape": "rectangle", "center": [50.0, 100.0], "size": [120.0, 10.0], "corner_radius": 0.0}
OF_BOTTOM = OF_TOP | {"center": [50.0, 0.0]}
HOLE = {"shape": "circle", "center": [50.0, 50.0], "radius": 10.0}


def scene(*holes, **load) -> Scene:
    return gallery.circular_hole(holes=[HOLE, *holes], load=load)


@pytest.mark.parametrize("load", [{"stress": 10.0}, {"displacement": 0.1}])
@pytest.mark.parametrize("holes", [[OF_TOP], [OF_BOTTOM], [OF_TOP, OF_BOTTOM]])
def test_a_loaded_edge_without_material_is_refused(holes, load):
    with pytest.raises(SceneError, match=rf"load\.{next(iter(load))}: no material at the (top|bottom)"):
        scene(*holes, **load)


def test_a_strain_needs_some_edge():
    assert scene(OF_TOP, OF_BOTTOM, strain=[0.0, 0.01, 0.0]).load.strain
    ring = [
        {"shape": "rectangle", "center": center, "size": size, "corner_radius": 0.0}
        for center, size in (([0.0, 50.0], [10.0, 120.0]), ([100.0, 50.0], [10.0, 120.0]))
    ]
    with pytest.raises(SceneError, match=r"loose piece of material|no material at any of its edges"):
        scene(OF_TOP, OF_BOTTOM, *ring, strain=[0.0, 0.01, 0.0])


@pytest.mark.parametrize("x", [20.0, 50.0])
def test_a_stress_on_edges_that_are_cut_differently_is_refused(x):
    notch = {"shape": "circle", "center": [x, 100.0], "radius": 6.0}
    with pytest.raises(SceneError, match=r"load\.stress = 10: .* not in equilibrium: -120 N"):
        scene(notch, stress=10.0)
    opposite = {"shape": "circle", "center": [100.0 - x, 0.0], "radius": 6.0}
    if x == 50.0:
        assert scene(notch, opposite, stress=10.0).load.stress == 10.0
    else:  # the forces are equal, the moments are not
        with pytest.raises(SceneError, match="N mm about the middle"):
            scene(notch, opposite, stress=10.0)
    assert scene(notch, displacement=0.1).load.displacement == 0.1


@pytest.mark.parametrize("name", ["a", "both", "both_disp", "picture"])
def test_the_cases_are_refused_with_what_is_wrong(name):
    with pytest.raises(SceneError, match=r"no material at the|dark|colours"):
        read_scene(f"{CASES}/02-no-material-at-loaded-edge/{name}.toml")


def test_changing_the_load_checks_it_again():
    held = scene(OF_TOP, strain=[0.0, 0.01, 0.0])
    with pytest.raises(SceneError, match="no material at the top edge"):
        held.with_(load={"displacement": 0.1})


@pytest.mark.parametrize("method", ["slmm+ac", "auto"])
def test_a_hole_beside_a_loaded_edge_is_computed(method):
    near = read_scene(f"{CASES}/r01-stress-hole-near-edge/s.toml")
    result = failure_indices(near, method, positions=4)
    assert (result.status == "ok").sum() >= (4 if method == "auto" else 1)
    assert method in METHODS


def test_the_stress_on_an_edge_is_that_of_its_material():
    hole = shapely.Point(0.52, 1.0 - 0.11).buffer(0.1, 64)  # 0.01 below the edge
    whole = material_on_edges([hole], 1.0, 1.0)
    assert whole.top.tolist() == [[0.0, 1.0]] and whole.right.tolist() == [[0.0, 1.0]]
    assert share_of_pieces(whole.top, 1.0, 7) == pytest.approx(np.ones(7))
    cut = material_on_edges([shapely.Point(0.5, 1.0).buffer(0.1, 64)], 1.0, 1.0)
    assert cut.top == pytest.approx(np.array([[0.0, 0.4], [0.6, 1.0]]))
    assert share_of_pieces(cut.top, 1.0, 1000).mean() == pytest.approx(0.8)
