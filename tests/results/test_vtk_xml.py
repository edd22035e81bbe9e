"""VTK's XML files give the mesh and the data that were put into them, in every form; what is damaged is named."""

import re
from pathlib import Path

import numpy as np
import pytest
from vtu_file import SQUARE, file_of

from slmm.mechanics.elasticity import Elasticity
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

DATA = Path(__file__).parents[1] / "data"
VTK, CASES = DATA / "vtk", Path(__file__).parents[3] / "shared" / "cases"
MATERIAL = Elasticity(1e3, 0.3)


@pytest.mark.parametrize("version", ["0.1", "1.0", "2.0", "2.1", "2.2", "2.3"])
def test_every_version_is_read(version, vtu_of):
    assert read_displacements(vtu_of(SQUARE, version=version)).area() == pytest.approx(1)


@pytest.mark.parametrize(
    "name", sorted(path.name for path in VTK.iterdir() if path.stem not in ("plane_cells", "solid_cells"))
)
def test_files_of_vtk_itself_hold_the_same_mesh(name):
    if re.fullmatch(r"pieces_\d.vtu", name):
        pytest.skip("a part, read with pieces.pvtu")
    results = read_element_results(VTK / name, elasticity=MATERIAL)
    assert len(results.cells["CPE4"]) == 6 and len(results.points) == 12
    expected = 1e-3 * results.points @ np.array([[1.0, 0.2], [-0.4, 0.5]])
    assert results.u == pytest.approx(expected, abs=1e-15)
    assert set(results.region["CPE4"]) == {0, 1}
    x, y = results.points[results.cells["CPE4"]].mean(axis=1).T
    assert np.array_equal(results.region["CPE4"], (3 * (y - 0.5) + x - 0.5) % 2)


def test_all_pieces_of_a_file_are_one_mesh():
    results = read_element_results(CASES / "03-vtu-two-pieces" / "two.vtu", elasticity=MATERIAL)
    assert len(results.points) == 6 and len(results.cells["CPE4"]) == 2
    assert results.stress["CPE4"][..., 0, 0] == pytest.approx(
        np.full((2, 4), MATERIAL.stress(np.diag([1e-3, 0]))[0, 0])
    )


def test_a_piece_may_be_empty(tmp_path):
    text = file_of(SQUARE).decode()
    empty = '<Piece NumberOfPoints="0" NumberOfCells="0"><Points><DataArray type="Float32" NumberOfComponents="3"/>'
    empty += "</Points><Cells>" + "".join(
        f'<DataArray type="Int64" Name="{name}"/>' for name in ("connectivity", "offsets", "types")
    )
    (tmp_path / "two.vtu").write_text(text.replace("<Piece", empty + "</Cells></Piece><Piece", 1))
    assert read_displacements(tmp_path / "two.vtu").area() == pytest.approx(1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('type="UnstructuredGrid"', 'type="PolyData"', "polygons of surfaces"),
        ('type="UnstructuredGrid"', 'type="ImageData"', "holds an image"),
        ('version="2.2"', 'version="3.0"', "version '3.0'"),
        ('byte_order="LittleEndian"', 'byte_order="Middle"', "byte_order = 'Middle'"),
        ('header_type="UInt32"', 'header_type="Int8"', "header_type = 'Int8'"),
        ('header_type="UInt32"', 'header_type="UInt32" compressor="vtkBzip2"', "compressor = 'vtkBzip2'"),
        ("<VTKFile", "<!DOCTYPE x [<!ENTITY a 'b'>]><VTKFile", "document type"),
        ("</Cells>", "", "no XML"),
        ('Name="types"', 'Name="kinds"', "array types is missing"),
        ('NumberOfPoints="4"', 'NumberOfPoints="-4"', "NumberOfPoints = '-4'"),
        ('NumberOfPoints="4"', 'NumberOfPoints="' + 5000 * "4" + '"', "NumberOfPoints = '4444"),
        ("0 1 2 3<", "0 1 two 3<", "array connectivity: has a word that is no number of type Int64"),
        (">9<", ">900<", "array types: has a word that is no number of type UInt8"),
        (
            '<DataArray type="Float64" Name="u"',
            '<DataArray TimeStep="0" type="Float64" Name="u"',
            "several time steps",
        ),
        ('Name="u" NumberOfComponents="3"', 'Name="u" NumberOfComponents="0"', "NumberOfComponents = 0"),
    ],
)
def test_what_a_file_says_of_itself_is_checked(old, new, message, vtu_of):
    path = vtu_of(SQUARE)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ValueError, match=message) as refusal:
        read_displacements(path)
    assert len(str(refusal.value)) < 500


def test_elements_within_each_other_have_an_end(vtu_of):
    path = vtu_of(SQUARE)
    path.write_text("<VTKFile>" + 200_000 * "<a>")
    with pytest.raises(ValueError, match="within each other more than 50 times"):
        read_displacements(path)
