"""`slmm initiation --vary`: table, files, JSON, exit codes, and what is refused."""

import csv
import json

import numpy as np
import pytest
import xarray as xr
from command_line import refused, run

SCENE = """
title = "Hole"
[plate]
width = 100.0
height = 100.0
[[holes]]
shape = "circle"
center = [50.0, 50.0]
radius = 20.0
[material]
name = "PMMA"
[load]
strain = [0.0, 0.02, 0.0]
[analysis]
method = "slmm+ac"
positions = 7
voxels = 10000
"""
VARY = ("--vary", "load.strain=0.01:0.02:2", "--vary", "material.sigma_c=60,70,80")


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def test_few_variants_are_listed_and_written(scene_file, tmp_path):
    output, table = tmp_path / "sweep.nc", tmp_path / "sweep.csv"
    result = run("initiation", scene_file, *VARY, "-o", output)
    assert result.exit_code == 0, result.stderr
    assert "6 variants" in result.stdout and "Variants: 6 ok." in result.stdout
    assert "Curves were computed for 1 of them" in result.stdout
    assert run("initiation", scene_file, *VARY, "-o", table).exit_code == 0
    with xr.open_dataset(output) as written, open(table, newline="") as file:
        assert dict(written.sizes) == {"load.strain": 2, "material.sigma_c": 3}
        assert written["material.sigma_c"].attrs["units"] == "MPa"
        assert written.attrs["command"].startswith("slmm")
        lines = list(csv.DictReader(file))
        assert len(lines) == 6 and lines[1]["material.sigma_c"] == "70.0"
        index = [float(line["failure_index"]) for line in lines]
        np.testing.assert_allclose(index, written.failure_index.values.ravel(), rtol=1e-12)


def test_of_many_the_extremes_are_listed(scene_file):
    result = run("initiation", scene_file, "--vary", "load.strain=0.001:0.1:100")
    assert result.exit_code == 0
    assert "the extremes of 100 variants" in result.stdout and "Variants: 100 ok." in result.stdout
    assert len([line for line in result.stdout.splitlines() if "70.00" in line]) == 12


def test_all_as_json(scene_file):
    found = json.loads(run("initiation", scene_file, *VARY, "--json").stdout)
    assert found["status_counts"] == {"ok": 6} and found["units"]["material.sigma_c"] == "MPa"
    assert found["variants"][4]["load.strain"] == 0.02 and found["variants"][4]["material.sigma_c"] == 70.0


def test_a_variant_without_a_value_ends_with_1_and_says_why(scene_file):
    hole = 'shape = "rectangle"\nsize = [20.0, 20.0]\ncorner_radius = 0.0'
    scene_file.write_text(SCENE.replace('shape = "circle"', hole).replace("radius = 20.0\n[mat", "[mat"))
    result = run("initiation", scene_file, "--vary", "load.strain=0.1,0.2")
    assert result.exit_code == 1, result.stderr
    assert "may be higher at" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--vary", "load.stress=1,2"], ["load.stress: is no key", "load.strain"]),
        (["--vary", "load.strain=1:2:0"], ["a range of 0 values"]),
        (["--vary", "load.strain"], ["KEY=VALUES"]),
        (["--vary", "load.strain=1", "--vary", "load.strain=2"], ["comes twice"]),
        (["--vary", "load.strain=1,2", "--plot", "a.png"], ["--plot", "leave --vary out"]),
        (["--vary", "load.strain=1,2", "-o", "a.txt"], ["must end with .nc or .csv"]),
        (["-o", "a.csv"], ["must end with .nc"]),
        (["--direction", "best"], ["slmm+ac turns no cracks", "boundary does"]),
        (["--direction", "up"], ["must be one of normal, best"]),
    ],
)
def test_what_is_refused(scene_file, arguments, words):
    assert refused(run("initiation", scene_file, *arguments), *words)


def test_results_of_a_model_have_no_keys(tmp_path):
    results = tmp_path / "part.frd"
    results.write_text("no result")
    assert run("initiation", results, "--material", "PMMA", "--vary", "load.strain=1,2").exit_code == 2


def test_cracks_turn_by_a_flag_and_by_a_setting(scene_file):
    point = "points = [[68.13, 58.45]]"
    scene_file.write_text(SCENE.replace("positions = 7", point).replace('"slmm+ac"', '"boundary"'))
    by_flag = json.loads(run("initiation", scene_file, "--direction", "best", "--json").stdout)
    scene_file.write_text(
        SCENE.replace("positions = 7", f'{point}\ndirection = "best"').replace('"slmm+ac"', '"boundary"')
    )
    by_setting = json.loads(run("initiation", scene_file, "--json").stdout)
    normal = json.loads(run("initiation", scene_file, "--direction", "normal", "--json").stdout)
    index = [found["positions"][0]["failure_index"] for found in (by_flag, by_setting, normal)]
    assert index[0] == index[1] > index[2]
    assert by_flag["direction"] == "best" and by_flag["positions"][0]["turned"] < -1.0
