"""Holes of every shape have the outline that their tables say, from points and pictures too."""

import numpy as np
import pytest
import shapely
from PIL import Image
from scene_tables import (
    CIRCLE,
    DIAMOND,
    ELLIPSE,
    POLYGON,
    RECTANGLE,
    RING,
    SQUARE,
    V_NOTCH,
    outline_of,
    scene_with,
)

from slmm.scene.errors import SceneError
from slmm.scene.scene import Scene


@pytest.mark.parametrize("hole", [CIRCLE, ELLIPSE, RECTANGLE, SQUARE, DIAMOND, outline_of(RING)["holes"][0]])
def test_every_shape_gives_one_outline(hole):
    (outline,) = Scene.from_dict(scene_with(holes=[hole])).outlines
    np.testing.assert_allclose(outline.polygon(400).mean(axis=0), (50, 50), atol=1e-3)


def sharp_corners(**hole):
    (outline,) = Scene.from_dict(scene_with(holes=[hole])).outlines
    return outline.points(outline.corners), np.degrees(outline.corner_angles)


def test_a_rectangle_without_corner_radius_has_four_right_angles():
    corners, angles = sharp_corners(**RECTANGLE | {"corner_radius": 0, "angle": 90.0})
    np.testing.assert_allclose(corners, [(40, 65), (40, 35), (60, 35), (60, 65)])
    np.testing.assert_allclose(angles, 90.0)


def test_a_rectangle_may_have_corners_too_sharp_for_a_spline_through_points():
    for radius in (0.02, 1e-4):
        (outline,) = Scene.from_dict(scene_with(holes=[{**RECTANGLE, "corner_radius": radius}])).outlines
        assert len(outline.corners) == 0
        assert outline.curvatures(outline.breaks).min() == pytest.approx(-1 / radius, rel=1e-4)


def test_a_polygon_has_its_corners_in_their_order_and_may_repeat_the_first():
    corners, angles = sharp_corners(**POLYGON)
    np.testing.assert_allclose(corners, POLYGON["points"])
    np.testing.assert_allclose(angles, [45.0, 90.0, 45.0])
    closed = [*POLYGON["points"], POLYGON["points"][0]]
    np.testing.assert_allclose(sharp_corners(**POLYGON | {"points": closed})[0], corners)
    clockwise = POLYGON["points"][::-1]
    np.testing.assert_allclose(
        sharp_corners(**POLYGON | {"points": np.array(clockwise)})[0], np.roll(corners, 1, axis=0)
    )


@pytest.mark.parametrize("direction", [0.0, 37.0, 90.0, 180.0, 225.0, -75.0])
@pytest.mark.parametrize(("opening", "radius"), [(0.0, 3.0), (20.0, 0.0), (60.0, 0.5), (120.0, 0.0)])
def test_a_notch_without_depth_runs_out_of_the_plate_behind_its_tip(direction, opening, radius):
    notch = {**V_NOTCH, "tip": [60.0, 45.0], "direction": direction, "opening": opening, "radius": radius}
    scene = Scene.from_dict(scene_with(holes=[notch]))
    (outline,) = scene.outlines
    ahead = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    depth = (np.array(notch["tip"]) - outline.polygon(2000)) @ ahead
    assert depth.min() == pytest.approx(0.0, abs=1e-5)
    plate = shapely.box(0, 0, 100, 100)
    back = shapely.LineString(outline.points(outline.corners[[0, -1]]))
    assert not back.intersects(plate)
    if radius == 0:  # nothing else of the plate is missing than what lies between the endless flanks
        flanks = np.radians(direction + 180 + np.array([-1, 1]) * opening / 2)
        far = np.array(notch["tip"]) + 1e4 * np.column_stack([np.cos(flanks), np.sin(flanks)])
        wedge = shapely.Polygon([notch["tip"], *far])
        hole = shapely.Polygon(outline.polygon(2000))
        assert hole.intersection(plate).area == pytest.approx(wedge.intersection(plate).area, rel=1e-9)


def test_a_notch_with_depth_is_a_wedge_with_a_straight_back():
    corners, angles = sharp_corners(**V_NOTCH | {"tip": [50.0, 50.0], "direction": 90.0, "depth": 10.0})
    half = 10 * np.tan(np.radians(30))
    np.testing.assert_allclose(corners, [(50 + half, 40), (50, 50), (50 - half, 40)])
    np.testing.assert_allclose(angles, 60.0)


def test_notches_may_cross_beyond_the_plate():
    wide = {**V_NOTCH, "opening": 100.0}
    scene = Scene.from_dict(scene_with(holes=[{**wide, "tip": [10.0, 37.0]}, {**wide, "tip": [10.0, 63.0]}]))
    one, other = (shapely.Polygon(outline.polygon(100)) for outline in scene.outlines)
    assert one.intersects(other)
    within = Scene.from_dict(scene_with(holes=[{**wide, "tip": [10.0, 40.0]}, {**wide, "tip": [10.0, 60.0]}]))
    assert len(within.outlines) == 1


@pytest.mark.parametrize(
    "text",
    [
        "x,y\n{:.9f},{:.9f}",
        "{:.9f}; {:.9f}",
        "# comment\n\nx [mm]\ty [mm]\n{:.9f}\t{:.9f}",
        "\ufeff{:.9f} {:.9f}",
    ],
    ids=["comma", "semicolon", "tab", "blank"],
)
def test_points_come_from_a_file_next_to_the_scene(tmp_path, text):
    first, *rest = text.splitlines()[::-1]
    rows = [*rest[::-1], *[first.format(x, y).lstrip("\ufeff") for x, y in RING]]
    (tmp_path / "ring.csv").write_text("\n".join(rows), encoding="utf-8")
    scene = Scene.from_dict(scene_with(holes=[{"shape": "points", "file": "ring.csv"}]), tmp_path)
    assert scene.outlines[0].length == pytest.approx(40 * np.pi, rel=1e-5)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x,y\n1,2\n3,abc", r"line 3 = '3,abc': must hold two numbers"),
        ("1,2\n3,4,5", r"line 2 = '3,4,5': must hold two numbers"),
        ("1,2\n3,nan", r"line 2 = '3,nan': must be finite numbers"),
        ("1,5;2,5\n1,5;3,5", r"line 2 .*must hold two numbers"),
        ("", r"has 0 different points"),
    ],
    ids=["text", "three", "nan", "decimal comma", "empty"],
)
def test_a_points_file_is_refused_by_its_line(tmp_path, text, says):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(SceneError, match=r'^holes\[0\]\.file = "a\.csv": ' + says):
        Scene.from_dict(scene_with(holes=[{"shape": "points", "file": "a.csv"}]), tmp_path)


def test_a_binary_points_file_is_refused(tmp_path):
    (tmp_path / "a.csv").write_bytes(bytes(range(256)))
    with pytest.raises(SceneError, match="not a readable text file"):
        Scene.from_dict(scene_with(holes=[{"shape": "points", "file": "a.csv"}]), tmp_path)


def test_an_image_must_fit_the_plate_and_come_alone(tmp_path):
    x, y = np.meshgrid(np.arange(50), np.arange(50))
    dark = np.hypot(x - 24.5, y - 24.5) < 15
    Image.fromarray(np.where(dark, 0, 255).astype(np.uint8)).save(tmp_path / "a.png")
    image = {"shape": "image", "file": "a.png", "pixel_size": 2.0}
    scene = Scene.from_dict(scene_with(holes=[image]), tmp_path)
    assert scene.outlines[0].length == pytest.approx(60 * np.pi, rel=0.02)
    with pytest.raises(SceneError, match=r'^holes\[0\]\.file = "a.png": the picture has 50 x 50 pixels'):
        Scene.from_dict(scene_with(holes=[{**image, "pixel_size": 1.0}]), tmp_path)
    with pytest.raises(SceneError, match=r"^holes: only one image"):
        Scene.from_dict(scene_with(holes=[image, image]), tmp_path)
