"""Displacements are found by the names that programs give them; where several fit, nobody guesses."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from slmm.mechanics.elasticity import Elasticity
from slmm.results.displacement_names import find_displacements
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

DATA, CASES = Path(__file__).parents[1] / "data", Path(__file__).parents[3] / "shared" / "cases"
U = np.array([[0.0, 0, 0], [1, 2, 0], [3, 4, 0]])
OTHERS = {"T": np.ones(3), "velocity": -U, "stress": np.ones((3, 6)), "f": 5 * U}


@pytest.mark.parametrize(
    "name",
    [
        "displacement", "Displacements", "DISP", "U", "uh", "u_h", "Deformation", "DISPL", "RESU____DEPL",
        "resu____DEPL_Vector", "00000008DEPL", "Displacement Vectors", "displacement_vector", "Nodal_Displacement",
        "displacement 1", "DISPLACEMENT_FIELD",
    ],
)  # fmt: skip
def test_vectors_have_the_names_of_many_programs(name):
    found = find_displacements(OTHERS | {name: U})
    assert found.name == name and np.array_equal(found.steps[-1], U)


@pytest.mark.parametrize(
    "names",
    [
        ("disp_x", "disp_y", "disp_z"),
        ("DISPX", "DISPY", "DISPZ"),
        ("UX", "UY", "UZ"),
        ("U1", "U2", "U3"),
        ("u_0", "u_1", "u_2"),
        ("displacement_X", "displacement_Y", "displacement_Z"),
        ("displacement:0", "displacement:1", "displacement:2"),
        ("x_displacement", "y_displacement", "z_displacement"),
        (
            "Displacement_field,_X-component",
            "Displacement_field,_Y-component",
            "Displacement_field,_Z-component",
        ),
        ("Displacement 1", "Displacement 2", "Displacement 3"),
        ("disp_y", "disp_x"),
    ],
)
def test_scalars_for_each_direction_are_a_vector(names):
    order = [1, 0] if names[0] == "disp_y" else range(3)
    found = find_displacements(OTHERS | {name: U[:, k] for name, k in zip(names, order, strict=True)})
    assert np.array_equal(found.steps[-1], U[:, : len(names)])


def test_rotations_beside_displacements_are_left_out():
    values = np.column_stack([U, 9 * U])
    found = find_displacements(
        {"RESU____DEPL": values}, {"RESU____DEPL": ["DX", "DY", "DZ", "DRX", "DRY", "DRZ"]}
    )
    assert np.array_equal(found.steps[-1], U)
    with pytest.raises(ValueError, match="'RESU____DEPL' have 6 components: 2 or 3"):
        find_displacements({"RESU____DEPL": values})


def test_the_same_twice_is_no_question_and_others_are():
    assert find_displacements({"u": U, "u_x": U[:, 0], "u_y": U[:, 1], "u_magnitude": U[:, 2]}).name == "u"
    single = U.astype(np.float32).astype(float) * (1 + 1e-7)
    assert find_displacements({"U": U, "displacement": single}).name == "U"
    with pytest.raises(
        ValueError, match=r"several nodal data may be .*: U, displacement; name the right one \(--field\)"
    ):
        find_displacements({"U": U, "displacement": 2 * U})
    with pytest.raises(ValueError, match=r"several nodal data may be .*: u, disp_x, disp_y"):
        find_displacements({"u": U, "disp_x": 0 * U[:, 0], "disp_y": U[:, 1]})


def test_a_scalar_of_the_name_is_no_displacement():
    assert find_displacements({"u": U[:, 0], "disp": U}).name == "disp"
    with pytest.raises(ValueError, match="'u' have 1 components: 2 or 3 components"):
        find_displacements({"u": U[:, 0]})


@pytest.mark.parametrize(
    "data", [{"f": U}, {"velocity": U}, {"disp_x": U[:, 0]}, {"dx": U[:, 0], "dy": U[:, 1]}]
)
def test_what_might_be_something_else_is_asked_for(data):
    with pytest.raises(ValueError, match=rf"or be named \(--field\); there are {', '.join(data)}"):
        find_displacements(data)


@pytest.mark.parametrize(
    ("field", "factor"), [("f", 5), ("velocity", -1), ("u", 1), ("VELOCITY", -1), ("s", 7)]
)
def test_the_user_says_which(field, factor):
    data = OTHERS | {"u": U, "displacement": 2 * U, "s_x": 7 * U[:, 0], "s_y": 7 * U[:, 1]}
    steps = find_displacements(data, field=field).steps
    assert np.array_equal(steps[-1][:, :2], factor * U[:, :2])


def test_a_name_that_is_not_there_is_answered_with_those_that_are():
    with pytest.raises(
        ValueError, match="field = 'w': must be one of the nodal data; there are T, velocity, stress, f"
    ):
        find_displacements(OTHERS | {"u": U}, field="w")
    many = {f"a{k}": U for k in range(100)}
    with pytest.raises(ValueError, match=r"a19 and 80 more$"):
        find_displacements(many)


def test_steps_of_scalars_belong_together():
    data = {f"disp_{axis}[{k}] - {k}": (k + 1) * U[:, i] for k in (0, 1) for i, axis in enumerate("xy")}
    steps = find_displacements(data).steps
    assert sorted(steps) == [0, 1] and np.array_equal(steps[1], 2 * U[:, :2])


@pytest.mark.parametrize("name", ["aster.vtu", "moose.e"])
def test_files_of_other_programs_are_read(name):
    path = CASES / "08-displacement-names" / name
    results = read_element_results(path, elasticity=Elasticity(1e3, 0.3))
    field = read_displacements(path)
    assert np.abs(results.u).max() > 0
    assert field.displacement(results.points[:5]) == pytest.approx(results.u[:5], abs=1e-12)


def test_both_readers_take_the_name(tmp_path):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    data = {"u": 0 * points, "f": 0.01 * points}
    for name in ("m.vtu", "m.vtk", "m.xdmf", "m.med"):
        meshio.write_points_cells(tmp_path / name, points, {"quad": np.array([[0, 1, 2, 3]])}, data)
        assert read_displacements(tmp_path / name, field="f").u.max() == 0.01
        assert read_element_results(tmp_path / name, elasticity=Elasticity(1, 0), field="f").u.max() == 0.01
        assert read_displacements(tmp_path / name).u.max() == 0


def test_calculix_has_one_name():
    plate = DATA / "plate_2d.frd"
    assert np.array_equal(read_displacements(plate, field="DISP").u, read_displacements(plate).u)
    with pytest.raises(
        ValueError, match="field = 'U': the displacements of CalculiX are DISP; there are DISP, STRESS"
    ):
        read_displacements(plate, field="U")
