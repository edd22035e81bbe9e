"""Holes that overlap are one, on their exact curves."""

import numpy as np
import pytest
import shapely

from slmm.part.checks import _polygon
from slmm.scene.scene import Scene, SceneError, read_scene


def scene(*holes):
    return Scene.from_dict(
        {
            "plate": {"width": 100.0, "height": 100.0},
            "holes": list(holes),
            "material": {"name": "PMMA"},
            "load": {"stress": 10.0},
        }
    )


def circle(x, y, r):
    return {"shape": "circle", "center": [x, y], "radius": r}


def box(x, y, w, h, r=0.0, angle=0.0):
    return {"shape": "rectangle", "center": [x, y], "size": [w, h], "corner_radius": r, "angle": angle}


def notch(x, y, opening, r=0.0):
    return {"shape": "v-notch", "tip": [x, y], "direction": 0.0, "opening": opening, "radius": r}


UNIONS = {
    "keyhole": ([notch(20.0, 50.0, 0.0, 0.5), circle(22.0, 50.0, 3.0)], [260.41, 90, 90, 260.41]),
    "two circles": ([circle(45.0, 50.0, 8.0), circle(55.0, 50.0, 8.0)], [257.36] * 2),
    "chain": ([circle(38.0, 50.0, 8.0), circle(50.0, 50.0, 8.0), circle(62.0, 50.0, 8.0)], [277.18] * 4),
    "dog bone": (
        [box(50.0, 50.0, 30.0, 4.0), circle(35.0, 50.0, 5.0), circle(65.0, 50.0, 5.0)],
        [246.42] * 4,
    ),
    "stadium, circles tangent to the sides": (
        [box(50.0, 50.0, 20.0, 10.0), circle(40.0, 50.0, 5.0), circle(60.0, 50.0, 5.0)],
        [],
    ),
    "drilled slot of the same radius": ([box(50.0, 50.0, 20.0, 10.0, 5.0), circle(45.0, 50.0, 5.0)], []),
    "cross": ([box(50.0, 50.0, 30.0, 6.0), box(50.0, 50.0, 6.0, 30.0)], [90] * 8 + [270] * 4),
    "sides on one line": ([box(40.0, 50.0, 20.0, 10.0), box(55.0, 50.0, 20.0, 10.0)], [90] * 4),
    "hole over a notch": ([notch(20.0, 50.0, 60.0), circle(20.0, 53.0, 4.0)], [60, 60, 229.49, 310.51]),
    "corner within a circle": ([box(50.0, 50.0, 20.0, 20.0), circle(60.0, 60.0, 5.0)], [90] * 3 + [270] * 2),
    "the same hole twice and another": (
        [circle(50.0, 50.0, 10.0), circle(50.0, 50.0, 10.0), circle(59.0, 50.0, 5.0)],
        [243.9] * 2,
    ),
}


@pytest.mark.parametrize(("holes", "angles"), UNIONS.values(), ids=UNIONS)
def test_overlapping_holes_are_one_outline(holes, angles):
    part = scene(*holes)
    (outline,) = part.outlines
    np.testing.assert_allclose(np.sort(np.degrees(outline.corner_angles)), np.sort(angles), atol=0.01)
    parts = [own for hole in part.holes for own in hole.outlines(part.box)]
    true = shapely.union_all([_polygon(own) for own in parts])
    assert shapely.Polygon(outline.polygon(20_000)).area == pytest.approx(true.area, rel=1e-5)
    # every point lies on one of the curves, to rounding
    points = outline.points(np.linspace(0.0, outline.length, 3001))
    away = [np.hypot(*(own.points(own.project(points)) - points).T) for own in parts]
    assert np.min(away, axis=0).max() < 2e-6 * outline.length
    # and follows them without a jump, at unit speed
    inner = outline.breaks[1:-1]
    assert np.abs(outline.points(inner - 1e-12) - outline.points(inner)).max() < 1e-9
    speed = np.linalg.norm(outline._derivatives(np.linspace(0.0, outline.length, 4001), 1)[0], axis=1)
    assert np.abs(speed - 1).max() < 1e-5


def test_a_union_turned_is_the_turned_union():
    c, s = np.cos(0.4), np.sin(0.4)
    at = np.array([[10.0, 0.0], [-10.0, 0.0]]) @ [[c, s], [-s, c]] + 50
    (one,) = scene(box(50.0, 50.0, 20.0, 4.0), circle(60.0, 50.0, 4.0), circle(40.0, 50.0, 4.0)).outlines
    (other,) = scene(
        box(50.0, 50.0, 20.0, 4.0, angle=np.degrees(0.4)), circle(*at[0], 4.0), circle(*at[1], 4.0)
    ).outlines
    assert other.length == pytest.approx(one.length, rel=1e-8)
    np.testing.assert_allclose(np.sort(other.corner_angles), np.sort(one.corner_angles), atol=1e-6)


@pytest.mark.parametrize(
    ("holes", "says"),
    [
        ([circle(50, 50, 20), circle(90, 50, 20)], "touch each other near .* let them overlap"),
        ([circle(50, 50, 10), circle(69.9995, 50, 10)], "touch each other"),
        ([circle(50, 50, 20), circle(50, 50, 3)], "one lies within the other"),
        (
            [box(50, 65, 40, 6), box(50, 35, 40, 6), box(35, 50, 6, 40), box(65, 50, 6, 40)],
            "enclose a loose piece of material at",
        ),
    ],
    ids=["touch", "overlap by rounding", "within", "island"],
)
def test_what_is_no_single_hole_is_refused(holes, says):
    with pytest.raises(SceneError, match=says):
        scene(*holes)


def test_the_keyhole_of_the_case_is_one_hole():
    part = read_scene("../shared/cases/14-keyhole/a.toml")
    assert len(part.outlines) == 1 and (part.outlines[0].corner_angles > np.pi).sum() == 2


def test_a_traced_hole_keeps_its_accuracy_in_a_union():
    part = read_scene("../shared/cases/11-picture-sharp-corners/a.toml")
    picture = part.holes[0].model_dump()
    (outline,) = part.with_(holes=[picture, circle(70.0, 50.0, 5.0)]).outlines
    assert len(outline.accuracy.tips) == 4 and len(outline.corners) == 6
