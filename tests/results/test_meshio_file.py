"""What meshio reads, of every format and step, is the same field; what it cannot read is refused."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from slmm.results.frd import read_frd
from slmm.results.results import read_displacements

DATA = Path(__file__).parents[1] / "data"
PLATE, VTU = DATA / "plate_2d.frd", DATA / "plate.vtu"
RNG = np.random.default_rng(0)
IN_PLATE = RNG.uniform(0, 20, (500, 2))


@pytest.mark.parametrize(
    ("name", "file_format"),
    [
        ("plate.vtu", "vtu"),
        ("plate.vtk", "vtk"),
        ("plate.xdmf", "xdmf"),
        ("plate.msh", "gmsh"),
        ("plate.med", "med"),
    ],
)
@pytest.mark.parametrize("called", ["displacement", "Displacements", "U", "DISP"])
def test_every_format_and_name_of_displacements_gives_the_same_field(name, file_format, called, tmp_path):
    result = read_frd(PLATE)
    path = tmp_path / name
    u = result.fields["DISP"][-1].values
    other = np.ones(len(u))
    meshio.write_points_cells(
        path, result.nodes, result.cells, {"T": other, called: u}, file_format=file_format
    )
    expected = read_displacements(PLATE).displacement(IN_PLATE)
    assert read_displacements(path).displacement(IN_PLATE) == pytest.approx(expected, abs=1e-12)


def test_steps_of_xdmf_files_are_chosen_by_their_place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the writer puts its data there
    result = read_frd(PLATE)
    with meshio.xdmf.TimeSeriesWriter("series.xdmf") as writer:
        writer.write_points_cells(result.nodes, result.cells)
        for field in result.fields["DISP"]:
            writer.write_data(field.value, point_data={"U": field.values})
    for step in (0, 1, -1, -2):
        expected = read_displacements(PLATE, step).displacement(IN_PLATE)
        assert read_displacements("series.xdmf", step).displacement(IN_PLATE) == pytest.approx(expected)
    with pytest.raises(ValueError, match="step = 2: steps with displacements: 2"):
        read_displacements("series.xdmf", 2)


def test_steps_of_med_files_are_chosen_by_their_place(tmp_path):
    # meshio gives the steps of a MED file names of their own
    result = read_frd(PLATE)
    data = {f"U[{k}] - {f.value:g}": f.values for k, f in enumerate(result.fields["DISP"])}
    meshio.write_points_cells(tmp_path / "series.med", result.nodes, result.cells, data)
    for step in (0, 1, -1):
        expected = read_displacements(PLATE, step).displacement(IN_PLATE)
        assert read_displacements(tmp_path / "series.med", step).displacement(IN_PLATE) == pytest.approx(
            expected
        )


@pytest.mark.parametrize("name", ["cut.vtu", "cut.vtk", "cut.xdmf", "cut.med", "cut.msh", "cut.unknown"])
def test_files_that_cannot_be_read_are_refused_without_a_word_on_the_screen(name, tmp_path, capfd):
    path = tmp_path / name
    path.write_bytes(VTU.read_bytes()[:5000])
    with pytest.raises(ValueError, match="cannot be read"):
        read_displacements(path)
    assert capfd.readouterr() == ("", "")
