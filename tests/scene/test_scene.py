"""A scene knows its geometry, material and analysis, and is changed only into another one."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_tables import BASE, CIRCLE, POLYGON, RECTANGLE, USER, V_NOTCH, scene_with

from slmm.scene.errors import SceneError
from slmm.scene.scene import Scene


def test_a_notch_may_cut_the_edge_and_a_crack_may_start_at_the_edge_or_in_a_hole():
    scene = Scene.from_dict(
        scene_with(
            holes=[{**CIRCLE, "center": [0, 50]}, {**CIRCLE, "center": [100, 100], "radius": 5}],
            cracks=[{"points": [[19, 50], [25, 52], [30, 52]]}, {"points": [[100, 10], [90, 10]]}],
        )
    )
    assert len(scene.outlines) == 2 and scene.cracks[0].points[-1] == (30.0, 52.0)


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
