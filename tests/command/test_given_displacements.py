"""`slmm initiation` on displacements from a finite element model: every form of the file, or a reason."""

import shutil
from pathlib import Path

import meshio
import numpy as np
import pytest
import xarray as xr
from command_line import refused, run

DATA = Path(__file__).parents[1] / "data"
EXAMPLES = Path(__file__).parents[2] / "examples"
CASES = Path(__file__).parents[3] / "shared" / "cases"
PLATE = """
[plate]
width = 20.0
height = 20.0
[[holes]]
shape = "circle"
center = [10.0, 10.0]
radius = 2.0
[material]
name = "PMMA"
[load]
strain = [0.0, 0.5, 0.0]
"""


@pytest.fixture
def plate_file(tmp_path):
    """The plate of tests/data/README.md, under another load."""
    path = tmp_path / "plate.toml"
    path.write_text(PLATE)
    return path


@pytest.mark.parametrize("name", ["plate.vtu", "plate_2d.frd"])
def test_displacements_from_a_file(plate_file, tmp_path, name):
    output, plot = tmp_path / "result.nc", tmp_path / "result.png"
    options = "--positions", "8", "--displacements", DATA / name, "-o", output, "--plot", plot
    result = run("initiation", plate_file, *options)
    assert result.exit_code == 0, result.stderr
    assert "failure index 0.885" in result.stdout  # 0.887 on our own model of a hundredth of the strain
    with xr.open_dataset(output) as written:
        assert written.attrs["displacements"] == name
        assert written.attrs["local_model"] == "given displacements"


def rewritten(path, parts=1, apart=False, **names):
    """The plate of plate.vtu in parts, each in a file of its own, with other data."""
    mesh = meshio.read(DATA / "plate.vtu")
    nodes, u = mesh.cells_dict["quad8"], mesh.point_data["displacement"]
    right = np.digitize(mesh.points[nodes].mean(axis=1)[:, 0], np.linspace(0, 20, parts + 1)[1:-1])
    files = []
    for part in range(parts):
        own, used = nodes[right == part], np.unique(nodes[right == part])
        own = np.arange(own.size).reshape(own.shape) if apart else np.searchsorted(used, own)
        used = nodes[right == part].ravel() if apart else used
        data = {name: factor * u[used] for name, factor in (names or {"u": 1.0}).items()}
        files.append(path.with_name(f"{path.stem}_{part}.vtu"))
        meshio.write_points_cells(files[-1], mesh.points[used], {"quad8": own}, data)
    pieces = "".join(f'<Piece Source="{file.name}"/>' for file in files)
    path.write_text(
        f'<VTKFile type="PUnstructuredGrid" version="2.2"><PUnstructuredGrid>{pieces}</PUnstructuredGrid></VTKFile>'
    )
    return path


@pytest.mark.parametrize("form", ["pieces", "elements apart", "lz4", "Code_Aster"])
def test_every_form_of_the_displacements_gives_the_same(form, plate_file, tmp_path):
    path = {
        "pieces": lambda: rewritten(tmp_path / "p.pvtu", parts=3),
        "elements apart": lambda: rewritten(tmp_path / "p.pvtu", apart=True),
        "lz4": lambda: CASES / "16-lz4" / "lz4.vtu",
        "Code_Aster": lambda: CASES / "08-displacement-names" / "aster.vtu",
    }[form]()
    result = run("initiation", plate_file, "--positions", "8", "--displacements", path)
    assert result.exit_code == 0, result.stderr
    assert "failure index 0.885" in result.stdout


def test_the_data_that_are_the_displacements_are_named(plate_file, tmp_path):
    path = rewritten(tmp_path / "p.pvtu", f=1.0, half=0.5)
    asked = "initiation", plate_file, "--positions", "8", "--displacements", path
    assert refused(run(*asked), "--field", "there are f, half")
    assert refused(run(*asked, "--field", "g"), "field = 'g'", "there are f, half")
    plot = tmp_path / "plot.png"
    whole, half = run(*asked, "--field", "f", "--plot", plot), run(*asked, "--field", "half")
    assert "failure index 0.885" in whole.stdout and plot.exists()
    assert "failure index 0.44" in half.stdout
    assert refused(run("initiation", plate_file, "--field", "f"), "field = 'f'", "none is given")
    forces = "forces", path, "--young", "2960", "--poisson", "0.35"
    assert refused(run(*forces), "--field", "there are f, half")
    assert run(*forces, "--field", "f").exit_code == 0


def test_displacements_are_refused_with_a_reason(plate_file, tmp_path):
    plate = DATA / "plate.vtu"
    assert refused(
        run("initiation", EXAMPLES / "circle.toml", "--displacements", plate), "(20, 20)", "(100, 100) mm"
    )
    assert refused(run("initiation", plate_file, "--displacements", tmp_path / "none.vtu"), "no such file")
    assert refused(run("initiation", plate_file, "--displacements", plate_file), "cannot be read")
    full = "--method", "full-fea"
    assert refused(run("initiation", plate_file, *full, "--displacements", plate), "full-fea", "slmm+ac")
    own = tmp_path / "own.nc"
    shutil.copy(plate, own)
    assert refused(run("initiation", plate_file, "--displacements", own, "-o", own), "is an input")
