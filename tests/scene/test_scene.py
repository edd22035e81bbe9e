import copy
import pickle

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from slmm.part import shapes
from slmm.scene.errors import SceneError
from slmm.scene.scene import Scene, read_scene

CIRCLE = {"shape": "circle", "center": [50.0, 50.0], "radius": 20.0}
ELLIPSE = {"shape": "ellipse", "center": [50.0, 50.0], "semi_axes": [20.0, 10.0]}
RECTANGLE = {"shape": "rectangle", "center": [50.0, 50.0], "size": [30.0, 20.0], "corner_radius": 5.0}
POLYGON = {"shape": "polygon", "points": [[40.0, 40.0], [60.0, 40.0], [60.0, 60.0]]}
SQUARE = {"shape": "rectangle", "center": [50.0, 50.0], "size": [20.0, 20.0], "corner_radius": 0}
DIAMOND = {"shape": "polygon", "points": [[60, 50], [50, 60], [40, 50], [50, 40]], "corner_radius": 2.0}
V_NOTCH = {"shape": "v-notch", "tip": [10.0, 50.0], "direction": 0.0, "opening": 60.0}
BASE = {
    "plate": {"width": 100.0, "height": 100.0},
    "holes": [CIRCLE],
    "material": {"name": "PMMA"},
    "load": {"strain": [0.0, 0.1, 0.0]},
}
USER = {"E": 3000.0, "nu": 0.3, "sigma_c": 50.0}


def scene_with(**tables):
    return {**copy.deepcopy(BASE), **tables}


def outline_of(points):
    return {"holes": [{"shape": "points", "points": np.asarray(points).tolist()}]}


def star(n=200):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.column_stack([50 + 20 * np.sin(t), 50 + 20 * np.sin(2 * t + 0.3)])  # a figure of eight


#: around a square of material
FOUR_BARS = [((50, 65), (40, 6)), ((50, 35), (40, 6)), ((35, 50), (6, 40)), ((65, 50), (6, 40))]
RING = shapes.circle((50.0, 50.0), 20.0)[::10]


def material(**changes):
    return {"material": {"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "K_Ic": 1.96, **changes}}


REFUSED = [
    # keys
    ({"colour": "red"}, r'^colour = "red": is not a known key; known here: title, plate, holes'),
    ({"holes": [{**CIRCLE, "raduis": 3}]}, r"^holes\[0\]\.raduis = 3: is not a known key;.* radius$"),
    ({"plate": {"width": 100.0}}, r"^plate\.height: is missing"),
    ({"plate": 7}, r"^plate = 7: must be a table"),
    ({"holes": {"shape": "circle"}}, r"^holes = .*must be a list"),
    ({"title": 3}, r"^title = 3: must be a text"),
    # numbers
    ({"holes": [{**CIRCLE, "radius": -3}]}, r"^holes\[0\]\.radius = -3: must be greater than 0 mm$"),
    ({"holes": [{**CIRCLE, "radius": float("inf")}]}, r"^holes\[0\]\.radius = inf: must be"),
    ({"holes": [{**CIRCLE, "radius": "20"}]}, r'^holes\[0\]\.radius = "20": must be a number'),
    ({"holes": [{**CIRCLE, "center": [50.0]}]}, r"^holes\[0\]\.center\[1\]: is missing"),
    (
        {"holes": [{**CIRCLE, "center": [1, 2, 3]}]},
        r"^holes\[0\]\.center: has 3 entries; must have at most 2",
    ),
    (
        {"holes": [{**CIRCLE, "center": [float("nan"), 2]}]},
        r"^holes\[0\]\.center\[0\] = nan: must be a finite",
    ),
    ({"plate": {"width": 100.0, "height": 0}}, r"^plate\.height = 0: must be greater than 0"),
    (
        {"plate": {"width": 100.0, "height": 100.0, "thickness": True}},
        r"^plate\.thickness = True: must be a num",
    ),
    # shapes
    ({"holes": [{**CIRCLE, "shape": "cirkle"}]}, r'^holes\[0\]\.shape = "cirkle": must be one of \'circle\''),
    ({"holes": [{"center": [1, 2]}]}, r"^holes\[0\]\.shape: is missing; circle.*polygon, v-notch"),
    ({"holes": [{**RECTANGLE, "corner_radius": 11}]}, r"^holes\[0\]: corner_radius = 11: .*smaller side, 10"),
    (
        {"holes": [{**RECTANGLE, "corner_radius": -1}]},
        r"^holes\[0\]: corner_radius = -1: must be at least 0, for sharp corners",
    ),
    (
        {"holes": [{**POLYGON, "points": [[1, 2], [3, 4]]}]},
        r"^holes\[0\]\.points: has 2 entries; must have at l",
    ),
    (
        {"holes": [{**POLYGON, "points": [[1, 2], [3, 4], [1, 2]]}]},
        r"^holes\[0\]: has 2 different points: must have between 3 and 1,000 as corners",
    ),
    (
        {"holes": [{**POLYGON, "points": [[40, 40], [60, 60], [60, 40], [40, 60]]}]},
        r"^holes\[0\]: the outline crosses or touches itself: Self-intersection\[50 50\]",
    ),
    (
        {"holes": [{**POLYGON, "points": [[1, 1], [1, 1], [2, 1], [2, 1]]}]},
        r"^holes\[0\]: has 2 different points: must have between 3 and 1,000 as corners",
    ),
    (
        {"holes": [{**POLYGON, "points": [[1, 1], [2, 2], [3, 3]]}]},
        r"^holes\[0\]: the outline crosses or touches",
    ),
    (
        {"holes": [{**POLYGON, "corner_radius": 6}]},
        r"^holes\[0\]: corner_radius = 6: does not fit between points .* must be at most 5.85786 there",
    ),
    ({"holes": [{**POLYGON, "corner_radius": -1}]}, r"^holes\[0\]\.corner_radius = -1: must be at least 0"),
    ({"holes": [{**V_NOTCH, "opening": 180}]}, r"^holes\[0\]\.opening = 180: must be less than 180"),
    ({"holes": [{**V_NOTCH, "opening": -1}]}, r"^holes\[0\]\.opening = -1: must be at least 0"),
    ({"holes": [{**V_NOTCH, "opening": 0}]}, r"^holes\[0\]: opening = 0: .* needs a radius"),
    (
        {"holes": [{**V_NOTCH, "opening": 0.01}]},
        r"^holes\[0\]: the outline turns back on itself at \(10, 50\)",
    ),
    (
        {"holes": [{**V_NOTCH, "radius": 8.0, "depth": 4.0}]},
        r"^holes\[0\]: depth = 4: must be greater than 4, where the flanks begin",
    ),
    ({"holes": [{**V_NOTCH, "tip": [110.0, 50.0]}]}, r"^holes: cut the plate into 2 pieces"),
    ({"holes": [{**V_NOTCH, "tip": [-10.0, 50.0]}]}, r"^holes\[0\]: lies outside the plate"),
    ({"holes": [{**V_NOTCH, "depth": 10.0}]}, r"^holes\[0\]: just touches the plate's edge"),
    (
        {"holes": [{**V_NOTCH, "deep": 10.0}]},
        r"^holes\[0\]\.deep = 10.0: is not a known key; .* radius, depth$",
    ),
    (
        {"holes": [{**RECTANGLE, "size": [30.0, 1e-4], "corner_radius": 0}]},
        r"^holes\[0\]: is too small for the pl",
    ),
    (
        {"holes": [{**ELLIPSE, "semi_axes": [30.0, 0.2]}]},
        r"^holes\[0\]: the outline has a corner at \(80, 50\)",
    ),
    ({"holes": [{"shape": "points"}]}, r"^holes\[0\]: needs exactly one of points, file; it has none"),
    (outline_of(RING[:5]), r"^holes\[0\]: has 5 different points: must have between 8 and"),
    (outline_of(np.repeat(RING[:7], 2, axis=0)), r"^holes\[0\]: has 7 different points"),
    (outline_of(star()), r"^holes\[0\]: the outline crosses or touches itself"),
    (
        outline_of(
            [
                [20 + 5 * x, 20 + 5 * y]
                for x, y in [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
            ]
        ),
        r"turns by 90 degrees at point",
    ),
    (
        {"holes": [{"shape": "points", "file": "no.csv"}]},
        r'^holes\[0\]\.file = "no.csv": there is no such file',
    ),
    # holes and plate
    ({"holes": [{**CIRCLE, "radius": 500}]}, r"^holes\[0\]: covers the whole plate"),
    ({"holes": [{**CIRCLE, "center": [200, 50]}]}, r"^holes\[0\]: lies outside the plate"),
    ({"holes": [{**CIRCLE, "center": [-20, 50]}]}, r"^holes\[0\]: lies outside the plate"),
    ({"holes": [{**CIRCLE, "radius": 1e-6}]}, r"^holes\[0\]: is too small for the plate"),
    ({"holes": [{**CIRCLE, "center": [20, 50]}]}, r"^holes\[0\]: just touches the plate's edge"),
    ({"holes": [CIRCLE, CIRCLE]}, r"^holes\[0\] and holes\[1\]: one lies within the other"),
    ({"holes": [CIRCLE, {**CIRCLE, "radius": 3}]}, r"^holes\[0\] and holes\[1\]: one lies within the other"),
    (
        {"holes": [CIRCLE, {**CIRCLE, "center": [89.9995, 50]}]},
        r"^holes\[0\] and holes\[1\]: touch each other near \(69.9[0-9]*, 50\); move them apart, or let them overlap",
    ),
    ({"holes": [CIRCLE, {**CIRCLE, "center": [90, 50]}]}, r"^holes\[0\] and holes\[1\]: touch each other"),
    (
        {"holes": [{**SQUARE, "center": c, "size": s} for c, s in FOUR_BARS]},
        r"^holes\[0\] and holes\[1\] and .*: enclose a loose piece of material at \(5[0-9.]*, 5[0-9.]*\)",
    ),
    ({"holes": [{**RECTANGLE, "size": [120, 20]}]}, r"^holes: cut the plate into 2 pieces"),
    # cracks
    ({"cracks": [{"points": [[0, 40]]}]}, r"^cracks\[0\]\.points: has 1 entries; must have at least 2"),
    ({"cracks": [{"points": [[-10, 40], [10, 40]]}]}, r"^cracks\[0\]: leaves the plate"),
    (
        {"cracks": [{"points": [[40, 50], [60, 50]]}]},
        r"^cracks\[0\]: does not run through the material",
    ),
    ({"cracks": [{"points": [[0, 50], [90, 50]]}]}, r"^cracks\[0\]: runs through a hole"),
    ({"cracks": [{"points": [[0, 50], [0, 50]]}]}, r"^cracks\[0\]: points 0 and 1 coincide"),
    (
        {"cracks": [{"points": [[30, 0], [0, 0], [10, 10]]}]},
        r"^cracks\[0\]: runs through a hole or along an edge",
    ),
    (
        {"holes": [POLYGON], "cracks": [{"points": [[40, 40], [60, 40], [70, 40]]}]},
        r"^cracks\[0\]: runs through a hole or along an edge",
    ),
    (
        {"cracks": [{"points": [[0, 10], [20, 10], [10, 20], [10, 5]]}]},
        r"^cracks\[0\]: crosses or touches itself",
    ),
    (
        {"cracks": [{"points": [[0, 10], [20, 10]]}, {"points": [[10, 10.0001], [25, 10.0001]]}]},
        r"^cracks\[0\] and cracks\[1\]: run along each other",
    ),
    # material
    ({"material": {"name": "PMM"}}, r'^material\.name = "PMM": must be one of PMMA, PS, Al2O3'),
    ({"material": {"name": "PMMA", "E": 3.0}}, r"^material: name .*contradicts E"),
    ({"material": {"E": 3.0, "K_Ic": 1.0}}, r"^material: nu, sigma_c missing"),
    ({"material": USER}, r"^material: needs exactly one of K_Ic, G_c; it has none"),
    ({"material": {**USER, "K_Ic": 1.0, "G_c": 1.0}}, r"^material: .*it has K_Ic and G_c"),
    ({"material": {**USER, "nu": 0.5, "G_c": 1.0}}, r"^material\.nu = 0.5: must be less than 0.5"),
    ({"material": {"name": "PMMA", "state": "plane"}}, r'^material\.state = "plane": must be one of'),
    # load
    ({"load": {}}, r"^load: needs exactly one of strain, displacement, stress; it has none"),
    ({"load": {"strain": [0, 1, 0], "stress": 2}}, r"^load: .*it has strain and stress"),
    ({"load": {"strain": [0, 0, 0]}}, r"^load: is zero"),
    ({"load": {"stress": 0}}, r"^load: is zero"),
    ({"load": {"strain": [0, 0.1]}}, r"^load\.strain\[2\]: is missing"),
    # analysis
    ({"analysis": {"method": "fea"}}, r"^analysis\.method = \"fea\": must be one of 'rankine'"),
    ({"analysis": {"voxels": "many"}}, r'^analysis\.voxels = "many": must be "auto" or a whole number'),
    ({"analysis": {"voxels": 3}}, r'^analysis\.voxels = 3: must be "auto" or a whole number'),
    ({"analysis": {"positions": 0}}, r"^analysis\.positions = 0: must be at least 1"),
    ({"analysis": {"positions": 2.5}}, r"^analysis\.positions = 2.5: must be a whole number"),
    ({"analysis": {"positions": 9, "points": [[1, 2]]}}, r"^analysis: positions and points contradict"),
    (
        {"analysis": {"points": [[1, 200]]}},
        r"^analysis\.points\[0\] = \[1, 200\]: must lie in or near the plate",
    ),
    ({"analysis": {"points": []}}, r"^analysis\.points: has 0 entries"),
    ({"analysis": {"average": 1}}, r"^analysis\.average = 1: must be true or false"),
    (material(K_Ic=-1.0), r"^material\.K_Ic = -1.0: must be greater than 0 MPa sqrt\(m\)$"),
    (material(E=1e31), r"^material\.E = 1e\+31: must be at most 1e\+30 MPa$"),
    (material(nu=35.0), r"^material\.nu = 35.0: must be less than 0.5$"),
    ({"holes": [{**CIRCLE, "radius": 1e-12}]}, r"radius = 1e-12: must be at least 1e-09 mm$"),
    ({"analysis": {"tolerance": 0.6}}, r"^analysis\.tolerance = 0.6: must be at most 0.5"),
    ({"analysis": {"tolerance": 1e-4}}, r"^analysis\.tolerance = 0.0001: must be at least 0.0005"),
    ({"analysis": {"tolerances": 0.1}}, r"^analysis\.tolerances = 0.1: .*known here: .* average, tolerance$"),
    ({"analysis": {"void_stiffness": 1}}, r"^analysis\.void_stiffness = 1: must be at most 0.1"),
]


@pytest.mark.parametrize(("tables", "says"), REFUSED, ids=[says[1:40] for _, says in REFUSED])
def test_what_is_wrong_is_named_with_its_key_and_value(tables, says):
    with pytest.raises(SceneError, match=says):
        Scene.from_dict(scene_with(**tables))


@pytest.mark.parametrize("section", ["plate", "material", "load"])
def test_a_section_that_is_missing_is_named(section):
    tables = scene_with()
    del tables[section]
    with pytest.raises(SceneError, match=f"^{section}: is missing$"):
        Scene.from_dict(tables)


def test_all_problems_are_listed_at_once_with_the_file(tmp_path):
    (tmp_path / "a.toml").write_text(
        '[plate]\nwidth = -1\nheight = "a"\n[material]\nname="PS"\n[load]\nstress=1\n'
    )
    with pytest.raises(SceneError) as caught:
        read_scene(tmp_path / "a.toml")
    assert str(caught.value).splitlines() == [
        f"{tmp_path / 'a.toml'}: 2 problems",
        "  plate.width = -1: must be greater than 0 mm",
        '  plate.height = "a": must be a number',
    ]


def test_a_file_that_is_missing_or_no_toml_is_named(tmp_path):
    with pytest.raises(SceneError, match=r"none\.toml: cannot be read"):
        read_scene(tmp_path / "none.toml")
    (tmp_path / "b.toml").write_text("plate = [")
    with pytest.raises(SceneError, match=r"b\.toml: is not a TOML file"):
        read_scene(tmp_path / "b.toml")
    (tmp_path / "c.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SceneError, match=r"c\.toml: is not a TOML file"):
        read_scene(tmp_path / "c.toml")


@pytest.mark.parametrize("hole", [CIRCLE, ELLIPSE, RECTANGLE, SQUARE, DIAMOND, outline_of(RING)["holes"][0]])
def test_every_shape_gives_one_outline(hole):
    (outline,) = Scene.from_dict(scene_with(holes=[hole])).outlines
    np.testing.assert_allclose(outline.polygon(400).mean(axis=0), (50, 50), atol=1e-3)


def test_a_notch_may_cut_the_edge_and_a_crack_may_start_at_the_edge_or_in_a_hole():
    scene = Scene.from_dict(
        scene_with(
            holes=[{**CIRCLE, "center": [0, 50]}, {**CIRCLE, "center": [100, 100], "radius": 5}],
            cracks=[{"points": [[19, 50], [25, 52], [30, 52]]}, {"points": [[100, 10], [90, 10]]}],
        )
    )
    assert len(scene.outlines) == 2 and scene.cracks[0].points[-1] == (30.0, 52.0)


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


@settings(max_examples=30)
@given(
    angle=st.floats(0, 360),
    share=st.floats(0, 1),
    length=st.floats(0.5, 20),
    side=st.integers(0, 3),
    turn=st.floats(-80, 80),
)
def test_a_crack_may_start_at_any_corner_and_anywhere_on_an_edge(angle, share, length, side, turn):
    hole = {**RECTANGLE, "corner_radius": 0, "angle": angle}
    (outline,) = Scene.from_dict(scene_with(holes=[hole])).outlines
    start = outline.corners[side]
    s = start + share * ((outline.corners[(side + 1) % 4] - start) % outline.length)
    normal = outline.normals(s)
    c, sine = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    direction = np.array([c * normal[0] - sine * normal[1], sine * normal[0] + c * normal[1]])
    points = [outline.points(s), outline.points(s) + length * direction]
    scene = Scene.from_dict(scene_with(holes=[hole], cracks=[{"points": np.array(points)}]))
    assert scene.cracks[0].points[-1] == tuple(points[1])


def test_cracks_may_start_at_the_tips_of_notches():
    cracks = [{"points": [[10, 50], [20, 52]]}, {"points": [[40, 40], [30, 30]]}]
    assert len(Scene.from_dict(scene_with(holes=[V_NOTCH, POLYGON], cracks=cracks)).cracks) == 2


@pytest.mark.parametrize("method", ["mises", "asymptotics", "griffith", "dislocations", "auto"])
def test_the_analysis_says_how_to_compute(method):
    analysis = Scene.from_dict(
        scene_with(analysis={"method": method, "average": True, "tolerance": 0.01})
    ).analysis
    assert (analysis.method, analysis.average, analysis.tolerance) == (method, True, 0.01)
    default = Scene.from_dict(BASE).analysis
    assert (default.average, default.tolerance) == (False, 0.02)


def test_a_plate_needs_no_hole():
    assert Scene.from_dict(scene_with(holes=[], cracks=[{"points": [[0, 40], [10, 40]]}])).outlines == ()


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


def test_the_material_follows_name_toughness_or_energy():
    by_energy = Scene.from_dict(scene_with(material={**USER, "G_c": 0.5})).material
    assert (by_energy.E, by_energy.G_c) == (3000.0, 0.5)
    by_toughness = Scene.from_dict(scene_with(material={**USER, "K_Ic": 1.0})).material
    assert by_toughness.G_c == pytest.approx(1000.0 / 3000.0)
    strain = Scene.from_dict(scene_with(material={**USER, "K_Ic": 1.0, "state": "plane strain"})).material
    assert strain.G_c == pytest.approx(1000.0 / 3000.0 * (1 - 0.3**2))


def test_a_changed_scene_is_a_new_one_and_checked():
    scene = Scene.from_dict(scene_with(analysis={"positions": 9}))
    changed = scene.with_(load={"stress": 5.0}, analysis={"points": [[70, 50]], "voxels": 10_000})
    assert scene.load.strain == (0.0, 0.1, 0.0) and scene.analysis.points is None
    assert changed.load.strain is None and changed.load.stress == 5.0 and changed.analysis.voxels == 10_000
    assert changed.with_(analysis={"positions": 7}).analysis.points is None
    assert changed.outlines[0] is scene.outlines[0]  # the geometry is the same and not computed again
    assert scene.with_(material={"state": "plane strain"}).material.name == "PMMA"
    assert scene.with_(material={**USER, "G_c": 0.5}).with_(material={"K_Ic": 1.0}).material.E == 3000.0
    assert scene.with_(holes=[{**CIRCLE, "radius": 10}]).outlines[0].length < 63
    with pytest.raises(SceneError, match=r"covers"):
        scene.with_(plate={"width": 5.0, "height": 5.0}, holes=[{**CIRCLE, "center": [2.0, 2.0]}])
    with pytest.raises(SceneError, match=r"^analysis\.methods"):
        scene.with_(analysis={"methods": "slmm"})
    with pytest.raises(SceneError, match=r"^colour"):
        scene.with_(colour=1)


def test_a_scene_is_immutable_and_travels_between_processes():
    scene = Scene.from_dict(scene_with())
    with pytest.raises(ValueError, match="frozen"):
        scene.title = "other"
    copied = pickle.loads(pickle.dumps(scene))
    assert copied == scene and copied.outlines[0].length == scene.outlines[0].length
