"""What is wrong in a scene is named with its key, its value and what would be right."""

import numpy as np
import pytest
from scene_tables import (
    CIRCLE,
    ELLIPSE,
    POLYGON,
    RECTANGLE,
    RING,
    SQUARE,
    USER,
    V_NOTCH,
    outline_of,
    scene_with,
)

from slmm.scene.errors import SceneError
from slmm.scene.scene import Scene, read_scene


def star(n=200):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.column_stack([50 + 20 * np.sin(t), 50 + 20 * np.sin(2 * t + 0.3)])  # a figure of eight


#: around a square of material
FOUR_BARS = [((50, 65), (40, 6)), ((50, 35), (40, 6)), ((35, 50), (6, 40)), ((65, 50), (6, 40))]


def material(**changes):
    return {"material": {"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "K_Ic": 1.96, **changes}}


REFUSED = [
    # keys
    ({"colour": "red"}, r'^colour = "red": is not a known key; known here: title, plate, part, holes'),
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
    (
        {"analysis": {"tolerances": 0.1}},
        r"^analysis\.tolerances = 0.1: .*known here: .* average, criterion, tolerance, direction$",
    ),
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
