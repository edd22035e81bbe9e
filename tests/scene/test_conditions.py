"""`[[boundary]]`: stretches of a plate's edge that are held, moved or loaded, and what is refused."""

import numpy as np
import pytest

from slmm.part.part import Part
from slmm.scene.conditions import Boundary
from slmm.scene.errors import SceneError
from slmm.scene.loading import Affine, Condition
from slmm.scene.places import located
from slmm.scene.scene import Scene

PLATE = {"width": 40.0, "height": 20.0, "thickness": 2.0}
HOLE = {"shape": "circle", "center": [20, 10], "radius": 4}
HELD = {"on": "bottom", "displacement": [0.0, 0.0]}


def scene(*boundary, **tables):
    return Scene.from_dict(
        {"plate": PLATE, "holes": [HOLE], "material": {"name": "PMMA"}, "boundary": list(boundary), **tables}
    )


def stretches(table):
    return located(Boundary.model_validate(table), Part.plate(40.0, 20.0))


def test_an_edge_by_its_name_and_all_of_them():
    loading = scene({"on": "outer", "displacement": [0.1, "free"]}).loading
    assert [c.start for c in loading] == [(0, 0), (40, 0), (40, 20), (0, 20)]
    assert all(c.displacement == (Affine(0.1), None) for c in loading)
    assert stretches({"on": "left", "traction": [1, 0]}) == [((0.0, 20.0), (0.0, 0.0))]


def test_a_stretch_by_its_ends_goes_round_corners_counter_clockwise():
    assert stretches({"from": [10, 20], "to": [5, 20], "traction": [0, 1]}) == [((10.0, 20.0), (5.0, 20.0))]
    round_corner = stretches({"from": [40, 15], "to": [30, 20], "traction": [1, 0]})
    assert round_corner == [((40.0, 15.0), (40.0, 20.0)), ((40.0, 20.0), (30.0, 20.0))]
    # the long way
    assert len(stretches({"from": [5, 20], "to": [10, 20], "traction": [1, 0]})) == 5


def test_a_short_stretch_about_a_point():
    assert stretches({"at": [12, 20], "width": 0.5, "traction": [0, 1]}) == [((12.25, 20.0), (11.75, 20.0))]


def test_pressure_pushes_onto_the_surface_and_a_force_spreads_over_the_material():
    for edge, traction in (("top", (0, -3)), ("right", (-3, 0)), ("left", (3, 0))):
        condition = scene(HELD, {"on": edge, "pressure": 3.0}).loading.conditions[1]
        assert condition.traction == pytest.approx(traction)
    force = scene(HELD, {"on": "top", "force": [0.0, 160.0]}).loading.conditions[1]
    assert force.traction == pytest.approx((0.0, 160.0 / 80.0))
    notch = {"shape": "circle", "center": [20, 20], "radius": 4}
    force = scene(HELD, {"on": "top", "force": [0.0, 160.0]}, holes=[notch]).loading.conditions[1]
    assert force.traction[1] == pytest.approx(160.0 / 64.0, rel=1e-4)


def test_the_general_form_of_a_short_load_is_that_load():
    short = Scene.from_dict(
        {"plate": PLATE, "material": {"name": "PMMA"}, "holes": [HOLE], "load": {"displacement": 0.1}}
    )
    general = scene(
        {"on": "bottom", "displacement": ["free", 0.0]}, {"on": "top", "displacement": ["free", 0.1]}
    )
    assert general.loading == short.loading
    pulled = scene({"on": "bottom", "traction": [0.0, -5.0]}, {"on": "top", "traction": [0.0, 5.0]})
    assert pulled.loading == short.with_(load={"stress": 5.0}).loading


def test_one_form_gives_way_to_the_other():
    general = scene(HELD, {"on": "top", "pressure": 3.0})
    short = general.with_(load={"stress": 5.0})
    assert short.boundary == () and short.load.stress == 5.0
    again = short.with_(boundary=[HELD, {"on": "top", "pressure": 3.0}])
    assert again.load is None and again.loading == general.loading
    assert isinstance(again.loading.conditions[0], Condition)


@pytest.mark.parametrize(
    ("boundary", "says"),
    [
        (
            [{"displacement": [0, 0]}],
            r"boundary\[0\]: needs exactly one of on, from and to, at and width; it has none",
        ),
        ([HELD | {"at": [1, 0], "width": 1}], r"boundary\[0\]: needs exactly one of .*; it has on and at"),
        ([{"on": "bottom"}], r"boundary\[0\]: needs exactly one of displacement, traction, pressure, force"),
        ([{"from": [1, 0], "traction": [1, 0]}], r"boundary\[0\]: from and to belong together"),
        ([{"at": [1, 0], "traction": [1, 0]}], r"boundary\[0\]: at and width belong together"),
        ([{"on": "bottom", "displacement": ["free", "free"]}], "holds nothing"),
        ([{"on": "middle", "pressure": 1}], r"boundary\[0\]\.on = \"middle\": must be one of"),
        ([{"on": "bottom", "presure": 1}], r"boundary\[0\]\.presure.*pressure"),
        (
            [HELD, {"at": [12, 10], "width": 1, "pressure": 1}],
            r"boundary\[1\]\.at = \[12, 10\]: must lie on the plate's edge",
        ),
        (
            [HELD, {"at": [0.2, 20], "width": 1, "pressure": 1}],
            r"boundary\[1\]\.width = 1: the stretch goes beyond the top",
        ),
        (
            [HELD, {"from": [1, 20], "to": [1, 20], "pressure": 1}],
            r"boundary\[1\]\.from and to are the same point",
        ),
        (
            [HELD, {"on": "outer", "pressure": 1}],
            r"boundary\[0\] and boundary\[1\]: overlap, and act in the same direction",
        ),
        ([HELD], "boundary: moves and loads nothing"),
        ([{"on": "top", "pressure": 1}], r"does not balance: forces of \(0, -40\) N"),
        (
            [{"on": "left", "traction": [0, 1]}, {"on": "right", "traction": [0, -1]}],
            "does not balance: forces of .*, or a moment",
        ),
    ],
)
def test_what_is_wrong_is_named_with_its_key(boundary, says):
    with pytest.raises(SceneError, match=says):
        scene(*boundary)


def test_conditions_where_notches_have_taken_the_material_are_refused():
    notch = {"shape": "circle", "center": [20, 20], "radius": 4}
    with pytest.raises(SceneError, match=r"boundary\[1\]: no material there, between the notches"):
        scene(HELD, {"at": [20, 20], "width": 2.0, "pressure": 1.0}, holes=[notch])


def test_a_load_that_is_free_to_move_but_balances_is_taken():
    shear = [
        {"on": edge, "traction": t}
        for edge, t in zip(
            ("bottom", "right", "top", "left"), ([-1, 0], [0, 1], [1, 0], [0, -1]), strict=True
        )
    ]
    assert len(scene(*shear).loading.conditions) == 4


def test_both_forms_contradict_each_other():
    with pytest.raises(SceneError, match="load: contradicts boundary"):
        scene(HELD, {"on": "top", "pressure": 1}, load={"stress": 1.0})
    with pytest.raises(SceneError, match="load: is missing"):
        scene()
    assert np.isfinite(scene(HELD, {"on": "top", "pressure": 1}).loading.nominal_stress(1.0))
