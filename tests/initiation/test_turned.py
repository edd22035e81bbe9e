"""Cracks in the direction that needs the least load: where symmetry says so, and against full FEA in that direction."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.criteria.coupled_curves import Coupled
from slmm.initiation.positions import find_positions
from slmm.initiation.settings import DEFAULT
from slmm.initiation.task import Task
from slmm.initiation.turned import turned
from slmm.scene import gallery


def task_of(scene):
    from slmm.initiation.paths import trial_paths

    where = find_positions(scene)
    paths = trial_paths(scene, where)
    return Task(scene, where, paths, Coupled(), 0.02, DEFAULT, None, None, lambda fraction, text: None)


def best(scene):
    return failure_indices(scene, "boundary", direction="best").isel(position=0)


def test_across_the_load_nothing_turns():
    scene = gallery.circular_hole(analysis={"points": [[70.0, 50.0]]})
    result, normal = best(scene), failure_indices(scene, "boundary").isel(position=0)
    assert float(result.turned) == pytest.approx(0.0, abs=0.1)
    assert float(result.failure_index) == pytest.approx(float(normal.failure_index), rel=1e-5)


def test_beside_the_top_cracks_turn_across_the_load_and_mirrored_ones_alike():
    """A large crack beside the place of the largest stress would rather be normal to the load than to the hole."""
    angle = np.radians(25.0)
    x, y = 20.0 * np.cos(angle), 20.0 * np.sin(angle)
    found = [
        best(gallery.circular_hole(analysis={"points": [[50.0 + x, 50.0 + side * y]]}))
        for side in (1.0, -1.0)
    ]
    above, below = found
    assert -60.0 < float(above.turned) < -1.0
    assert float(below.turned) == pytest.approx(-float(above.turned), abs=0.1)
    assert float(below.failure_index) == pytest.approx(float(above.failure_index), rel=1e-4)


def under_shear(name):
    if name == "hole":
        angle = np.radians(35.0)
        point = [50.0 + 20.0 * np.cos(angle), 50.0 + 20.0 * np.sin(angle)]
        return gallery.circular_hole(load={"strain": [0.0, 0.0, 0.1]}, analysis={"points": [point]})
    return gallery.v_notch(
        60.0, 1.0, load={"strain": [0.0, 0.005, 0.01]}, analysis={"points": [[10.0, 60.0]]}
    )


@pytest.mark.parametrize("name", ["hole", "V-notch"])
def test_under_shear_as_full_fea_in_that_direction(name):
    pytest.importorskip("netgen")
    from slmm.initiation.by_full_fea import by_full_fea

    scene = under_shear(name)
    result = best(scene)
    truth = by_full_fea(turned(task_of(scene), np.radians([float(result.turned)])))
    assert float(result.load_factor) == pytest.approx(float(truth.load_factor[0]), rel=3e-3)
    normal = failure_indices(scene, "boundary").isel(position=0)
    assert float(result.failure_index) >= float(normal.failure_index)


def test_other_methods_turn_nothing():
    with pytest.raises(ValueError, match="boundary does"):
        failure_indices(gallery.circular_hole(), "full-fea", direction="best")
    with pytest.raises(ValueError, match="must be one of normal, best"):
        failure_indices(gallery.circular_hole(), "boundary", direction="up")
