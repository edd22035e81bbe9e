"""The plate of hole patterns: lengths and material reach the scene, and scale; what holes take away."""

import numpy as np
import pytest

from slmm.mechanics.material import Material
from slmm.optimization.hole_patterns.plate import CrackedPlate

CROSS = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], bool)


def test_weight_is_what_the_outlines_leave():
    """Traced lines are within 1e-4 of the outlines."""
    plate = CrackedPlate()
    areas = [outline.polygon(2000) for outline in plate.scene(CROSS).outlines]
    hole = sum(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2 for x, y in (a.T for a in areas))
    assert plate.weight(CROSS) == pytest.approx(1 - hole / 6400, abs=1e-4)
    assert plate.weight(CROSS) < plate.weight(np.zeros((3, 3), bool)) == 1.0


def test_a_plate_twice_as_large_has_outlines_twice_as_large():
    (small,) = CrackedPlate().scene(CROSS).outlines
    (large,) = CrackedPlate(160.0, 20.0, 30.0).scene(CROSS).outlines
    np.testing.assert_allclose(large.polygon(200), 2 * small.polygon(200), atol=1e-9)
    assert CrackedPlate(160.0, 20.0, 30.0).weight(CROSS) == pytest.approx(CrackedPlate().weight(CROSS))


def test_all_of_it_reaches_the_scene():
    glass = Material(70000.0, 0.2, 50.0, 0.01)
    scene = CrackedPlate(crack=12.0, threshold=0.7, material=glass).scene(CROSS)
    assert (scene.material.E, scene.material.G_c, scene.material.state) == (70000.0, 0.01, "plane stress")
    assert scene.part.cracks[0].points[-1].tolist() == [12.0, 40.0]
    # a higher threshold leaves smaller holes, a longer scale rounder ones
    weights = [CrackedPlate(threshold=t).weight(CROSS) for t in (0.3, 0.5, 0.7)]
    assert weights == sorted(weights)


@pytest.mark.parametrize(
    ("lengths", "words"),
    [
        ({"side": 0.0}, "side = 0.0: must be a length"),
        ({"crack": 80.0}, "crack = 80.0: must lie between 0 and 80 mm"),
        ({"frame": 40.0}, "frame = 40.0: must lie between 0 and 40 mm"),
    ],
)
def test_lengths_that_do_not_fit_are_refused(lengths, words):
    with pytest.raises(ValueError, match=words):
        CrackedPlate(**lengths)


def test_a_plate_is_read_from_its_scene():
    glass = Material(70000.0, 0.2, 50.0, 0.01, "plane strain")
    plate = CrackedPlate(100.0, 12.0, 20.0, 2.0, 0.6, glass)
    read = CrackedPlate.of_scene(plate.scene(CROSS))
    assert (read.side, read.crack, read.frame) == (100.0, 12.0, 20.0)
    assert (read.length_scale, read.threshold) == (2.0, 0.6)
    assert (read.material.E, read.material.G_c, read.material.state) == (70000.0, 0.01, "plane strain")
    # without a pattern these are the published ones
    bare = CrackedPlate.of_scene(plate.scene(np.zeros((3, 3))))
    assert (bare.frame, bare.length_scale, bare.threshold) == (15.0, 2.5, 0.5)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"plate": {"thickness": 2.0}}, "plate: must be there, as wide as high, and 1 mm thick"),
        ({"load": {"displacement": None, "stress": 1.0}}, "load: must be a displacement"),
        ({"cracks": [{"points": [[0.0, 30.0], [10.0, 30.0]]}]}, "cracks: must be one, straight from"),
        (
            {"holes": [{"shape": "circle", "center": [40.0, 40.0], "radius": 5.0}]},
            "holes: must be none but one of the shape pattern",
        ),
    ],
)
def test_other_scenes_are_no_plates_of_patterns(change, words):
    scene = CrackedPlate().scene(CROSS).with_(**change)
    with pytest.raises(ValueError, match=words):
        CrackedPlate.of_scene(scene)
