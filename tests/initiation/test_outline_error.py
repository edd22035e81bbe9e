import numpy as np
import pytest

from slmm import failure_indices, read_scene
from slmm.initiation.outline_error import angle_error, rounding_error
from slmm.mechanics.material import Material
from slmm.scene import gallery

PMMA = Material.from_name("PMMA")


def test_a_rounded_corner_differs_the_more_the_sharper_the_notch_and_the_larger_the_radius():
    errors = np.array(
        [
            [rounding_error(np.radians(opening), 0.0, 0.0, r, PMMA) for r in (0.0, 0.05, 0.2, 1.0)]
            for opening in (0.0, 60.0, 90.0, 120.0, 150.0)
        ]
    )
    assert (errors[:, 0] == 0).all() and (np.diff(errors, axis=1) > 0).all()
    assert (np.diff(errors[:, 1:], axis=0) < 0).all()
    # a U-notch as large as many of Irwin's lengths cracks by its stress, 2 sqrt(2/(pi r)) k sqrt(pi/2)
    r = 100 * PMMA.irwin_length
    told = 1 - rounding_error(0.0, 0.0, 0.0, r, PMMA)
    assert told == pytest.approx(2 / np.sqrt(np.pi * 100), rel=0.1)


def test_the_error_depends_on_the_radius_over_irwins_length_alone():
    for name in ("PS", "Al2O3"):
        material = Material.from_name(name)
        told = rounding_error(np.pi / 2, 0.0, 0.0, 0.2 * material.irwin_length, material)
        assert told == pytest.approx(
            rounding_error(np.pi / 2, 0.0, 0.0, 0.2 * PMMA.irwin_length, PMMA), rel=1e-3
        )


def test_bounds_around_a_radius_and_of_an_angle():
    both = rounding_error(np.pi / 2, 0.2, 0.1, 0.4, PMMA)
    assert both == max(
        rounding_error(np.pi / 2, 0.2, 0.2, 0.4, PMMA), rounding_error(np.pi / 2, 0.2, 0.1, 0.2, PMMA)
    )
    assert angle_error(np.pi / 2, 0.0, 20.0, PMMA) == 0.0
    assert 0 < angle_error(np.pi / 2, 0.02, 20.0, PMMA) < angle_error(np.pi / 2, 0.1, 20.0, PMMA) < 0.1


def test_an_exact_outline_has_no_error_of_its_own():
    result = failure_indices(gallery.circular_hole(analysis={"positions": 2, "voxels": 40000}), "slmm+ac")
    assert "outline_error" not in result


@pytest.mark.slow
def test_the_square_of_the_picture_has_sharp_corners_and_says_what_the_picture_leaves_open():
    pytest.importorskip("netgen")
    scene = read_scene("../shared/cases/11-picture-sharp-corners/a.toml")
    result = failure_indices(scene, "asymptotics", positions=4)
    ok = result.status.values == "ok"
    assert ok.sum() == 4
    index, error = result.failure_index.values[ok], result.failure_index_error.values[ok]
    np.testing.assert_allclose(index, 0.8187, rtol=0.02)  # full FEA of the sharp rectangle
    # the corner may be round by a pixel and a half: an index 7 to 25 % lower
    assert error.min() > 0.05 * index.max() and (error < 0.25 * index).all()
    np.testing.assert_array_less(result.outline_error.values[ok], error / index + 1e-12)
