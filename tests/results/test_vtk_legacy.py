"""Legacy files of VTK give what was put into them; what is no mesh or is damaged is named."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.mechanics.elasticity import Elasticity
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

VTK = Path(__file__).parents[1] / "data" / "vtk"
SQUARE = """# vtk DataFile Version 4.2
a square
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 1 0 0
0 1 0 1 1 0
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
8
CELL_DATA 1
SCALARS region int 1
LOOKUP_TABLE default
7
POINT_DATA 4
SCALARS T double
LOOKUP_TABLE default
1 2 3 4
VECTORS nodal%20displacement double
0 0 0 0.001 0 0 0 0 0 0.001 0 0
"""


def read(tmp_path, text, suffix="model.vtk"):
    path = tmp_path / suffix
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_displacements(path)


def test_pixels_and_names_with_spaces_are_read(tmp_path):
    field = read(tmp_path, SQUARE)
    assert field.area() == pytest.approx(1) and list(field.cells) == ["quad"]
    assert field.displacement(np.array([[0.5, 0.3]])) == pytest.approx(np.array([[5e-4, 0]]))


@pytest.mark.parametrize("version", ["3.0", "4.2", "5.1"])
def test_versions_and_fields_are_read(version, tmp_path):
    cells = "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\n"
    text = SQUARE.replace("4.2", version)
    if version == "5.1":
        text = text.replace("CELLS 1 5\n4 0 1 2 3\n", cells)
    text = text.replace(
        "SCALARS T double\nLOOKUP_TABLE default\n1 2 3 4\n",
        "FIELD FieldData 2\nT 1 4 double\n1 2 3 4\nMETADATA\nINFORMATION 0\n\nS 2 4 float\n1 1 2 2\n3 3 4 4\n",
    )
    assert read(tmp_path, text).area() == pytest.approx(1)


def test_regions_belong_to_their_cells():
    for name in ("ascii.vtk", "binary.vtk"):
        results = read_element_results(VTK / name, elasticity=Elasticity(1e3, 0.3))
        assert len(results.cells["CPE4"]) == 6 and results.region["CPE4"].tolist() == [0, 1, 0, 1, 0, 1]


def test_a_structured_grid_is_read_as_elements(tmp_path):
    text = SQUARE.replace("UNSTRUCTURED_GRID", "STRUCTURED_GRID\nDIMENSIONS 2 2 1")
    text = text.replace("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n8\n", "").replace("nodal%20displacement", "u")
    assert read(tmp_path, text).area() == pytest.approx(1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("UNSTRUCTURED_GRID", "POLYDATA", r"polygons of surfaces \(POLYDATA\)"),
        ("4 0 1 2 3", "4 0 1 2 4", "cell 0 names node 4"),
        ("4 0 1 2 3", "4 0 1 2 -1", "cell 0 names node -1"),
        ("4 0 1 2 3", "5 0 1 2 3", "cell 0 reaches beyond the 5 numbers"),
        ("4 0 1 2 3", "3 0 1 2 3", "CELLS has 5 numbers: 1 cells take 4"),
        ("CELL_TYPES 1\n8", "CELL_TYPES 1\n14", "cell 0 is a pyramid"),
        ("CELL_TYPES 1\n8", "CELL_TYPES 2\n8 8", "CELL_TYPES has 2 numbers: there are 1 cells"),
        ("POINTS 4 float", "POINTS 4 string", "numbers of type 'string'"),
        ("POINTS 4 float", "POINTS 999999999 float", "more than the file can hold"),
        ("POINTS 4 float", "POINTS -4 float", "'-4' stands where a number"),
        ("POINTS 4 float", "POINTS 4", "a line is too short"),
        ("0 0 0 1 0 0", "0 0 0 one 0 0", "POINTS has a word that is no number of type float"),
        ("VECTORS nodal", "VEKTORS nodal", "'VEKTORS' stands where a keyword belongs"),
        ("0 0 0 0.001", "0 0 0.001", "nodal displacement has 11 numbers: 12 are expected"),
    ],
)
def test_what_does_not_fit_is_named(old, new, message, tmp_path):
    assert old in SQUARE
    with pytest.raises(ValueError, match=rf"model\.vtk: .*{message}"):
        read(tmp_path, SQUARE.replace(old, new, 1))


@pytest.mark.parametrize("name", ["ascii.vtk", "binary.vtk"])
@given(data=st.data())
def test_damaged_bytes_are_refused_or_are_another_mesh(name, data, tmp_path_factory):
    text = bytearray((VTK / name).read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        text[data.draw(st.integers(0, len(text) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.getbasetemp() / "damaged.vtk"
    path.write_bytes(bytes(text[: data.draw(st.integers(len(text) - 300, len(text)))]))
    try:
        read_displacements(path)
    except ValueError as error:
        assert str(error).startswith(f"{path}: ")


def test_what_meshio_writes_is_read(tmp_path):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    for binary in (True, False):
        meshio.vtk.write(
            tmp_path / "m.vtk", meshio.Mesh(points, {"quad": [[0, 1, 2, 3]]}, {"u": points}), binary=binary
        )
        assert read_displacements(tmp_path / "m.vtk").displacement(np.array([[0.2, 0.3]])) == pytest.approx(
            np.array([[0.2, 0.3]])
        )
