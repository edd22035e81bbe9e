"""A quarter of a plate with a hole: said to be one, its index is the whole plate's; not said, there is a doubt."""

import warnings

import numpy as np
import pytest

from slmm import Material, Scene, failure_indices
from slmm.initiation.solved_scene import solved_scene
from slmm.results.field import DisplacementField
from slmm.scene.plausible import UnusualValueWarning
from tests.solved_plates import SIDE, ring, solved, with_middles

PMMA = Material.from_name("PMMA")
MIDDLE = 0.5 * SIDE


@pytest.fixture(scope="module")
def quarter():
    """The upper right one, its top edge moved up by 0.025 mm."""
    points, nodes = with_middles(*ring(32, 6), 2.0)
    nodes = nodes[(points[nodes].mean(axis=1) > MIDDLE - 1e-9).all(axis=1)]
    used = np.unique(nodes)
    left, bottom, top = (
        used[np.abs(points[used, axis] - at) < 1e-9] for axis, at in ((0, MIDDLE), (1, MIDDLE), (1, SIDE))
    )
    held = np.concatenate([2 * left, 2 * bottom + 1, 2 * top + 1])
    moved = np.concatenate([np.zeros(len(left) + len(bottom)), np.full(len(top), 0.025)])
    field = solved(points, {"quad8": nodes}, PMMA, held, moved)
    return DisplacementField(points, field.cells, np.nan_to_num(field.u))


def test_the_index_is_that_of_the_whole_plate(quarter):
    hole = {"shape": "circle", "center": [10.0, 10.0], "radius": 2.0}
    plate = {"plate": {"width": SIDE, "height": SIDE}, "holes": [hole], "material": {"name": "PMMA"}}
    at = {"analysis": {"points": [[12.0, 10.0]], "method": "boundary"}}
    exact = failure_indices(Scene.from_dict({**plate, "load": {"displacement": 0.05}, **at}))
    whole = solved_scene(quarter, PMMA, symmetry=["left", "bottom"])
    assert not whole.doubts
    found = failure_indices(whole.with_(**at))
    off = abs(float(found.failure_index[0] - exact.failure_index[0]))
    assert off < float(found.failure_index_error[0]) < 0.01 * float(exact.failure_index[0])


def test_what_may_be_a_half_is_doubted(quarter):
    scene = solved_scene(quarter, PMMA)
    assert [doubt.split()[2] for doubt in scene.doubts] == ["left", "bottom"]
    with pytest.warns(UnusualValueWarning, match="--symmetry left"):
        failure_indices(scene.with_(analysis={"points": [[11.5, 11.3]]}), "rankine")


def test_a_whole_plate_on_rollers_is_not_doubted():
    points, quads = ring(16, 4)
    bottom, top = (np.flatnonzero(points[:, 1] == y) for y in (0.0, SIDE))
    held = np.concatenate([2 * bottom + 1, 2 * top + 1, 2 * bottom[:1]])
    moved = np.concatenate([np.zeros(len(bottom)), np.full(len(top), 0.05), [0.0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not solved_scene(solved(points, {"quad": quads}, PMMA, held, moved), PMMA).doubts


def test_symmetry_belongs_to_models():
    scene = Scene.from_dict(
        {
            "plate": {"width": 10.0, "height": 10.0},
            "holes": [{"shape": "circle", "center": [5.0, 5.0], "radius": 1.0}],
            "material": {"name": "PMMA"},
            "load": {"stress": 1.0},
        }
    )
    with pytest.raises(ValueError, match="symmetry belongs to a model"):
        failure_indices(scene, symmetry=["left"])
