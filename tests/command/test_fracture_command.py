"""`slmm fracture`: what it prints and writes, and what it refuses."""

import json
from pathlib import Path

import pytest
import xarray as xr
from command_line import refused, run

from slmm.fracture.boundary_engine import BoundaryEngine

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def plate(tmp_path):
    path = tmp_path / "plate.toml"
    path.write_text((EXAMPLES / "tensile_plate.toml").read_text())
    return path


def test_table_file_and_picture(plate, tmp_path):
    output, picture = tmp_path / "result.nc", tmp_path / "result.png"
    result = run("fracture", plate, "--increment", 4, "-o", output, "--plot", picture)
    assert result.exit_code == 0, result.stderr
    assert "Tensile toughness U_T = 274" in result.stdout and "the part is severed" in result.stdout
    assert "hole 0" in result.stdout and "edge" in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    with xr.open_dataset(output) as written:
        assert float(written.U_T) == pytest.approx(274.3, rel=2e-3)
        assert written.attrs["command"].startswith("slmm") and written.attrs["increment"] == 4.0
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "plate.toml",
        "result.jsonl",
        "result.nc",
        "result.png",
    ]


def test_finite_elements_say_what_they_were(plate, tmp_path):
    pytest.importorskip("netgen")
    output = tmp_path / "result.nc"
    result = run("fracture", plate, "--increment", 16, "--engine", "fem", "-o", output)
    assert result.exit_code == 0, result.stderr
    with xr.open_dataset(output) as written:
        assert (written.attrs["engine"], written.attrs["contact"]) == ("fem", "without friction")
        assert written.attrs["engine"] == "fem" and written.attrs["fineness"] == 1.0


def test_cracks_turn_by_T_at_a_distance(plate, tmp_path):
    output = tmp_path / "result.nc"
    way = ("--direction", "GMTS", "--critical-distance", 0.1)
    result = run("fracture", plate, "--increment", 16, *way, "-o", output)
    assert result.exit_code == 0, result.stderr
    with xr.open_dataset(output) as written:
        assert (written.attrs["direction"], written.attrs["critical_distance"]) == ("GMTS", 0.1)


def test_what_is_refused(plate, tmp_path):
    distance = run("fracture", plate, "--critical-distance", 0.1)
    assert refused(distance, "critical_distance = 0.1", "belongs to direction = 'GMTS'")
    assert refused(
        run("fracture", plate, "--increment", "long"), "--increment long", "a length in mm, or auto"
    )
    assert refused(run("fracture", plate, "--increment", "900"), "increment = 900.0", "must lie between")
    assert refused(run("fracture", plate, "--engine", "guess"), "engine = 'guess'", "boundary, fem")
    assert refused(run("fracture", plate, "-o", tmp_path / "result.txt"), ".nc")
    assert refused(run("fracture", plate, "--plot", tmp_path / "no" / "result.png"), "there is no folder")
    assert refused(run("fracture", tmp_path / "none.toml"), "none.toml")
    assert refused(run("fracture", plate, "--animate", tmp_path / "run.png"), "--animate", ".gif or .mp4")
    assert refused(run("fracture", plate, "--vtk", plate), "--vtk", "must be a folder, and there is a file")
    assert refused(run("fracture", plate, "--vtk", tmp_path / "no" / "series"), "there is no folder")
    assert refused(run("fracture", plate, "--magnify", 5), "--magnify 5: needs --plot or --animate")
    picture = tmp_path / "result.png"
    assert refused(run("fracture", plate, "--plot", picture, "--magnify", -1), "--magnify -1", "positive")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plate.toml"]


def test_films_without_ffmpeg_are_refused_before_the_simulation(plate, tmp_path, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    result = run("fracture", plate, "--animate", tmp_path / "run.mp4")
    assert refused(result, "ffmpeg", "is not installed; a .gif needs nothing")


def test_films_pictures_of_open_cracks_and_series_for_paraview(plate, tmp_path):
    film, picture, series = (tmp_path / name for name in ("run.gif", "run.svg", "series"))
    options = ["--animate", film, "--plot", picture, "--magnify", 10, "--vtk", series]
    result = run("fracture", plate, "--increment", 20, *options)
    assert result.exit_code == 0, result.stderr
    assert film.read_bytes().startswith(b"GIF89a")
    assert "displacements 10 times as large" in picture.read_text()
    assert {"fracture.pvd", "step_001.vtu"} <= {path.name for path in series.iterdir()}


def test_json_has_all_of_it_and_nothing_else_is_printed(plate):
    result = run("fracture", plate, "--increment", 16, "--json")
    assert result.exit_code == 0, result.stderr
    record = json.loads(result.stdout)
    assert record["outcome"] == "the part is severed" and record["command"].startswith("slmm")
    assert record["U_T"] == pytest.approx(274.3, rel=5e-3) and record["units"]["U_T"] == "mJ"
    assert [step["event"] for step in record["steps"]].count("start") == 1
    assert record["steps"][-1]["arrested_by"] == "edge"
    assert len(record["curve"]["u"]) == len(record["curve"]["F"])
    assert record["cracks"][0][0] == [0.0, 40.0, -1.0] and len(record["cracks"]) == 2
    assert {"equilibrium_u", "equilibrium_F"} <= set(record["equilibrium_path"])


def test_a_stopped_simulation_is_resumed_to_the_same_result(plate, tmp_path):
    output, journal = tmp_path / "result.nc", tmp_path / "result.jsonl"
    arguments = ["fracture", plate, "--increment", 8, "-o", output]
    first = run(*arguments)
    with xr.open_dataset(output) as result:
        undisturbed = result.load().drop_attrs()
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[:3]))
    output.unlink()
    assert refused(run(*arguments), "result.jsonl: is there already; resume it")
    again = run(*arguments, "--resume")
    assert (again.exit_code, again.stdout) == (0, first.stdout)
    with xr.open_dataset(output) as result:
        xr.testing.assert_identical(result.load().drop_attrs(), undisturbed)
    lines = journal.read_bytes()
    behind = run(*arguments, "--resume", "--from-step", 3)
    assert (behind.exit_code, behind.stdout, journal.read_bytes()) == (0, first.stdout, lines)
    assert refused(run(*arguments, "--resume", "--from-step", 99), "cannot go on behind step 99")
    assert refused(run(*arguments, "--from-step", 3), "--from-step 3: needs --resume")
    # one that has ended may begin anew
    assert run(*arguments).exit_code == 0
    assert refused(run("fracture", plate, "--resume"), "--resume: needs -o")
    other = ["fracture", plate, "--increment", 4, "-o", output, "--resume"]
    assert refused(run(*other), "another run, with increment = 8.0", "this one has increment = 4.0")


def test_an_interrupted_simulation_says_how_it_goes_on(plate, tmp_path, monkeypatch):
    solve, solved = BoundaryEngine.solve, []

    def interrupted(self, part):
        solved.append(part)
        if len(solved) == 4:
            raise KeyboardInterrupt
        return solve(self, part)

    monkeypatch.setattr(BoundaryEngine, "solve", interrupted)
    output = tmp_path / "result.nc"
    result = run("fracture", plate, "--increment", 8, "-o", output)
    assert result.exit_code != 0
    told = " ".join(result.stderr.split())
    assert "stopped; with --resume it goes on with what is in" in told and "result.jsonl" in told
    assert not output.exists()
    assert (tmp_path / "result.jsonl").read_bytes().count(b"\n") == 4


def test_the_largest_displacement_is_said(plate):
    result = run("fracture", plate, "--increment", 8, "--largest-displacement", 0.2)
    assert result.exit_code == 0, result.stderr
    assert "the largest displacement is reached" in result.stdout
