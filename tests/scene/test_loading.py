"""The short forms of a load as conditions on a plate's edges."""

import numpy as np
import pytest

from slmm.scene import gallery
from slmm.scene.loading import Affine, Condition, Loading, plate_edges, plate_loading

BOTTOM, RIGHT, TOP, LEFT = plate_edges(40.0, 20.0)


def test_a_strain_prescribes_all_edges():
    loading = plate_loading(40.0, 20.0, strain=(0.01, 0.02, 0.03))
    assert [(c.start, c.end) for c in loading] == [BOTTOM, RIGHT, TOP, LEFT]
    assert all(condition.is_held == (True, True) for condition in loading)
    corner = np.array([[40.0, 20.0]])
    u = [component(corner)[0] for component in loading.at_edge(*TOP).displacement]
    assert u == pytest.approx([0.01 * 40 + 0.015 * 20, 0.015 * 40 + 0.02 * 20])
    assert loading.strain == (0.01, 0.02, 0.03)


def test_a_displacement_moves_the_top_and_holds_the_bottom():
    loading = plate_loading(40.0, 20.0, displacement=0.5)
    assert loading.at_edge(*BOTTOM).displacement == (None, Affine())
    assert loading.at_edge(*TOP).displacement == (None, Affine(0.5))
    assert loading.at_edge(*LEFT) == Condition(*LEFT)
    assert loading.strain is None


def test_a_stress_pulls_both_ways():
    loading = plate_loading(40.0, 20.0, stress=3.0)
    assert {c.start: c.traction for c in loading} == {BOTTOM[0]: (0.0, -3.0), TOP[0]: (0.0, 3.0)}
    assert not any(any(condition.is_held) for condition in loading)


@pytest.mark.parametrize(
    ("load", "nominal"),
    [
        ({"strain": (0.01, -0.02, 0.03)}, 30.0),
        ({"displacement": -0.5}, 25.0),
        ({"stress": -7.0}, 7.0),
    ],
)
def test_the_nominal_stress_is_that_of_the_part_without_notches(load, nominal):
    assert plate_loading(40.0, 20.0, **load).nominal_stress(1000.0) == pytest.approx(nominal)


@pytest.mark.parametrize(
    ("load", "says"),
    [
        ({}, "load has nothing"),
        ({"strain": (0, 1, 0), "stress": 1.0}, r"load has \['strain', 'stress'\]"),
        ({"stress": np.nan}, "load.stress = nan: must be finite"),
        ({"strain": (0, np.inf, 0)}, "load.strain = .*: must be finite"),
    ],
)
def test_what_is_no_load_is_refused(load, says):
    with pytest.raises(ValueError, match=says):
        plate_loading(40.0, 20.0, **load)


def test_points_on_a_stretch():
    stretch = Condition((0.0, 0.0), (3.0, 4.0))
    points = np.array([[0, 0], [1.5, 2], [3, 4], [3.3, 4.4], [-0.3, -0.4], [1.5, 2.001]])
    assert stretch.on(points).tolist() == [True, True, True, False, False, False]
    assert stretch.length == 5.0


def test_a_scene_has_its_load_as_conditions():
    scene = gallery.circular_hole(load={"stress": 2.0})
    assert scene.loading == plate_loading(100.0, 100.0, stress=2.0)
    assert scene.with_(load={"strain": [0.0, 0.1, 0.0]}).loading == plate_loading(
        100.0, 100.0, (0.0, 0.1, 0.0)
    )
    assert isinstance(scene.loading, Loading)
