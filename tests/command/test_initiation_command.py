"""`slmm initiation`: what it writes, what it refuses, and that nothing is lost when it fails."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import refused, run

import slmm
from slmm.initiation import failure
from slmm.initiation.methods import METHODS, ON_DISPLACEMENTS
from slmm.running.cell_file import shipped_database

EXAMPLES = Path(__file__).parents[2] / "examples"
OLD = b"the result of an earlier run"

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
voxels = 40000
"""


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def test_table_files_and_provenance(scene_file, tmp_path):
    output, plot = tmp_path / "result.nc", tmp_path / "result.png"
    result = run("initiation", scene_file, "-o", output, "--plot", plot)
    assert result.exit_code == 0, result.stderr
    assert "A crack starts there under this load" in result.stdout
    assert "Positions: 7 ok." in result.stdout
    assert plot.read_bytes().startswith(b"\x89PNG")
    with xr.open_dataset(output) as written:
        assert written.sizes["position"] == 7
        assert {"failure_index", "status", "G_inc", "sigma_I"} <= set(written.data_vars)
        assert written.attrs["version"] == slmm.__version__
        assert written.attrs["command"].startswith("slmm")  # argv is that of the test runner
        assert all("units" in written[name].attrs for name in written.data_vars)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["result.nc", "result.png", "scene.toml"]


def test_json_is_all_that_stands_on_stdout(scene_file):
    result = run("initiation", scene_file, "--json", "--positions", "6", "--method", "slmm")
    assert result.exit_code == 0, result.stderr
    content = json.loads(result.stdout, parse_constant=pytest.fail)
    assert content["method"] == "slmm"
    assert len(content["positions"]) == 6
    worst = content["most_critical"]
    assert worst["failure_index"] == pytest.approx(1 / worst["load_factor"])
    assert worst["failure_index"] == max(position["failure_index"] for position in content["positions"])


def test_positions_keep_the_order_of_explicit_points(scene_file):
    text = SCENE.replace("positions = 7", "points = [[50.0, 70.0], [70.0, 50.0], [30.0, 50.0]]")
    scene_file.write_text(text)
    positions = json.loads(run("initiation", scene_file, "--json").stdout)["positions"]
    assert [round(position["x"]) for position in positions] == [50, 70, 30]


def test_help_lists_all_methods():
    text = run("initiation", "--help").stdout
    words = set(text.replace(",", " ").replace(";", " ").split())
    assert set(METHODS) <= words
    assert set(ON_DISPLACEMENTS) <= words


def test_average_and_tolerance_reach_the_method(scene_file, monkeypatch):
    real, given = failure.failure_arrays, {}

    def watched(scene, **options):
        given.update(options)
        return real(scene, **options)

    monkeypatch.setattr(failure, "failure_arrays", watched)
    indices = []
    for options in ((), ("--average", "--tolerance", "0.01")):
        result = run("initiation", scene_file, "--json", *options)
        assert result.exit_code == 0, result.stderr
        indices.append(json.loads(result.stdout)["most_critical"]["failure_index"])
    assert given["tolerance"] == 0.01
    # the stress falls from the surface: its mean is higher than its smallest value
    assert indices[1] > indices[0] * 1.01
    assert run("initiation", scene_file, "--tolerance", "0.9").exit_code == 2


def test_estimated_errors_and_methods_stand_in_the_table(scene_file, monkeypatch):
    plain = run("initiation", scene_file, "--method", "slmm").stdout
    assert "±" not in plain and "used method" not in plain
    real = failure.failure_arrays

    def mixed(scene, **options):
        result = real(scene, **options)
        result["failure_index_error"].values[:] = 0.01 * result["failure_index"].values
        for name, words in (
            ("used_method", ["slmm+ac"] * 4 + ["asymptotics"] * 3),
            ("reason", ["cheapest"] * 7),
        ):
            result.variables[name] = result[name]._replace(values=np.array(words))
        return result

    monkeypatch.setattr(failure, "failure_arrays", mixed)
    lines = run("initiation", scene_file).stdout.splitlines()
    assert any("±" in line and "used method" in line for line in lines)
    rows = [line.split() for line in lines if line.rstrip().endswith(("energy   slmm+ac", "asymptotics"))]
    assert len(rows) == 7
    for row in rows:
        assert float(row[4]) == pytest.approx(0.01 * float(row[3]), rel=0.5)
        assert row[-4:-1] == ["stress", "and", "energy"]
    positions = json.loads(run("initiation", scene_file, "--json").stdout)["positions"]
    assert [position["reason"] for position in positions] == ["cheapest"] * 7
    assert positions[6]["used_method"] == "asymptotics"


def test_bad_scene_is_refused(scene_file):
    scene_file.write_text(SCENE.replace("radius = 20.0", "radius = -20.0"))
    assert refused(run("initiation", scene_file), "holes[0].radius = -20.0", "greater than 0")
    assert refused(run("initiation", scene_file.with_name("none.toml")), "none.toml")


def test_unknown_method_is_refused(scene_file):
    assert refused(run("initiation", scene_file, "--method", "guess"), "guess", "slmm+ac", "full-fea")


def test_unknown_option_is_refused(scene_file):
    assert run("initiation", scene_file, "--colour").exit_code == 2
    assert run("initiation", scene_file, "--positions", "0").exit_code == 2


@pytest.mark.parametrize(
    ("option", "name", "word"),
    [
        ("-o", "result.txt", ".nc"),
        ("--plot", "result.bmp", ".png"),
        ("-o", "nowhere/result.nc", "no folder"),
        ("--plot", "folder.png", "is a folder"),
    ],
)
def test_targets_are_checked_before_the_work(scene_file, tmp_path, monkeypatch, option, name, word):
    monkeypatch.setattr(failure, "failure_arrays", lambda *_, **__: pytest.fail("worked before it checked"))
    (tmp_path / "folder.png").mkdir()
    assert refused(run("initiation", scene_file, option, tmp_path / name), option, word)


def test_an_input_is_never_overwritten(tmp_path):
    for name in ("notch.toml", "notch.png"):
        shutil.copy(EXAMPLES / name, tmp_path)
    picture = (tmp_path / "notch.png").read_bytes()
    assert refused(
        run("initiation", tmp_path / "notch.toml", "--plot", tmp_path / "notch.png"), "is an input"
    )
    database = tmp_path / "cells.nc"
    shutil.copy(shipped_database(), database)
    assert refused(run("initiation", tmp_path / "notch.toml", "--database", database, "-o", database))
    assert (tmp_path / "notch.png").read_bytes() == picture
    assert database.read_bytes() == shipped_database().read_bytes()


def test_a_failing_run_destroys_nothing(scene_file, tmp_path, monkeypatch):
    output, plot = tmp_path / "result.nc", tmp_path / "result.png"
    output.write_bytes(OLD)
    plot.write_bytes(OLD)
    assert refused(run("initiation", scene_file, "-o", output, "--plot", plot, "--database", plot))

    def breaks_off(self, path, **_):
        Path(path).write_bytes(b"half of it")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", breaks_off)
    result = run("initiation", scene_file, "-o", output, "--plot", plot)
    assert result.exit_code == 1
    assert "no space left on device" in result.stderr
    assert output.read_bytes() == plot.read_bytes() == OLD
    assert len(list(tmp_path.iterdir())) == 3


def test_no_value_anywhere_is_no_success(scene_file, tmp_path, monkeypatch):
    real = failure.failure_arrays

    def without_values(*arguments, **settings):
        result = real(*arguments, **settings)
        result["failure_index"].values[:] = np.nan
        result.variables["status"] = result["status"]._replace(values=np.array(["no cell"] * 7))
        return result

    monkeypatch.setattr(failure, "failure_arrays", without_values)
    result = run("initiation", scene_file, "-o", tmp_path / "result.nc", "--plot", tmp_path / "result.pdf")
    assert result.exit_code == 1
    assert "7 no cell" in result.stdout
    assert (tmp_path / "result.nc").exists() and (tmp_path / "result.pdf").exists()
