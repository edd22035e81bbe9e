from pathlib import Path

import numpy as np
import pytest

from slmm.part.outline import Outline
from slmm.scene import gallery
from slmm.scene.scene import read_scene

EXAMPLES = Path(__file__).parents[2] / "examples"


def curvatures(scene):
    (outline,) = scene.outlines
    return outline.curvatures(np.linspace(0.0, outline.length, 5000))


def test_circular_hole_is_that_of_paper_a():
    scene = gallery.circular_hole()
    assert (scene.plate.width, scene.plate.height, scene.plate.thickness) == (100.0, 100.0, 1.0)
    assert scene.load.strain == (0.0, 0.1, 0.0) and scene.material.name == "PMMA"
    np.testing.assert_allclose(curvatures(scene), -1 / 20.0, rtol=1e-3)


def test_ellipse_lies_across_the_load():
    scene = gallery.elliptic_hole()
    np.testing.assert_allclose(np.ptp(scene.outlines[0].polygon(2000), axis=0), (40.0, 20.0), rtol=1e-4)
    assert curvatures(scene).min() == pytest.approx(-0.2, rel=1e-3)


def test_rounded_square_has_straight_sides_and_round_corners():
    kappa = curvatures(gallery.rounded_square())
    assert np.median(kappa[kappa < -0.1]) == pytest.approx(-1 / 6.0, rel=0.02)
    assert np.median(kappa) == pytest.approx(0.0, abs=1e-3)
    assert kappa.min() > -1.06 / 6.0 and kappa.max() < 0.01


def test_lobed_notch_bends_both_ways_and_is_not_symmetric():
    scene = gallery.lobed_notch()
    kappa = curvatures(scene)
    assert 5 < -1 / kappa.min() < 6 and 3.9 < 1 / kappa.max() < 4.5
    radii = np.hypot(*(scene.outlines[0].polygon(360) - 50.0).T)
    assert 19 < radii.mean() < 21
    harmonics = np.fft.fft(kappa[:-1])
    for axis in range(0, 360):  # a mirror axis at any angle would make all harmonics real after a shift
        mirrored = harmonics * np.exp(1j * np.arange(len(harmonics)) * np.radians(axis))
        assert np.abs(mirrored[1:40].imag).max() > 0.05 * np.abs(harmonics[1:40]).max()


@pytest.mark.parametrize("radius", [0.25, 0.5, 1.0, 2.0])
def test_sapora_plate(radius):
    scene = gallery.sapora_plate(radius)
    assert scene.material.state == "plane strain" and scene.material.nu == 0.38
    assert scene.material.K_Ic == pytest.approx(1.96 * np.sqrt(1000.0))
    assert scene.load.stress == 10.0
    np.testing.assert_allclose(curvatures(scene), -1 / radius, rtol=1e-3)


def test_square_hole_has_four_sharp_corners_and_straight_sides():
    scene = gallery.square_hole()
    (outline,) = scene.outlines
    np.testing.assert_allclose(np.abs(outline.points(outline.corners) - 50.0), 15.0)
    np.testing.assert_allclose(outline.corner_angles, np.pi / 2)
    assert not curvatures(scene).any()


@pytest.mark.parametrize("ligament", [0.5, 2.0, 10.0])
def test_two_holes_leave_a_ligament_between_them_across_the_load(ligament):
    left, right = gallery.two_holes(ligament).outlines
    ((x_left, y_left), *_), ((x_right, y_right), *_) = left.points([0.0]), right.points([right.length / 2])
    assert x_right - x_left == pytest.approx(ligament, rel=1e-5)
    assert y_left == pytest.approx(50.0) == y_right
    assert x_left + x_right == pytest.approx(100.0)


@pytest.mark.parametrize("opening", [30.0, 90.0, 150.0])
@pytest.mark.parametrize("radius", [0.0, 0.05, 1.0])
def test_v_notch_is_a_quarter_of_the_width_deep_and_points_across_the_load(opening, radius):
    (outline,) = gallery.v_notch(opening, radius).outlines
    s = outline.project([[10.0, 60.0]])
    np.testing.assert_allclose(outline.points(s)[0], (10.0, 60.0), atol=1e-9)
    np.testing.assert_allclose(outline.normals(s)[0], (1.0, 0.0), atol=1e-7)
    assert outline.polygon(4000)[:, 0].max() == pytest.approx(10.0, abs=1e-6)
    if radius:
        assert outline.curvatures(s)[0] == pytest.approx(-1 / radius, rel=1e-4)
    else:
        assert np.degrees(outline.corner_angles[outline.corner_at(s)[0]]) == pytest.approx(opening)


def test_edge_crack_runs_from_the_left_edge_across_the_load():
    scene = gallery.edge_crack(7.0, load={"displacement": 0.1})
    assert scene.outlines == () and scene.load.stress is None
    assert scene.cracks[0].points == ((0.0, 60.0), (7.0, 60.0))
    with pytest.raises(ValueError, match="leaves the plate"):
        gallery.edge_crack(41.0)


@pytest.mark.parametrize(
    "make",
    [
        gallery.circular_hole,
        gallery.elliptic_hole,
        gallery.rounded_square,
        gallery.lobed_notch,
        lambda **changes: gallery.sapora_plate(1.0, **changes),
        gallery.square_hole,
        gallery.two_holes,
        gallery.v_notch,
        gallery.edge_crack,
    ],
)
def test_every_scene_can_be_changed(make):
    scene = make(material={"name": "PS"}, load={"displacement": 0.1}, analysis={"method": "point"})
    assert scene.material.sigma_c == 30.0
    assert scene.load.displacement == 0.1 and scene.load.strain is None and scene.load.stress is None
    assert scene.analysis.method == "point"


def test_example_files_are_scenes():
    assert read_scene(EXAMPLES / "circle.toml").analysis.positions == 50
    assert read_scene(EXAMPLES / "notch.toml").load.strain == (0.0, 0.005, 0.0)


def test_example_picture_shows_the_lobed_hole_it_was_drawn_from():
    (outline,) = read_scene(EXAMPLES / "notch.toml").outlines
    drawn = Outline.through(gallery.lobes((30.0, 30.0), 11.0))
    s = np.linspace(0.0, drawn.length, 2000)
    nearest = outline.project(drawn.points(s))
    assert (
        np.linalg.norm(outline.points(nearest) - drawn.points(s), axis=1).max() < 0.03
    )  # a third of a pixel
    error = outline.curvatures(nearest) - drawn.curvatures(s)
    assert np.sqrt((error**2).mean()) < 0.03 * np.abs(drawn.curvatures(s)).max()
