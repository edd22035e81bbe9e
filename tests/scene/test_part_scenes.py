"""`[part]`: any outer outline, and conditions on any stretch of any outline; what is refused."""

import numpy as np
import pytest

from slmm.initiation.positions import find_positions
from slmm.scene.errors import SceneError
from slmm.scene.scene import Scene

DISK = {"outline": {"shape": "circle", "center": [0.0, 0.0], "radius": 20.0}, "thickness": 2.0}
BRACKET = {
    "outline": {"shape": "polygon", "points": [[0, 0], [40, 0], [40, 20], [20, 20], [20, 50], [0, 50]]}
}
HOLE = {"shape": "circle", "center": [0.0, 5.0], "radius": 4.0}
PRESSED = {"on": "outer", "pressure": 3.0}


def scene(*boundary, part=DISK, **tables):
    return Scene.from_dict(
        {"part": part, "holes": [HOLE], "material": {"name": "PMMA"}, "boundary": list(boundary), **tables}
    )


def test_a_disk_has_the_rim_as_its_last_outline_with_the_material_on_the_right():
    disk = scene(PRESSED)
    hole, rim = disk.outlines
    assert disk.part.holes == (hole,) and disk.part.rim is rim
    at = np.linspace(0.0, rim.length, 7)
    inwards = -rim.points(at) / np.linalg.norm(rim.points(at), axis=1)[:, None]
    np.testing.assert_allclose(rim.normals(at), inwards, atol=1e-6)
    # a bulge of the part is no notch
    np.testing.assert_allclose(rim.curvatures(at), 1 / 20.0, rtol=1e-3)
    assert disk.size == pytest.approx(40.0)


def test_stretches_run_counter_clockwise_around_the_part_and_around_a_hole():
    loading = scene(
        {"from": [20, 0], "to": [0, 20], "traction": [1.0, 0.0]},
        {"from": [4, 5], "to": [0, 9], "traction": [-1.0, 0.0]},
        {"on": "outer", "displacement": ["free", 0.0]},
        {"at": [-20, 0], "width": 3.0, "displacement": [0.0, "free"]},
    ).loading
    outer, inner, _, short = loading
    assert outer.length == pytest.approx(np.pi * 10, rel=1e-4) and inner.length == pytest.approx(
        np.pi * 2, rel=1e-4
    )
    assert short.length == pytest.approx(3.0)
    rim_points = 20 * np.array([[np.cos(0.3), np.sin(0.3)], [np.cos(-0.3), np.sin(-0.3)]])
    hole_points = [0.0, 5.0] + 4 * np.array([[np.cos(0.3), np.sin(0.3)], [np.cos(-0.3), np.sin(-0.3)]])
    near = {"atol": 1e-4}
    for condition, points in ((outer, rim_points), (inner, hole_points)):
        on = condition.span.outline.points(condition.span.outline.project(points))
        np.testing.assert_allclose(on, points, **near)
        assert condition.on(on).tolist() == [True, False]


def test_pressure_acts_along_the_normal_and_a_force_is_spread_over_the_length():
    (pressed,) = scene(PRESSED).loading
    np.testing.assert_allclose(
        pressed.tractions(np.array([[0.0, 0.0]]), np.array([[0.6, 0.8]])), [[-1.8, -2.4]]
    )
    _, traction, weight = pressed.rule
    assert weight.sum() == pytest.approx(2 * np.pi * 20, rel=1e-6)
    assert np.abs(weight @ traction).max() < 1e-6
    held = {"from": [0, 20], "to": [0, -20], "displacement": [0.0, 0.0]}
    force = scene(held, {"from": [0, -20], "to": [0, 20], "force": [40.0, 0.0]}).loading.conditions[1]
    assert force.traction[0] == pytest.approx(40.0 / (2.0 * np.pi * 20), rel=1e-5)


def test_the_pressure_of_a_pin_has_its_force_and_acts_on_the_half_that_it_pushes_on():
    held = {"from": [-20, 0], "to": [0, -20], "displacement": [0.0, 0.0]}
    pin = scene(held, {"on": "hole 0", "pin": [0.0, 500.0]}).loading.conditions[1]
    points, traction, weight = pin.rule
    np.testing.assert_allclose(weight @ traction * 2.0, [0.0, 500.0], atol=2e-3)
    assert (traction[points[:, 1] < 5.0 - 1e-9] == 0).all()
    assert np.hypot(*traction.T).max() == pytest.approx(2 * 500 / (np.pi * 4 * 2), rel=1e-4)
    np.testing.assert_allclose(np.sort(pin.ends[-2:, 0]), [-4.0, 4.0], atol=1e-6)


def test_positions_are_on_the_outer_edge_too_but_where_it_is_held_or_juts_out():
    held, pulled = (
        {"from": [20, 50], "to": [0, 50], "displacement": [0.0, 0.0]},
        {"from": [40, 0], "to": [40, 20], "traction": [1.0, 0.0]},
    )
    bracket = scene(held, pulled, part=BRACKET, holes=[])
    where = find_positions(bracket, 40)
    assert set(where.hole) == {0}
    assert (where.points[:, 1] < 50.0 - 1e-6).all()
    corner = np.flatnonzero(np.isfinite(where.corner))
    np.testing.assert_allclose(where.points[corner], [[20.0, 20.0]], atol=1e-9)
    assert np.degrees(where.corner[corner]) == pytest.approx(90.0)


@pytest.mark.parametrize(
    ("boundary", "tables", "says"),
    [
        ([PRESSED], {"plate": {"width": 1.0, "height": 1.0}}, "part: contradicts plate"),
        ([], {"load": {"stress": 1.0}}, r"load: is the short form for plates"),
        ([{"on": "left", "pressure": 1.0}], {}, r'boundary\[0\]\.on = "left": is an edge of a plate'),
        ([{"on": "hole 3", "pressure": 1.0}], {}, r'boundary\[0\]\.on = "hole 3": the part has 1 holes'),
        ([{"on": "hole", "pressure": 1.0}], {}, r'boundary\[0\]\.on = "hole": must be one of'),
        (
            [{"at": [5, 15], "width": 1.0, "pressure": 1.0}],
            {},
            r"boundary\[0\]\.at = \[5, 15\]: must lie on a surface",
        ),
        (
            [{"from": [20, 0], "to": [4, 5], "pressure": 1.0}],
            {},
            r"boundary\[0\]\.to = \[4, 5\]: must lie on the same outline",
        ),
        ([{"on": "outer", "pin": [0.0, 1.0]}, PRESSED], {}, r"overlap, and act in the same direction"),
        (
            [{"from": [20, 0], "to": [0, 20], "pin": [0.0, -3.0]}],
            {},
            r"boundary\[0\]\.pin = \[0, -3\]: the hole is not alike on both sides",
        ),
        ([{"on": "hole 0", "pin": [5.0, 0.0]}], {}, r"does not balance: forces of \(2.5, 0\) N"),
        (
            [PRESSED, {"from": [20, 0], "to": [0, 20], "pressure": 1.0}],
            {},
            "overlap, and act in the same direction",
        ),
        ([PRESSED], {"holes": [HOLE | {"center": [30.0, 0.0]}]}, r"holes\[0\]: lies outside the part"),
        ([PRESSED], {"holes": [HOLE | {"center": [0.0, 16.0]}]}, r"holes\[0\]: just touches the part's edge"),
        ([PRESSED], {"cracks": [{"points": [[15.0, 0.0], [25.0, 0.0]]}]}, r"cracks\[0\]: leaves the part"),
        (
            [PRESSED],
            {
                "part": {
                    "outline": {"shape": "polygon", "points": [[0, 0], [4, 0], [4, 4]], "corner_radii": [1.0]}
                }
            },
            r"part\.outline: corner_radii has 1 entries: must have one for each of the 3",
        ),
        (
            [PRESSED],
            {"part": {"outline": {"shape": "points", "points": [[0, 0], [4, 0], [4, 4]]}}},
            r"part\.outline: ",
        ),
        ([PRESSED], {"part": {"outline": {"shape": "v-notch"}}}, r"part\.outline\.shape = \"v-notch\""),
        ([PRESSED], {"part": {"outline": {"shape": "circle", "centre": [0, 0]}}}, r"part\.outline\.centre"),
    ],
)
def test_what_is_wrong_is_named_with_its_key(boundary, tables, says):
    if "load" in tables:
        tables = {**tables}
        with pytest.raises(SceneError, match=says):
            Scene.from_dict({"part": DISK, "material": {"name": "PMMA"}, **tables})
        return
    with pytest.raises(SceneError, match=says):
        scene(*boundary, **tables)


def test_a_part_gives_way_to_a_plate():
    disk = scene(PRESSED)
    plate = disk.with_(plate={"width": 50.0, "height": 60.0}, holes=[HOLE | {"center": [20.0, 20.0]}])
    assert plate.part_table is None and plate.plate.height == 60.0
    assert plate.with_(part=DISK, holes=[HOLE]).plate is None
