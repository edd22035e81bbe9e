"""Cells of every type of VTK's have their nodes in the order of the elements; others are named."""

import re
from pathlib import Path

import numpy as np
import pytest
from vtu_file import SQUARE

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.mechanics.elements import element_named
from slmm.results.mesh_step import mesh_displacements
from slmm.results.plane_elements import PLANE_ELEMENTS
from slmm.results.read_results import read_element_results
from slmm.results.results import FACES, read_displacements
from slmm.results.vtk_cells import CELLS

DATA = Path(__file__).parents[1] / "data"
VTK, CASES = DATA / "vtk", Path(__file__).parents[3] / "shared" / "cases"
MATERIAL = Elasticity(1e3, 0.3)


def field(x, second):
    """The displacements in the files of all cells, see vtk_files.py there."""
    linear = 1e-3 * x @ np.array([[1.0, 0.2, 0.3], [-0.4, 0.5, 0.1], [0.2, -0.3, 0.7]])
    return linear + second * 1e-4 * np.stack([x[:, 0] * x[:, 1], x[:, 1] ** 2, x[:, 2] * x[:, 0]], axis=1)


@pytest.mark.parametrize(("name", "d"), [("plane_cells.vtu", 2), ("solid_cells.vtu", 3)])
def test_cells_of_every_type_have_their_nodes_in_order(name, d):
    """In affine cells, whose nodes VTK itself has placed, displacements of their own degree are exact everywhere."""
    results = read_element_results(VTK / name, elasticity=MATERIAL)
    elements = [known.element for known in ELEMENT_TYPES.values()]
    assert set(results.cells) == {element.name for element in elements if element.dimension == d}
    for kind, nodes in results.cells.items():
        element = element_named(kind)
        second = len(element.nodes) > 8 or (d == 2 and len(element.nodes) in (6, 8))
        at = element.nodes[: element.corners].mean(axis=0) + 0.1 * np.array([0.3, -0.7, 0.5])[:d]
        shape = element.shape(np.stack([at, *element.points]))
        x = np.einsum("qn,enj->eqj", shape, results.points[nodes])
        u = np.einsum("qn,enj->eqj", shape, results.u[nodes])
        x = np.pad(x, ((0, 0), (0, 0), (0, 3 - d))).reshape(-1, 3)
        assert u.reshape(-1, d) == pytest.approx(field(x, second)[:, :d], abs=1e-12), kind


def test_both_commands_read_the_same_elements():
    plane = {kind for kind, known in ELEMENT_TYPES.items() if known.element.dimension == 2}
    assert plane == set(PLANE_ELEMENTS)
    assert set(FACES) < set(ELEMENT_TYPES)
    assert {kind for kind, _ in CELLS.values()} == set(ELEMENT_TYPES)
    plate = read_displacements(VTK / "plane_cells.vtu")
    results = read_element_results(VTK / "plane_cells.vtu", elasticity=MATERIAL)
    assert sum(map(len, plate.cells.values())) == sum(map(len, results.cells.values())) == 10


def test_bricks_of_second_order_had_two_edges_the_other_way_before_version_2_1(tmp_path):
    text = (VTK / "solid_cells.vtu").read_bytes()
    now = mesh_displacements(VTK / "solid_cells.vtu", -1).mesh.cells["hexahedron27"]
    (tmp_path / "former.vtu").write_bytes(re.sub(rb'version="2\.\d"', b'version="2.0"', text, count=1))
    former = mesh_displacements(tmp_path / "former.vtu", -1).mesh.cells["hexahedron27"]
    assert np.array_equal(former[0], now[0])  # no Lagrange cell
    assert np.array_equal(former[1][[18, 19]], now[1][[19, 18]])


@pytest.mark.parametrize(
    ("kind", "name"), [(14, "pyramid"), (77, "Bezier quadrilateral"), (34, "biquadratic")]
)
def test_cells_that_are_not_read_are_named(kind, name, vtu_of):
    with pytest.raises(ValueError, match=f"cell 0 is a {name}.*VTK's type {kind}"):
        read_displacements(vtu_of(SQUARE | {"types": ("UInt8", 1, [kind])}))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("m.vtu", "cell 0 names node 99"),
        ("m_negative.vtu", "cell 0 names node -3"),
        ("m_offsets.vtu", "cell 1 ends at 4, before it begins"),
        ("m_type999.vtu", "VTK's type 999"),
    ],
)
def test_the_numbers_that_passed_are_refused(name, message):
    path = CASES / "r05-vtu-index-out-of-range" / name
    for read in (read_displacements, lambda path: read_element_results(path, elasticity=MATERIAL)):
        with pytest.raises(ValueError, match=message):
            read(path)
