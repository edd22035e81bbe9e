"""`slmm forces`: its table, its files, its pictures, and what it refuses."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

from slmm.command.cli import app
from slmm.fracture import crack_tip_loading
from slmm.fracture.configurational_forces import nodal_configurational_forces
from slmm.pictures.forces import plot_forces
from slmm.results.read_results import read_element_results

DATA = Path(__file__).parents[1] / "data"
CASES = Path(__file__).parents[3] / "shared" / "cases"
EDGE_CRACK, BAR = DATA / "edge_crack_2d.frd", DATA / "bar_3d.frd"


def run(*arguments):
    return CliRunner().invoke(app, ["forces", *(str(argument) for argument in arguments)])


def test_table_and_sentence_of_the_crack_tip():
    result = run(EDGE_CRACK)
    assert result.exit_code == 0, result.stderr
    assert (
        "400 CPE8; stresses from displacements, and the elasticity in edge_crack_2d.inp; method linear"
        in (result.stdout)
    )
    assert "Tip 0 at (20, 20) mm: G = 23.6" in result.stdout
    assert "runs on at 0.0 degrees (MERR)" in result.stdout or "runs on at -0.0 degrees" in result.stdout


CASES = Path(__file__).parents[3] / "shared" / "cases"


@pytest.mark.parametrize(
    ("case", "found"),
    [
        ("03-vtu-two-pieces/two.vtu", "6 nodes, 2 CPE4;"),
        ("04-vtu-22-lagrange/version22.vtu", "4 nodes, 1 CPE4;"),
        ("04-vtu-22-lagrange/lagrange4.vtu", "4 nodes, 1 CPE4;"),
        ("08-displacement-names/aster.vtu", "736 nodes, 224 CPE8;"),
        ("08-displacement-names/moose.e", "9 nodes, 4 CPE4;"),
        ("16-lz4/lz4.vtu", "736 nodes, 224 CPE8;"),
        ("17-pvtu/p.pvtu", "4 nodes, 1 CPE4;"),
        ("18-unshared-nodes/dg.vtu", "1301 nodes, 400 CPE8;"),
        ("19-pixel-voxel/pixel.vtu", "4 nodes, 1 CPE4;"),
        ("19-pixel-voxel/voxel.vtu", "8 nodes, 1 C3D8;"),
        ("22-quad9-forces/e_quad9.vtu", "9 nodes, 1 QUAD9;"),
    ],
)
def test_files_of_other_programs_are_read_whole(case, found):
    result = run(CASES / case, "--young", 210e3, "--poisson", 0.3)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith(found)
    if "18" in case:
        assert "Tip 0 at (20, 20) mm: G = 23.68" in result.stdout


@pytest.mark.parametrize("name", ["m", "m_negative", "m_offsets", "m_type999"])
def test_numbers_that_are_none_are_refused(name):
    path = CASES / "r05-vtu-index-out-of-range" / f"{name}.vtu"
    result = run(path, "--young", 3000, "--poisson", 0.3)
    assert result.exit_code == 2 and result.stdout == ""
    assert f"{name}.vtu: " in result.stderr.replace("\n", "")


def test_json_has_all_contours_in_plain_numbers():
    result = run(EDGE_CRACK, "--json", "--contours", 3)
    content = json.loads(result.stdout, parse_constant=pytest.fail)
    (tip,) = content["tips"]
    assert len(tip["J_x"]) == len(tip["radius"]) == 3
    assert tip["status"] == "ok"
    assert set(tip["kink"]) == {"MERR", "J", "MTS", "MSED"}
    assert content["units"]["G"] == "N/mm"
    assert content["interface_force"] is None


def of_case(name, *arguments):
    return run(CASES / name, "--young", 210e3, "--poisson", 0.3, *arguments)


def test_a_half_model_says_what_would_find_its_tip_and_finds_it_when_asked(tmp_path):
    plain = of_case("05-half-model/half.vtu")
    assert plain.exit_code == 0, plain.stderr
    text = " ".join(plain.stdout.split())
    assert "No crack tip: nowhere inside the material do two faces" in text
    assert "It looks like a half model: --symmetry y gives the tip" in text
    content = json.loads(of_case("05-half-model/half.vtu", "--json").stdout)
    assert content["tips"] == []
    assert "--symmetry y" in content["remark"]
    assert "--tip" in content["remark"]

    output, plot = tmp_path / "whole.vtu", tmp_path / "whole.png"
    asked = of_case("05-half-model/half.vtu", "--symmetry", "y", "-o", output, "--plot", plot)
    assert asked.exit_code == 0, asked.stderr
    assert "G = 23.68 N/mm on 5 contours" in asked.stdout
    assert "with the image by symmetry y." in asked.stdout
    content = json.loads(of_case("05-half-model/half.vtu", "--symmetry", "y", "--json").stdout)
    assert content["tips"][0]["K_I"] == pytest.approx(2320, abs=0.5)
    assert (content["remark"], content["symmetry"]) == (None, "y")
    # the file and the picture are of the whole part
    assert len(meshio.read(output).points) == 1301
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_pressure_on_the_faces_counts_and_contours_that_differ_are_told():
    tip = json.loads(of_case("06-face-pressure/facepressure.vtu", "--json").stdout)["tips"][0]
    assert (tip["G"], tip["K_I"]) == (pytest.approx(23.68, abs=0.005), pytest.approx(2320, abs=0.5))
    assert tip["status"] == "ok"
    # P of Eshelby's stress is not in balance where a program was geometrically linear
    told = of_case("05-half-model/whole.vtu", "--method", "mbf")
    assert told.exit_code == 0
    assert "; contours differ by " in told.stdout


def test_a_tip_may_be_given_by_its_place():
    found = json.loads(run(EDGE_CRACK, "--json").stdout)["tips"]
    for place in ("20,20", "20.1 19.9", "20,20,0"):
        given = json.loads(run(EDGE_CRACK, "--json", "--tip", place).stdout)["tips"]
        assert [tip["G"] for tip in given] == pytest.approx([tip["G"] for tip in found])


def test_forces_are_written_for_paraview_and_drawn(tmp_path):
    output, plot = tmp_path / "forces.vtu", tmp_path / "forces.png"
    result = run(EDGE_CRACK, "-o", output, "--plot", plot)
    assert result.exit_code == 0, result.stderr
    assert plot.read_bytes().startswith(b"\x89PNG")
    mesh = meshio.read(output)
    forces = mesh.point_data["configurational_force"]
    at_tip = forces[np.linalg.norm(mesh.points - [20, 20, 0], axis=1) < 4.1]
    assert -at_tip[:, 0].sum() == pytest.approx(23.6, rel=0.01)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["forces.png", "forces.vtu"]


def test_a_written_file_can_be_read_again_with_elasticity(tmp_path):
    assert run(EDGE_CRACK, "-o", tmp_path / "forces.vtu").exit_code == 0
    first = json.loads(run(EDGE_CRACK, "--json").stdout)
    again = json.loads(run(tmp_path / "forces.vtu", "--young", 210e3, "--poisson", 0.3, "--json").stdout)
    assert again["tips"][0]["G"] == pytest.approx(first["tips"][0]["G"], rel=1e-9)
    assert again["tips"][0]["K_I"] == pytest.approx(first["tips"][0]["K_I"], rel=1e-9)


def test_a_model_in_space_has_its_forces_and_the_force_on_its_interface(tmp_path):
    result = run(BAR, "-o", tmp_path / "bar.vtu")
    assert result.exit_code == 0, result.stderr
    # tests/data/bar.py: what a shift of the interface gains
    assert "Material force on the interfaces: (4.76" in result.stdout
    assert "Crack tips are looked for in plane models only" in result.stdout
    assert (tmp_path / "bar.vtu").stat().st_size > 1000
    refusal = run(BAR, "--plot", tmp_path / "bar.png")
    assert refusal.exit_code == 2
    assert "pictures are drawn of plane models" in refusal.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([EDGE_CRACK, "--young", 210e3], "--young and --poisson belong together"),
        ([EDGE_CRACK, "--young", 210e3, "--poisson", 0.7], "nu = 0.7: must lie between -1 and 0.5"),
        ([EDGE_CRACK, "--method", "eshelby"], "method = 'eshelby': must be one of mbf, dbf, linear"),
        ([EDGE_CRACK, "--step", 7], "step = 7"),
        ([EDGE_CRACK, "--symmetry", "z"], "symmetry = 'z': must be x, y, x=PLACE or y=PLACE"),
        ([BAR, "--symmetry", "y"], "lines of symmetry belong to plane models"),
        ([EDGE_CRACK, "--tip", "20"], "--tip 20: must be X,Y in mm"),
        ([EDGE_CRACK, "--tip", "20,nan"], "--tip 20,nan: must be X,Y in mm"),
        ([EDGE_CRACK, "--tip", "30,10"], "tip = (30, 10) mm: no boundary is there"),
        ([EDGE_CRACK, "--tip", "40,10"], "does not turn back"),
        ([EDGE_CRACK, "-o", "forces.nc"], "the name must end with .vtu"),
        (["nowhere.frd"], "nowhere.frd: there is no such file"),
    ],
)
def test_bad_input_is_refused_by_name(arguments, words):
    result = run(*arguments)
    assert result.exit_code in (1, 2)
    assert words in " ".join(result.stderr.split())
    assert "Traceback" not in result.stderr


def test_an_input_is_never_overwritten(tmp_path):
    model = tmp_path / "edge.frd"
    shutil.copy(EDGE_CRACK, model)
    assert run(model, "-o", model).exit_code == 2
    mesh = tmp_path / "mesh.vtu"
    assert run(EDGE_CRACK, "-o", mesh).exit_code == 0
    before = mesh.read_bytes()
    refusal = run(mesh, "--young", 210e3, "--poisson", 0.3, "-o", mesh)
    assert refusal.exit_code == 2
    assert "would be overwritten" in refusal.stderr
    assert mesh.read_bytes() == before


def test_models_without_tips_and_without_known_tips_are_drawn_too():
    results = read_element_results(EDGE_CRACK)
    forces = nodal_configurational_forces(
        results.points, results.cells, results.u, results.stress, results.energy, results.method
    )
    whole = crack_tip_loading(results).isel(tip=slice(0, 0))
    assert len(plot_forces(results, forces, whole).axes) == 2  # the model and its colour bar
    unknown = crack_tip_loading(replace(results, elasticity=()))
    assert len(plot_forces(results, forces, unknown).axes) == 3
    still = replace(results, energy={"CPE8": np.zeros((400, 9))})
    plot_forces(still, 0 * forces, whole)
