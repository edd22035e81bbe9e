"""Inputs that are no files, or not what they seem: refused by name, at once; texts are shown as they are."""

import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import slmm
from slmm.command.cli import app
from slmm.running.encoding import fitting, without_control

ROOT = Path(__file__).parents[1]
CASES = ROOT.parent / "shared" / "cases"

SCENE = """
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
strain = [0.0, 0.1, 0.0]
[analysis]
method = "rankine"
positions = 2
voxels = 2500
"""


def case(number):
    return next(CASES.glob(f"{number}-*"))


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def refused(result, *words):
    """Code 2 and one sentence with these words on stderr."""
    assert result.exit_code == 2, result.output
    assert isinstance(result.exception, SystemExit)
    assert result.stdout == ""
    says = re.sub("compiling kernels, once.*\n", "", result.stderr)
    assert says.startswith("error: ")
    assert says.count("\n") == 1, says
    assert len(says) < 1000
    for word in words:
        assert word in says, says
    return True


@pytest.mark.parametrize(
    ("number", "words"),
    [
        ("r03", ["s.toml", "holes[0].file", "line 1"]),
        ("r04", ["s.toml", "material.sigma_c = 1e-300"]),
        ("r09", ["s.toml", "line 2, width", "5001 digits"]),
        ("r10", ["s.toml", "holes[0].file", "name too long"]),
        ("r11", ["s.toml", "holes[0].file", "line 2: must hold two numbers"]),
    ],
)
def test_cases_are_refused_with_file_and_key(number, words):
    assert refused(run("initiation", case(number) / "s.toml"), *words)


def test_what_is_no_outline_is_not_quoted():
    assert "daemon" not in run("initiation", case("r11") / "s.toml").stderr


@pytest.mark.parametrize("title", ["[/]", "[red]x[/red]", ":x: :smile:", "$\\\\frac{$", "%s {0}"])
def test_titles_are_shown_as_they_are_and_drawn(tmp_path, title):
    (tmp_path / "s.toml").write_text(f'title = "{title}"\n{SCENE}')
    result = run("initiation", tmp_path / "s.toml", "--plot", tmp_path / "s.png")
    assert result.exit_code == 0, result.output
    assert title.replace("\\\\", "\\") in result.stdout


def test_the_case_of_a_title_with_markup_is_computed(tmp_path):
    result = run("initiation", case("r02") / "s.toml", "-o", tmp_path / "o.nc")
    assert result.exit_code == 0, result.output
    assert "[/] (rankine)" in result.stdout


def test_control_characters_do_not_reach_the_terminal(tmp_path):
    (tmp_path / "s.toml").write_text(f'title = "a\\u001b[2Jb"\n{SCENE}')
    assert refused(run("initiation", tmp_path / "s.toml"), "title", "control characters")
    assert without_control("a\x1b[2Jb\x9b\n") == "a<1b>[2Jb<9b>\n"


def pipe(path):
    os.mkfifo(path)


def unix_socket(path):
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(path))


def device(path):
    path.symlink_to("/dev/zero")


def folder(path):
    path.mkdir()


def itself(path):
    path.symlink_to(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes")
@pytest.mark.parametrize("make", [pipe, unix_socket, device, folder, itself], ids=lambda make: make.__name__)
@pytest.mark.parametrize(
    "command",
    [
        "initiation {}.toml",
        "initiation csv.toml",
        "initiation png.toml",
        "initiation scene.toml --displacements {}.frd",
        "initiation scene.toml --database {}.nc",
        "initiation scene.toml --method rankine --database {}.nc",
        "forces {}.frd",
        "forces {}.vtu --young 1 --poisson 0.3",
        "forces model.frd --inp {}.inp",
        "forces {}_beside.frd",
        "info {}.nc",
        "optimize cantilever --grid 4x3 --algorithm fs -o sa.nc --resume",
        "optimize cantilever --grid 4x3 --algorithm brute-force -o sa.nc --resume",
    ],
)
def test_what_is_no_file_is_refused_at_once(tmp_path, monkeypatch, make, command):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(SCENE)
    for kind, hole in (("csv", 'shape = "points"'), ("png", 'shape = "image"\npixel_size = 1.0')):
        text = SCENE.replace(
            'shape = "circle"\ncenter = [50.0, 50.0]\nradius = 20.0', f'{hole}\nfile = "x.{kind}"'
        )
        (tmp_path / f"{kind}.toml").write_text(text)
    shutil.copy(ROOT / "tests" / "data" / "plate_2d.frd", tmp_path / "model.frd")
    shutil.copy(ROOT / "tests" / "data" / "plate_2d.frd", tmp_path / "x_beside.frd")
    (tmp_path / "sa.journals").mkdir()
    for name in ("x.toml", "x.csv", "x.png", "x.frd", "x.vtu", "x.nc", "x.inp", "x_beside.inp"):
        make(tmp_path / name)
    for name in ("run-0.sqlite", "brute-force.npz"):
        make(tmp_path / "sa.journals" / name)
    assert refused(run(*command.format("x").split()))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x = " + "[" * 3000, ["nested too deeply"]),
        ("a." * 3000 + "b = 1", ["is not a known key"]),
        ("title = 0x" + "f" * 5000, ["title", "digits"]),
        ("\ufeff" + SCENE.replace("20.0", "-20.0"), ["holes[0].radius = -20.0"]),
        (SCENE + "\x00", ["is not a TOML file"]),
        (SCENE.replace("20.0", "1e-300"), ["holes[0].radius = 1e-300", "at least 1e-09"]),
        (SCENE.replace("0.1", "1e-300"), ["load", "1e-300"]),
        ("k" * 100_000 + " = 1", ["is not a known key"]),
    ],
)
def test_toml_that_programs_choke_on_is_refused(tmp_path, text, words):
    path = tmp_path / "s.toml"
    path.write_text(text if "plate" in text else text + "\n" + SCENE, encoding="utf-8")
    assert refused(run("initiation", path), "s.toml", *words)


def test_text_that_is_no_utf_8_is_refused_by_its_line(tmp_path):
    (tmp_path / "s.toml").write_bytes(SCENE.encode() + b"# \xff\n")
    assert refused(run("initiation", tmp_path / "s.toml"), "s.toml", "byte 0xff in line 17")


def test_what_is_too_large_is_not_read(tmp_path):
    with open(tmp_path / "s.toml", "wb") as file:
        file.truncate(10**12)
    assert refused(
        run("initiation", tmp_path / "s.toml"), "s.toml: is not a TOML file: it is larger than 20 MB"
    )


@pytest.mark.parametrize(("E", "K_Ic"), [(1e30, 1e-30), (1e-30, 1e30)])
def test_a_material_beyond_all_numbers_is_refused_by_what_was_given(E, K_Ic):
    with pytest.raises(ValueError, match=r"material\.K_Ic = .*makes G_c = "):
        slmm.Material.from_toughness(E, 0.3, 1.0, K_Ic)
    assert np.isfinite(slmm.Material(1e30, 0.3, 1e-30, 1e30).irwin_length)


def test_journals_that_are_damaged_or_something_else_are_refused_by_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.journals").mkdir()
    shutil.copy(case("r06") / "run-1.sqlite", tmp_path / "a.journals")
    shutil.copy(case("r07") / "brute-force.npz", tmp_path / "a.journals")
    search = "optimize cantilever --grid 6x4 --algorithm sa --set iterations=60 --seed 1 -o a.nc --resume"
    assert refused(run(*search.split()), "run-1.sqlite")
    every = "optimize cantilever --grid 4x3 --algorithm brute-force -o a.nc --resume"
    assert refused(run(*every.split()), "brute-force.npz: is no journal of brute-force")


@pytest.mark.parametrize("value", ["[" * 3000, "9" * 5000, "x" * 5000])
def test_settings_are_refused_by_name(value):
    assert refused(
        run("optimize", "cantilever", "--algorithm", "sa", "--set", f"iterations={value}"), "--set"
    )


FORCES = ["forces", "examples/inclined_crack.frd"], ["sqrt(mm)", "839", "540.8"]
INITIATION = ["initiation", "examples/circle.toml", "--method", "slmm+ac", "--positions", "4"], ["+-", "----"]
DESIGN = ["optimize", "cantilever", "--grid", "4x3"], ["####", "##.."]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "encoding", "surroundings"),
    [
        (FORCES, "cp1252", {"PYTHONIOENCODING": "cp1252"}),
        (INITIATION, "ascii", {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}),
        (DESIGN, "ascii", {"PYTHONIOENCODING": "ascii"}),
    ],
    ids=["cp1252", "C", "ascii"],
)
def test_output_fits_the_encoding(command, encoding, surroundings):
    arguments, words = command
    ended = subprocess.run(
        [sys.executable, "-c", "from slmm.command.cli import app; app()", *arguments],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), **surroundings},
        capture_output=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    text = ended.stdout.decode(encoding)
    assert all(word in text for word in words), text
    assert "…" not in text  # nothing is cut off


def test_characters_have_ascii_forms():
    assert fitting("± √ × · █", "utf-8") == "± √ × · █"
    assert fitting("± × · █", "ascii") == "+- x . #"
    assert fitting("MPa√mm", "cp1252") == "MPa sqrt(mm)"
    assert fitting("漢", "ascii") == "\\u6f22"
