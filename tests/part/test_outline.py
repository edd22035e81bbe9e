"""Outlines through points: smooth, by arc length, the same wherever they lie."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.part import shapes
from slmm.part.outline import Outline
from slmm.part.outline_splines import MAX_PIECES
from slmm.scene.gallery import lobes

LOBED = np.array(lobes((3.0, -2.0), 19.0))


def everywhere(outline, n=3001):
    return np.linspace(0.0, outline.length, n)


def test_circle_is_followed_to_a_millionth_and_its_curvature_to_a_thousandth():
    outline = Outline.through(shapes.circle((3.0, 4.0), 20.0))
    s = everywhere(outline)
    assert np.abs(np.hypot(*(outline.points(s) - (3.0, 4.0)).T) - 20.0).max() < 1e-6 * 20.0
    assert np.abs(-20.0 * outline.curvatures(s) - 1).max() < 1e-3
    assert outline.length == pytest.approx(40 * np.pi, rel=1e-8)


def test_normals_of_a_hole_point_into_the_material_and_its_curvature_is_negative():
    for sense in (1, -1):
        outline = Outline.through(shapes.circle((0.0, 0.0), 5.0)[::sense])
        s = everywhere(outline)
        np.testing.assert_allclose(outline.normals(s), outline.points(s) / 5.0, atol=1e-6)
        (x, y), (t_x, t_y) = outline.points(s).T, outline.tangents(s).T
        np.testing.assert_allclose(x * t_y - y * t_x, 5.0, rtol=1e-6)  # counter-clockwise
        assert (outline.curvatures(s) < 0).all()


def test_first_point_stays_the_first_in_either_sense():
    points = shapes.ellipse((1.0, 2.0), (5.0, 3.0))
    backwards = np.roll(points[::-1], 1, axis=0)
    for given_points in (points, backwards, np.vstack([points, points[:1]])):
        np.testing.assert_allclose(Outline.through(given_points).points(0.0), (6.0, 2.0), atol=1e-6)


def test_ellipse_bends_most_at_the_ends_of_its_long_axis():
    outline = Outline.through(shapes.ellipse((0.0, 0.0), (20.0, 10.0)))
    assert outline.curvatures(0.0) == pytest.approx(-20.0 / 10.0**2, rel=1e-3)
    assert outline.curvatures(outline.length / 4) == pytest.approx(-10.0 / 20.0**2, rel=1e-3)


@pytest.mark.parametrize(
    "points",
    [
        shapes.circle((0, 0), 1e-3),
        shapes.ellipse((0, 0), (20.0, 4.0), 30.0),
        LOBED,
    ],
    ids=["circle", "ellipse", "lobes"],
)
def test_parameter_is_the_arc_length(points):
    outline = Outline.through(points)
    speed = np.linalg.norm(outline._derivatives(everywhere(outline, 20_011), 1)[0], axis=1)
    assert np.abs(speed - 1).max() < 1e-6
    steps = np.diff(outline.breaks)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-9)
    assert outline.coefficients.shape == (4, len(steps), 2) and len(steps) <= MAX_PIECES


def test_local_parabola_is_half_the_curvature():
    outline = Outline.through(LOBED)
    for s in np.linspace(0.0, outline.length, 17):
        away = outline.points(s + np.array([-1e-2, 1e-2])) - outline.points(s)
        xi, eta = away @ outline.tangents(s), away @ outline.normals(s)
        np.testing.assert_allclose(eta, outline.curvatures(s) / 2 * xi**2, atol=2e-7)


def test_projection_finds_the_nearest_point():
    outline = Outline.through(LOBED)
    s = everywhere(outline)[:-1]
    for distance in (0.0, 0.5, -0.5):  # less than the smallest radius of curvature
        nearest = outline.project(outline.points(s) + distance * outline.normals(s))
        gap = (nearest - s + outline.length / 2) % outline.length - outline.length / 2
        assert np.abs(gap).max() < 1e-9
    far = np.random.default_rng(1).uniform(-60, 60, (50, 2))
    dense = outline.polygon(20_000)
    nearest = np.linalg.norm(outline.points(outline.project(far)) - far, axis=1)
    best = np.linalg.norm(far[:, None] - dense, axis=-1).min(axis=1)
    assert (nearest <= best + 1e-9).all()


def test_projection_of_a_centre_of_curvature_is_some_point_of_the_circle():
    outline = Outline.through(shapes.circle((1.0, 1.0), 2.0))
    assert np.isfinite(outline.project([[1.0, 1.0]])).all()


@settings(max_examples=20, deadline=None)
@given(
    angle=st.floats(-180, 180),
    scale=st.floats(1e-3, 1e3),
    shift=st.tuples(st.floats(-100, 100), st.floats(-100, 100)),
)
def test_turning_and_scaling_the_points_turns_and_scales_the_outline(angle, scale, shift):
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s], [s, c]])
    one = Outline.through(LOBED)
    other = Outline.through(scale * (LOBED @ turn.T + shift))
    at = everywhere(one, 200)
    assert other.length == pytest.approx(scale * one.length, rel=1e-9)
    np.testing.assert_allclose(
        other.points(scale * at), scale * (one.points(at) @ turn.T + shift), atol=1e-5 * scale
    )
    np.testing.assert_allclose(other.tangents(scale * at), one.tangents(at) @ turn.T, atol=1e-5)
    np.testing.assert_allclose(other.curvatures(scale * at) * scale, one.curvatures(at), atol=1e-4)


def test_interpolation_passes_through_smooth_points_and_smoothing_removes_noise():
    np.testing.assert_allclose(
        (clean := Outline.through(LOBED)).points(clean.project(LOBED)), LOBED, atol=1e-6
    )
    noise = np.random.default_rng(0).normal(0.0, 0.02, LOBED.shape)
    smooth = Outline.through(LOBED + noise, smoothing=0.02)
    s = everywhere(smooth)
    error = smooth.points(s) - clean.points(clean.project(smooth.points(s)))
    assert np.sqrt((error**2).sum(axis=1).mean()) < 0.6 * 0.02
    assert np.abs(smooth.curvatures(s) - clean.curvatures(clean.project(smooth.points(s)))).max() < 0.05


def test_smoothing_neither_shrinks_nor_moves_a_circle():
    outline = Outline.through(shapes.circle((3.0, 4.0), 20.0), smoothing=1.0, wavelength=60.0)
    radii = np.hypot(*(outline.polygon(500) - (3.0, 4.0)).T)
    np.testing.assert_allclose(radii, 20.0, rtol=1e-6)


@pytest.mark.parametrize(
    ("points", "says"),
    [
        (shapes.circle((0, 0), 1.0)[::60], "at least 8 points"),
        (np.zeros((10, 3)), "shape"),
        (np.full((10, 2), np.nan), "finite"),
        (np.repeat(shapes.circle((0, 0), 1.0), 2, axis=0), "coincide"),
        (shapes.ellipse((0, 0), (20.0, 0.2)), "corner at"),
    ],
    ids=["few", "shape", "nan", "repeated", "corner"],
)
def test_points_that_are_no_outline_are_refused(points, says):
    with pytest.raises(ValueError, match=says):
        Outline.through(points)
