"""Drawn shapes whose truth is known: corners, round corners, smooth outlines, notches that leave the plate."""

import numpy as np
import pytest
import shapely
from PIL import Image

from slmm.part import shapes
from slmm.part.coverage import area_fraction
from slmm.part.image import outlines_in_picture

KINDS = ("grey", "black and white", "noise")


def drawn(path, polygons, columns, rows, kind, seed=0):
    """Picture of polygons (n, 2) in pixels, from the exact share of every pixel that they cover."""
    covered = area_fraction(polygons, float(columns), float(rows), columns, rows)[::-1]
    grey = (covered < 0.5).astype(float) if kind == "black and white" else 1 - covered
    if kind == "noise":
        grey = np.clip(grey + np.random.default_rng(seed).normal(0, 0.05, grey.shape), 0, 1)
    Image.fromarray(np.round(255 * grey).astype(np.uint8)).save(path)
    return path


def outlines(tmp_path, polygons, columns, rows, kind):
    path = drawn(tmp_path / "a.png", polygons, columns, rows, kind)
    return outlines_in_picture(path, 1.0, float(columns), float(rows))


def turned(points, angle, center):
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.asarray(points) @ [[c, s], [-s, c]] + center


def regular(n, radius):
    t = 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def star(n, outer, inner):
    t = np.pi * np.arange(2 * n) / n
    return np.where(np.arange(2 * n) % 2 == 0, outer, inner)[:, None] * np.column_stack(
        [np.cos(t), np.sin(t)]
    )


def ring(pieces):
    return np.concatenate([piece[:-1] for piece in pieces])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("angle", [0.0, 3.0, 17.0, 45.0])
@pytest.mark.parametrize(
    "corners",
    [regular(4, 25), regular(4, 90), regular(3, 50), regular(5, 60), star(5, 80, 35)],
    ids=["small square", "square", "triangle", "pentagon", "star"],
)
def test_corners_of_drawn_polygons_are_corners(tmp_path, corners, angle, kind):
    true = turned(corners, angle, (100.3, 99.6))
    (outline,) = outlines(tmp_path, [true], 200, 200, kind)
    found = outline.accuracy.tips
    assert len(found) == len(true)
    distance = np.hypot(*(found[:, None] - true).transpose(2, 0, 1))
    assert distance.min(axis=0).max() < 1.5
    sharp = outline.accuracy.radii
    assert (sharp[:, 1] < 1.0).all()  # none must be round
    assert (sharp[:, 2] < 8.0).all()  # and none may be very round
    inside = np.pi - outline.accuracy.turns[distance.argmin(axis=0)]
    exact = shapes_angles(true)
    np.testing.assert_allclose(np.degrees(inside), np.degrees(exact), atol=12 if len(corners) == 4 else 6)


def shapes_angles(corners):
    before, behind = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
    cross = before[:, 0] * behind[:, 1] - before[:, 1] * behind[:, 0]
    return np.pi - np.arctan2(cross, (before * behind).sum(axis=1))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("radius", [1.0, 2.0, 3.0, 5.0])
def test_the_radius_of_a_tight_corner_lies_between_its_bounds(tmp_path, radius, kind):
    true = turned(ring(shapes.polygon(regular(4, 90), radius)), 17.0, (100.3, 99.6))
    (outline,) = outlines(tmp_path, [true], 200, 200, kind)
    radii = outline.accuracy.radii
    assert len(radii) == 4
    assert ((radii[:, 1] <= radius + 0.3) & (radius <= radii[:, 2] + 0.1)).all()
    assert radii[:, 2].max() < 1.3 * radius + 2.5


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("radius", [10.0, 20.0])
def test_round_corners_are_followed(tmp_path, radius, kind):
    true = turned(ring(shapes.polygon(regular(4, 90), radius)), 17.0, (100.3, 99.6))
    (outline,) = outlines(tmp_path, [true], 200, 200, kind)
    assert len(outline.corners) == 0
    sharpest = -outline.curvatures(np.linspace(0, outline.length, 4000)).min()
    assert sharpest * radius == pytest.approx(1.0, abs=0.3)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("radius", [8.0, 14.0, 30.0, 100.0])
def test_circles_have_no_corners(tmp_path, radius, kind):
    size = round(2 * radius + 30)
    for center in np.random.default_rng(1).uniform(-0.5, 0.5, (4, 2)):
        true = shapes.circle(size / 2 + center, radius)
        (outline,) = outlines(tmp_path, [true], size, size, kind)
        assert len(outline.corners) == 0 and len(outline.accuracy.tips) == 0


@pytest.mark.parametrize("opening", [20.0, 60.0, 90.0, 120.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_notch_that_leaves_the_plate_has_its_tip_and_nothing_else_inside(tmp_path, opening, kind):
    notch = ring(shapes.v_notch((60.3, 70.6), 0.0, opening, 0.0, 100.0))
    (outline,) = outlines(tmp_path, [notch], 140, 140, kind)
    corners = outline.points(outline.corners)
    inside = (corners > 0).all(axis=1) & (corners < 140).all(axis=1)
    assert inside.sum() == 1
    np.testing.assert_allclose(corners[inside][0], (60.3, 70.6), atol=1.5)
    np.testing.assert_allclose(np.degrees(outline.corner_angles[inside]), opening, atol=4.0)


def smooth_shape(rng, radius):
    t = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    r = 1 + sum(rng.normal(0, 0.25 / k**1.2) * np.cos(k * t + rng.uniform(0, 7)) for k in range(2, 7))
    return radius * np.maximum(r, 0.3)[:, None] * np.column_stack([np.cos(t), np.sin(t)])


@pytest.mark.parametrize("kind", KINDS)
def test_what_waves_may_do_to_the_stress_covers_what_they_do(tmp_path, kind):
    # to first order they change it by twice the Hilbert transform of their slope
    rng, covered, ratio = np.random.default_rng(3), [], []
    for radius in (30.0, 60.0, 60.0):
        true = smooth_shape(rng, radius) + np.array([130.3, 129.6])
        (outline,) = outlines(tmp_path, [true], 260, 260, kind)
        s = np.linspace(0, outline.length, 2048, endpoint=False)
        points = outline.points(s)
        away = shapely.distance(shapely.LinearRing(true), shapely.points(points))
        away *= np.where(shapely.contains(shapely.Polygon(true), shapely.points(points)), 1, -1)
        k = 2 * np.pi * np.abs(np.fft.fftfreq(len(s), outline.length / len(s)))
        stress = np.abs(np.fft.ifft(2 * k * np.fft.fft(away)).real)
        gaps = np.hypot(*(points[:, None] - outline.accuracy.points).transpose(2, 0, 1))
        told = 2 * outline.accuracy.stress[gaps.argmin(axis=1)]
        smooth = np.ones(len(s), dtype=bool)
        for tip, radii in zip(outline.accuracy.tips, outline.accuracy.radii, strict=True):
            smooth &= np.hypot(*(points - tip).T) > 3 * radii[2]
        covered.append((stress <= told)[smooth])
        ratio.append(np.median(told[smooth]) / np.quantile(stress[smooth], 0.95))
    assert np.concatenate(covered).mean() > 0.95
    assert np.median(ratio) < 4


def test_a_silhouette_of_any_shape_is_never_refused_for_its_corners(tmp_path):
    rng = np.random.default_rng(4)
    for k in range(12):
        t = np.sort(rng.uniform(0, 2 * np.pi, 9))
        shape = rng.uniform(15, 70, 9)[:, None] * np.column_stack([np.cos(t), np.sin(t)])
        true = turned(shape, 0.0, rng.uniform(20, 140, 2))
        inside = shapely.Polygon(true).intersection(shapely.box(0, 0, 160, 160))
        if inside.geom_type != "Polygon" or inside.area < 200:
            continue
        found = outlines(tmp_path, [true], 160, 160, KINDS[k % 3])
        got = shapely.union_all([shapely.Polygon(outline.polygon(2000)) for outline in found])
        differs = got.intersection(shapely.box(0, 0, 160, 160)).symmetric_difference(inside)
        assert differs.area < 0.04 * inside.area + 0.5 * inside.length


def test_pixel_size_scales_the_accuracy_with_the_outline(tmp_path):
    path = drawn(tmp_path / "a.png", [turned(regular(4, 40), 20.0, (60, 60))], 120, 120, "grey")
    (one,), (tenth,) = (outlines_in_picture(path, size, 120 * size, 120 * size) for size in (1.0, 0.1))
    for name in ("offset", "points", "tips", "wavelength", "radii"):
        np.testing.assert_allclose(getattr(tenth.accuracy, name), 0.1 * getattr(one.accuracy, name))
    np.testing.assert_allclose(tenth.accuracy.turns, one.accuracy.turns)
    np.testing.assert_allclose(tenth.accuracy.stress, one.accuracy.stress)
