"""`slmm fracture`: what it prints and writes, and what it refuses."""

from pathlib import Path

import pytest
import xarray as xr
from command_line import refused, run

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
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plate.toml", "result.nc", "result.png"]


def test_finite_elements_say_what_they_were(plate, tmp_path):
    pytest.importorskip("netgen")
    output = tmp_path / "result.nc"
    result = run("fracture", plate, "--increment", 16, "--engine", "fem", "-o", output)
    assert result.exit_code == 0, result.stderr
    with xr.open_dataset(output) as written:
        assert (written.attrs["engine"], written.attrs["contact"]) == ("fem", "none")
        assert written.attrs["nodes"] > 1000 and written.attrs["fineness"] == 1.0


def test_what_is_refused(plate, tmp_path):
    assert refused(
        run("fracture", plate, "--increment", "long"), "--increment long", "a length in mm, or auto"
    )
    assert refused(run("fracture", plate, "--increment", "900"), "increment = 900.0", "must lie between")
    assert refused(run("fracture", plate, "--engine", "guess"), "engine = 'guess'", "boundary, fem")
    assert refused(run("fracture", plate, "-o", tmp_path / "result.txt"), ".nc")
    assert refused(run("fracture", plate, "--plot", tmp_path / "no" / "result.png"), "there is no folder")
    assert refused(run("fracture", tmp_path / "none.toml"), "none.toml")


def test_the_largest_displacement_is_said(plate):
    result = run("fracture", plate, "--increment", 8, "--largest-displacement", 0.2)
    assert result.exit_code == 0, result.stderr
    assert "the largest displacement is reached" in result.stdout
