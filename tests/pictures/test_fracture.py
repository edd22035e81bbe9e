"""The picture of a fracture process shows its cracks, its curves, and what was in question."""

import numpy as np
import pytest

from slmm.fracture import simulate
from slmm.fracture.critical_state import critical_state
from slmm.pictures.fracture import plot_fracture
from slmm.scene.gallery import tensile_plate


@pytest.fixture(scope="module")
def one_hole():
    scene = tensile_plate([(40.0, 40.0, 8.0)])
    return scene, simulate(scene, increment=8.0)


def panels(figure):
    return {axes.get_label(): axes for axes in figure.axes}


def segments(axes):
    return [
        line for lines in axes.collections if hasattr(lines, "get_segments") for line in lines.get_segments()
    ]


def test_cracks_and_curve_are_drawn_and_numbered_alike(one_hole):
    scene, result = one_hole
    drawn = panels(plot_fracture(scene, result))
    for name in ("part", "force", "steps"):
        assert [text.get_text() for text in drawn[name].texts] == ["0", "1"], name
    # the initial crack, and every increment
    of_cracks = [line for line in segments(drawn["part"]) if 0.0 < line[0][1] < 80.0]
    assert len(of_cracks) == 1 + result.sizes["step"]
    assert np.array_equal(drawn["force"].lines[0].get_xydata(), np.column_stack([result.u, result.F]))


def test_the_equilibrium_path_is_broken_where_a_crack_starts(one_hole):
    scene, result = one_hole
    force = panels(plot_fracture(scene, result))["force"]
    paths = [line.get_xydata() for line in force.lines if line.get_color() == "0.45" and line.get_ls() == "-"]
    assert len(paths) == 2
    every = np.column_stack([result.equilibrium_u, result.equilibrium_F])
    assert np.array_equal(np.concatenate(paths), every)


def test_each_crack_has_a_line_of_its_critical_displacements(one_hole):
    scene, result = one_hole
    steps = panels(plot_fracture(scene, result))["steps"]
    named = {line.get_label(): line.get_xydata() for line in steps.lines}
    assert {"crack 0", "crack 1", "a surface"} <= set(named)
    own = result.tip.values[named["crack 0"][:, 0].astype(int) - 1]
    assert (own == 0).all()
    assert named["crack 0"][:, 1] == pytest.approx(result.u_c.values[: len(own)])


def test_cracks_are_drawn_open_as_far_as_they_are_times_the_factor(one_hole):
    scene, result = one_hole
    part = panels(plot_fracture(scene, result, magnified=10.0))["part"]
    state = critical_state(scene, result, result.sizes["step"] - 1)
    drawn = np.array([np.ptp(patch.get_xy()[:, 1]) for patch in part.patches[2:]])
    for faces, extent in zip(state.faces, drawn, strict=True):
        both = np.concatenate([faces.points + 10 * faces.left, faces.points + 10 * faces.right])
        assert extent == pytest.approx(np.ptp(both[:, 1]))
        assert extent > 5 * np.linalg.norm(faces.left - faces.right, axis=1).max()


def test_a_part_that_nothing_happens_to_is_drawn():
    scene = tensile_plate(displacement=-1.0, cracks=[])
    result = simulate(scene, errors=False)
    for magnified in (0.0, 5.0):
        plot_fracture(scene, result, magnified).canvas.draw()


@pytest.mark.parametrize("magnified", [-1.0, float("nan"), float("inf")])
def test_what_displacements_cannot_be_multiplied_by_is_refused(one_hole, magnified):
    with pytest.raises(ValueError, match="magnified = "):
        plot_fracture(*one_hole, magnified)
