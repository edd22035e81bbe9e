"""Where no crack starts: beside mouths, corners and the ends of supports, and where a support holds."""

import numpy as np
import pytest

from slmm.fracture.exclusion import Exclusion, held, mouths
from slmm.scene.gallery import tensile_plate, v_notch
from slmm.scene.loading import Loading

SUPPORTS = [
    {"on": "bottom", "displacement": [0.0, 0.0]},
    {"at": [40.0, 80.0], "width": 10.0, "displacement": ["free", 1.0]},
]


def test_no_crack_starts_beside_a_mouth_or_the_end_of_a_support():
    scene = tensile_plate(boundary=SUPPORTS)
    assert mouths(scene.part).tolist() == [[0.0, 40.0]]
    points = np.array([[0.0, 40.2], [0.0, 40.3], [35.1, 80.0], [34.6, 80.0], [80.0, 40.0]])
    excluded = Exclusion.of(scene.part, scene.loading, 0.1)
    assert excluded.is_clear(points).tolist() == [False, True, False, True, True]
    places = np.array([[40.0, 0.0], [38.0, 80.0], [20.0, 80.0], [0.0, 10.0]])
    assert held(scene.loading, places).tolist() == [True, True, False, False]
    # the middle of what is held is clear of its ends, and yet none starts there
    assert excluded.is_clear(places).all() and excluded.free(places).tolist() == [False, False, True, True]


def test_it_says_what_a_place_is_beside_of():
    scene = tensile_plate(boundary=SUPPORTS)
    excluded = Exclusion.of(scene.part, scene.loading, 0.1)
    assert excluded.reason(np.array([34.8, 80.0])) == "beside the end of a support at (35, 80)"
    assert excluded.reason(np.array([0.0, 40.2])) == "beside the mouth of a crack at (0, 40)"
    notched = v_notch()
    corner = Exclusion.of(notched.part, notched.loading, 0.1).reason(np.array([9.8, 60.0]))
    assert corner == "beside a corner at (10, 60)"


@pytest.mark.parametrize("size", [1.0, 1e3])
def test_the_reach_scales_with_the_depth(size):
    excluded = Exclusion(np.zeros((1, 2)), ["a mark"], 2.5 * size, Loading(()))
    assert excluded.free(size * np.array([[2.4, 0.0], [0.0, 2.6]])).tolist() == [False, True]


def test_where_nothing_is_excluded_all_is_free():
    assert Exclusion(np.empty((0, 2)), [], 1.0, Loading(())).free(np.zeros((3, 2))).all()
