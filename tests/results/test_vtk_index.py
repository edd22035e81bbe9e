"""Files of VTK that name others: all pieces of a mesh without ghosts, and the time that is asked for."""

import shutil
from pathlib import Path

import meshio
import numpy as np
import pytest

from slmm.mechanics.elasticity import Elasticity
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

VTK, CASES = Path(__file__).parents[1] / "data" / "vtk", Path(__file__).parents[3] / "shared" / "cases"
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
INDEX = '<VTKFile type="PUnstructuredGrid" version="2.2"><PUnstructuredGrid>{}</PUnstructuredGrid></VTKFile>'
SERIES = '<VTKFile type="Collection" version="0.1"><Collection>{}</Collection></VTKFile>'


def square(path, stretch, corner=0.0):
    points = POINTS + np.array([corner, 0, 0])
    meshio.write_points_cells(
        path,
        points,
        {"quad": np.array([[0, 1, 2, 3]])},
        {"u": stretch * points},
    )


def test_the_piece_that_an_index_names_is_read():
    assert read_displacements(CASES / "17-pvtu" / "p.pvtu").area() == pytest.approx(1)


def test_pieces_hang_together_and_ghosts_are_left_out():
    results = read_element_results(VTK / "pieces.pvtu", elasticity=Elasticity(1e3, 0.3))
    assert len(results.cells["CPE4"]) == 6 and len(results.points) == 12
    assert read_displacements(VTK / "pieces.pvtu").area() == pytest.approx(6)


def test_ghosts_that_are_not_marked_are_read_once(tmp_path):
    for k in range(2):
        shutil.copy(VTK / f"pieces_{k}.vtu", tmp_path)
    shutil.copy(VTK / "ascii.vtu", tmp_path / "whole.vtu")
    (tmp_path / "p.pvtu").write_text(
        INDEX.format('<Piece Source="whole.vtu"/><Piece Source="pieces_0.vtu"/>')
    )
    results = read_element_results(tmp_path / "p.pvtu", elasticity=Elasticity(1e3, 0.3))
    assert len(results.cells["CPE4"]) == 6 and len(results.region["CPE4"]) == 6


def test_steps_are_counted_in_the_order_of_time(tmp_path):
    (tmp_path / "data").mkdir()
    rows = []
    for time, stretch in ((2.0, 0.03), (0.0, 0.01), (1.0, 0.02)):
        square(tmp_path / "data" / f"t{time:g}.vtu", stretch)
        rows.append(f'<DataSet timestep="{time:g}" part="0" file="data/t{time:g}.vtu"/>')
    (tmp_path / "series.pvd").write_text(SERIES.format("".join(rows)))
    for step, stretch in ((0, 0.01), (1, 0.02), (2, 0.03), (-1, 0.03), (-3, 0.01)):
        u = read_displacements(tmp_path / "series.pvd", step).displacement(np.array([[1.0, 0.5]]))
        assert u[0, 0] == pytest.approx(stretch)
        assert read_element_results(
            tmp_path / "series.pvd", step, Elasticity(1, 0.3)
        ).u.max() == pytest.approx(stretch)
    with pytest.raises(ValueError, match="step = 3: steps with displacements: 3"):
        read_displacements(tmp_path / "series.pvd", 3)


def test_parts_of_one_time_are_one_mesh(tmp_path):
    square(tmp_path / "a.vtu", 0.01)
    square(tmp_path / "b.vtu", 0.01, corner=1.0)
    (tmp_path / "b.pvtu").write_text(INDEX.format('<Piece Source="b.vtu"/>'))
    rows = '<DataSet timestep="0" part="0" file="a.vtu"/><DataSet timestep="0" part="1" file="b.pvtu"/>'
    (tmp_path / "series.pvd").write_text(SERIES.format(rows))
    results = read_element_results(tmp_path / "series.pvd", elasticity=Elasticity(1, 0.3))
    assert len(results.points) == 6


@pytest.mark.parametrize(
    ("name", "text", "error", "message"),
    [
        ("p.pvtu", INDEX.format(""), ValueError, "names no <Piece>"),
        (
            "p.pvtu",
            INDEX.format('<Piece Source="none.vtu"/>'),
            FileNotFoundError,
            "names none.vtu, and there is no",
        ),
        ("p.pvtu", INDEX.format('<Piece Source="/etc/passwd"/>'), ValueError, "must lie in the same folder"),
        ("p.pvtu", INDEX.format('<Piece Source="../a.vtu"/>'), ValueError, "must lie in the same folder"),
        (
            "p.pvtu",
            INDEX.format('<Piece Source="a\\..\\..\\a.vtu"/>'),
            ValueError,
            "must lie in the same folder",
        ),
        ("p.pvtu", INDEX.format('<Piece Source="C:\\a.vtu"/>'), ValueError, "must lie in the same folder"),
        ("p.pvtu", INDEX.format('<Piece Source="p.pvtu"/>'), ValueError, "p.pvtu: holds .*PUnstructuredGrid"),
        ("p.pvtu", INDEX.replace("PUnstructuredGrid", "PPolyData"), ValueError, "polygons of surfaces"),
        ("s.pvd", SERIES.format(""), ValueError, "names no <DataSet>"),
        ("s.pvd", SERIES.format('<DataSet timestep="one" file="a.vtu"/>'), ValueError, "timestep = 'one'"),
        (
            "s.pvd",
            SERIES.format('<DataSet timestep="0" file="s.pvd"/>'),
            ValueError,
            "s.pvd: holds .*'Collection'",
        ),
        ("s.pvd", "no XML", ValueError, "cannot be read: no XML"),
        ("s.vtp", "", ValueError, "polygons of surfaces"),
        ("s.vtm", "", ValueError, "an index of several data sets"),
        ("s.odb", "", ValueError, "only Abaqus reads"),
    ],
)
def test_what_an_index_cannot_name_is_refused(name, text, error, message, tmp_path):
    (tmp_path / name).write_text(text)
    with pytest.raises(error, match=message):
        read_displacements(tmp_path / name)
