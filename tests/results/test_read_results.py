"""What is read from files of results gives the configurational forces of the model that the program solved."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from element_forces import STEEL, forces_of

from slmm.fracture.configurational_forces import forces_within
from slmm.mechanics.elasticity import Elasticity
from slmm.results.frd import read_frd
from slmm.results.inp import read_inp
from slmm.results.read_results import read_element_results

DATA = Path(__file__).parents[1] / "data"
CRACK, BAR, PLATE = DATA / "edge_crack_2d.frd", DATA / "bar_3d.frd", DATA / "plate_2d.frd"


@pytest.fixture
def copied(tmp_path):
    """A copy of a result of CalculiX with a changed input file, or without one."""

    def copy(path, *changes, inp=True, frd=()):
        text = path.read_text()
        for old, new in frd:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / path.name).write_text(text)
        if inp:
            text = path.with_suffix(".inp").read_text()
            for old, new in changes:
                assert old in text
                text = text.replace(old, new)
            (tmp_path / path.with_suffix(".inp").name).write_text(text)
        return tmp_path / path.name

    return copy


# CalculiX with its input file


def test_around_a_crack_tip_the_forces_are_the_energy_release_rate():
    # the elastic energies of models with cracks of 16, 18, 22 and 24 mm, at the same tension, differ by as much
    energy = {16: 88.39270, 18: 115.70827, 22: 213.07388, 24: 300.21343}
    near, far = (energy[22] - energy[18]) / 4, (energy[24] - energy[16]) / 8
    G = (4 * near - far) / 3
    results = read_element_results(CRACK)
    J = -forces_within(results.points, forces_of(results), [20, 20], [4, 6, 10, 16])
    assert J[:, 0] == pytest.approx(np.full(4, G), rel=5e-3)
    assert J[:, 1] == pytest.approx(np.zeros(4), abs=1e-5)  # the model is symmetric
    assert results.method == "linear" and results.thickness == 1.0
    assert results.elasticity == (STEEL,)


def test_where_two_materials_meet_the_force_is_the_jump_of_the_energy():
    results = read_element_results(BAR)
    forces = forces_of(results)
    interface = np.isclose(results.points[:, 0], 20)
    expected = 100 * 100.0**2 / 2 * (1 / 70e3 - 1 / 210e3)
    assert forces[interface].sum(axis=0) == pytest.approx([expected, 0, 0], rel=1e-4, abs=1e-9)
    assert {name: len(nodes) for name, nodes in results.cells.items()} == {"C3D20R": 2, "C3D15": 4}
    assert {name: set(own) for name, own in results.region.items()} == {"C3D20R": {0}, "C3D15": {1}}
    for name, stress in results.stress.items():
        assert stress == pytest.approx(np.full(stress.shape, np.diag([100.0, 0, 0])), abs=2e-3), name


@pytest.mark.parametrize("path", [CRACK, BAR, PLATE, DATA / "mixed_2d.frd"], ids=lambda path: path.stem)
def test_the_forces_on_a_whole_model_cancel(path):
    forces = forces_of(read_element_results(path))
    assert np.abs(forces.sum(axis=0)).max() < 1e-9 * np.abs(forces).max()


@pytest.mark.parametrize("name", ["plate", "mixed"])
def test_plane_output_and_the_solids_that_calculix_makes_give_the_same_forces(name):
    plane = read_element_results(DATA / f"{name}_2d.frd")
    solids = read_element_results(DATA / f"{name}_expanded.frd")
    assert {kind: len(nodes) for kind, nodes in solids.cells.items()} == {
        kind: len(nodes) for kind, nodes in plane.cells.items()
    }
    assert solids.points.shape == plane.points.shape
    distance = np.linalg.norm(solids.points[:, None] - plane.points, axis=2)
    same = distance.argmin(axis=1)
    assert distance.min(axis=1).max() < 1e-4
    forces = forces_of(plane)
    assert forces_of(solids) == pytest.approx(forces[same], abs=2e-5 * np.abs(forces).max())
    assert solids.elasticity == plane.elasticity == (Elasticity(2960, 0.35, "plane stress"),)


def test_the_elasticity_of_the_input_file_is_that_which_is_given():
    own, given_ = read_element_results(CRACK), read_element_results(CRACK, elasticity=STEEL)
    assert np.array_equal(own.stress["CPE8"], given_.stress["CPE8"])
    assert own.source == "displacements, and the elasticity in edge_crack_2d.inp"
    assert given_.source == "displacements, and the elasticity that is given"
    twice = read_element_results(CRACK, elasticity=Elasticity(2 * STEEL.E, STEEL.nu))
    assert forces_of(twice) == pytest.approx(2 * forces_of(own))


def test_one_elasticity_serves_all_regions_and_several_one_each():
    materials = Elasticity(210e3, 0.3), Elasticity(70e3, 0.1)
    own = read_element_results(BAR)
    each = read_element_results(BAR, elasticity=materials)
    assert np.array_equal(each.energy["C3D15"], own.energy["C3D15"])
    twice = Elasticity(2 * 70e3, 0.1)
    all_ = read_element_results(BAR, elasticity=twice)
    assert all_.energy["C3D15"] == pytest.approx(2 * own.energy["C3D15"])
    assert all_.elasticity == (twice, twice)
    assert np.array_equal(all_.region["C3D15"], own.region["C3D15"])


# the fields of the file


def test_the_nodal_fields_of_the_file_give_the_same_rate_away_from_the_tip(copied):
    results = read_element_results(copied(CRACK, inp=False), method="linear")
    assert results.source == "STRESS of the nodes, interpolated; ENER of the nodes, interpolated"
    assert results.elasticity == ()
    exact = read_element_results(CRACK)
    radii = [10, 16]
    own, expected = (forces_within(r.points, forces_of(r), [20, 20], radii) for r in (results, exact))
    assert own[:, 0] == pytest.approx(expected[:, 0], rel=1e-3)


def test_nodal_fields_of_a_uniform_state_are_exact_at_the_integration_points(copied):
    results = read_element_results(copied(BAR, inp=False))
    assert results.method == "dbf"
    for stress in results.stress.values():
        # CalculiX loses 4e-5 on the way from its integration points to the nodes
        assert stress == pytest.approx(np.full(stress.shape, np.diag([100.0, 0, 0])), abs=5e-3)


@pytest.mark.parametrize(
    ("old", "new", "method"),
    [
        ("*STEP", "*STEP, NLGEOM", "dbf"),
        ("210000, 0.3", "210000, 0.3\n*PLASTIC\n300, 0", "linear"),
        ("210000, 0.3", "210000, 0.3, 20\n200000, 0.3, 300", "linear"),
    ],
)
def test_what_the_displacements_do_not_settle_is_taken_from_the_file(old, new, method, copied):
    path = copied(CRACK, (old, new))
    results = read_element_results(path)
    assert results.source.startswith("STRESS of the nodes")
    assert results.method == method
    assert results.elasticity == ((STEEL,) if "STEP" in old else ())
    assert read_element_results(path, method="dbf").method == "dbf"
    settled = read_element_results(path, elasticity=STEEL)
    assert settled.method == "linear"
    assert np.array_equal(settled.energy["CPE8"], read_element_results(CRACK).energy["CPE8"])


def test_incompatible_modes_are_not_computed_from_displacements(copied):
    # CPS4I has strains of its own; the file of this model has no stresses
    path = copied(DATA / "mixed_2d.frd", ("TYPE=CPS4", "TYPE=CPS4I"))
    with pytest.raises(ValueError, match=r"stress and energy not known.*ENER.*CPS4I have incompatible modes"):
        read_element_results(path)
    results = read_element_results(path, elasticity=Elasticity(2960, 0.35, "plane stress"))
    assert set(results.cells) == {"CPS8", "CPS6", "CPS4I", "CPS3"}


def test_stresses_belong_to_the_step_of_the_displacements(copied):
    path = copied(PLATE, inp=False)
    assert read_element_results(path, step=1).source.startswith("STRESS")
    # the first step of this file has displacements only
    with pytest.raises(
        ValueError, match=r"plate_2d\.frd: stress and energy not known at this step: give elasticity"
    ):
        read_element_results(path, step=0)
    first, last = (read_element_results(PLATE, step=k) for k in (0, 1))
    assert first.energy["CPS8"].max() < 1e-2 * last.energy["CPS8"].max()


# types, thicknesses and regions


def test_reduced_integration_is_known_from_the_input_file_or_said(copied):
    reduced = read_element_results(copied(CRACK, ("CPE8", "CPE8R")))
    assert reduced.stress["CPE8R"].shape == (400, 4, 2, 2)
    said = read_element_results(copied(CRACK, inp=False), elasticity=STEEL, reduced=True)
    assert np.array_equal(said.stress["CPE8R"], reduced.stress["CPE8R"])


def test_forces_are_those_of_the_whole_thickness(copied):
    thick = read_element_results(copied(CRACK, ("MATERIAL=STEEL\n1\n", "MATERIAL=STEEL\n2.5\n")))
    assert thick.thickness == 2.5
    assert forces_of(thick) == pytest.approx(2.5 * forces_of(read_element_results(CRACK)))
    assert read_element_results(CRACK, thickness=3).thickness == 3
    assert read_element_results(copied(CRACK, ("MATERIAL=STEEL\n1\n", "MATERIAL=STEEL\n"))).thickness == 1


def test_sections_of_several_thicknesses_are_no_model_of_one(copied):
    path = copied(DATA / "mixed_2d.frd", ("ELSET=ECPS4,MATERIAL=M\n1", "ELSET=ECPS4,MATERIAL=M\n2"))
    with pytest.raises(ValueError, match=r"mixed_2d\.inp have several thicknesses"):
        read_element_results(path)
    assert read_element_results(path, thickness=2).thickness == 2


def test_a_material_in_plane_strain_and_plane_stress_is_two(copied):
    results = read_element_results(copied(DATA / "mixed_2d.frd", ("TYPE=CPS6", "TYPE=CPE6")))
    assert results.elasticity == (Elasticity(2960, 0.35), Elasticity(2960, 0.35, "plane stress"))
    assert {name: own.tolist() for name, own in results.region.items()} == {
        "CPS8": [1],
        "CPE6": [0, 0],
        "CPS4": [1],
        "CPS3": [1, 1],
    }
    strain = np.array([[0.001, 0.002], [-0.0003, 0.0015]])
    for name, stress in results.stress.items():
        expected = results.elasticity[results.region[name][0]].stress(strain)
        assert stress == pytest.approx(np.full(stress.shape, expected), rel=1e-4)


def test_an_input_file_may_lie_elsewhere(copied, tmp_path):
    path = copied(CRACK, inp=False)
    results = read_element_results(path, inp=CRACK.with_suffix(".inp"))
    assert results.source == "displacements, and the elasticity in edge_crack_2d.inp"


@pytest.mark.parametrize(
    ("path", "changes", "options", "message"),
    [
        (
            CRACK,
            [("TYPE=CPE8", "TYPE=S8R")],
            {},
            r"edge_crack_2d\.inp has elements of type S8R: only plane elements",
        ),
        (CRACK, [("TYPE=CPE8", "TYPE=C3D8")], {}, r"element 1 is quad8 here, and C3D8 in edge_crack_2d\.inp"),
        (CRACK, [("\n400, ", "\n401, "), ("381, 400", "381, 401")], {}, r"has no element 400 \(1 of 400"),
        (
            CRACK,
            [("1, 20, 1", "1, 20, 1\n*ELSET, ELSET=PLAT\n1")],
            {"step": 1},
            r"step = 1: steps with disp.*: 1",
        ),
        (CRACK, [("SECTION, ELSET=PLATE", "SECTION, ELSET=LOWER")], {}, r"element 21 has no \*SOLID SECTION"),
        (CRACK, [("MATERIAL=STEEL\n1\n", "MATERIAL=STEEL\n0\n")], {}, r"have the thickness 0 mm"),
        (CRACK, [], {"reduced": True}, r"reduced = True: edge_crack_2d\.inp has CPE8, which are not"),
        (PLATE, [], {"reduced": True}, r"reduced = True: plate_2d\.inp has CPS8, which are not"),
        (CRACK, [], {"method": "cauchy"}, r"method = 'cauchy': must be one of mbf, dbf, linear"),
        (CRACK, [], {"thickness": 0.0}, r"thickness = 0.0 mm: must be a positive number"),
        (CRACK, [], {"elasticity": [STEEL, STEEL]}, r"elasticity has 2 materials: 1 are needed, for STEEL"),
        (
            CRACK,
            [],
            {"elasticity": Elasticity(210e3, 0.3, "plane stress")},
            r"elasticity of STEEL is of plane stress: the elements in edge_crack_2d\.inp are of plane strain",
        ),
        (BAR, [], {"thickness": 2.0}, r"thickness = 2 mm: belongs to plane elements"),
        (BAR, [], {"elasticity": [STEEL]}, r"elasticity has 1 materials: 2 are needed, for STEEL, SOFT"),
        (
            DATA / "mixed_2d.frd",
            [("TYPE=CPS4", "TYPE=C3D4")],
            {},
            r"has plane elements and solids \(C3D4, CPS3,",
        ),
    ],
)
def test_what_contradicts_or_is_missing_is_named(path, changes, options, message, copied):
    path = copied(path, *changes)
    with pytest.raises(ValueError, match=message):
        read_element_results(path, **options)


def test_a_node_without_stress_is_not_taken_for_zero(copied):
    text = CRACK.read_text()
    begin = text.index(" -4  STRESS")
    line = text[begin:].split("\n")[7]
    path = copied(CRACK, inp=False, frd=[(line, line[:13] + "         NaN" * 6)])
    with pytest.raises(ValueError, match=r"STRESS is not known, or not finite, in 1 of 400 elements CPE8"):
        read_element_results(path)


def test_files_that_are_not_there_are_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.frd"):
        read_element_results(tmp_path / "none.frd")
    with pytest.raises(FileNotFoundError, match=r"none\.inp"):
        read_element_results(CRACK, inp=tmp_path / "none.inp")


def test_an_input_file_does_not_belong_to_other_results(tmp_path):
    shutil.copy(DATA / "plate.vtu", tmp_path)
    with pytest.raises(ValueError, match=r"plate_2d\.inp: belongs to results of CalculiX"):
        read_element_results(tmp_path / "plate.vtu", inp=PLATE.with_suffix(".inp"))


def test_a_vtu_file_of_the_same_model_gives_the_same_forces():
    plane_stress = Elasticity(2960, 0.35, "plane stress")
    results = read_element_results(DATA / "plate.vtu", elasticity=plane_stress)
    # the .vtu was made of the .frd, whose coordinates have six digits; beside the .frd stands the .inp with all
    expected = forces_of(read_element_results(PLATE))
    assert forces_of(results) == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())


def test_coordinates_have_the_digits_of_the_input_file():
    for name in ("edge_crack_2d", "plate_expanded"):
        results = read_element_results(DATA / f"{name}.frd")
        written = read_inp(DATA / f"{name}.inp").nodes[:, :2]
        off = np.abs(results.points[:, None] - written).max(axis=2).min(axis=1)
        assert off.max() == 0.0


def test_results_without_input_file_stay_solid(copied):
    results = read_element_results(
        copied(DATA / "mixed_expanded.frd", inp=False), elasticity=Elasticity(2960, 0.35)
    )
    assert set(results.cells) == {"C3D20", "C3D15", "C3D8", "C3D6"}
    assert len(results.points) == len(
        np.unique(np.concatenate([n.ravel() for n in read_frd(DATA / "mixed_expanded.frd").cells.values()]))
    )
