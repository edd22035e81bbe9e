"""Exodus files give the last time unless another is asked for, and nodes in order; what is damaged is named."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest
from exodus_file import write
from hypothesis import given
from hypothesis import strategies as st

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.elements import element_named
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

MOOSE = Path(__file__).parents[3] / "shared" / "cases" / "08-displacement-names" / "moose.e"
STEEL = Elasticity(210e3, 0.3)

#: where the nodes of Exodus' order lie in the reference element: after the corners the bottom's edges, those between
#: bottom and top, those of the top; of a brick then its middle, bottom, top, left, right, front and back
HEX = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1),
       (0, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 0, -1), (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0),
       (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1),
       (0, 0, 0), (0, 0, -1), (0, 0, 1), (-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0)]  # fmt: skip
WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0),
         (0, 0, 0.5), (1, 0, 0.5), (0, 1, 0.5), (0.5, 0, 1), (0.5, 0.5, 1), (0, 0.5, 1)]  # fmt: skip
SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0)]
TYPES = {
    "HEX8": (HEX[:8], "C3D8"),
    "HEX20": (HEX[:20], "C3D20"),
    "HEX27": (HEX, "HEX27"),
    "WEDGE": (WEDGE[:6], "C3D6"),
    "WEDGE15": (WEDGE, "C3D15"),
    "QUAD4": (SQUARE[:4], "CPE4"),
    "QUAD8": (SQUARE[:8], "CPE8"),
    "QUAD9": (SQUARE, "QUAD9"),
    "TRI3": (WEDGE[:3], "CPE3"),
    "TRISHELL6": ([*WEDGE[:3], *WEDGE[6:9]], "CPE6"),
}


@pytest.mark.parametrize("called", TYPES)
def test_every_element_has_its_nodes_in_order(called, tmp_path):
    """In an affine element, displacements of its own degree are exact everywhere."""
    nodes, name = TYPES[called]
    element = element_named(name)
    d = element.dimension
    shape = np.array([[2.0, 0.3, 0.1], [-0.2, 1.5, 0.2], [0.1, -0.1, 1.2]])[:d, :d]
    points = np.array(nodes, dtype=float)[:, :d] @ shape.T

    def field(x):
        second = len(nodes) > 8 or (d == 2 and len(nodes) >= 6)
        bent = np.stack([x[:, 0] * x[:, 1], x[:, 1] ** 2, x[:, -1] * x[:, 0]], axis=1)[:, :d]
        return 1e-3 * x @ shape + second * 1e-4 * bent

    path = write(tmp_path / "one.e", called, points, [0 * points, field(points)])
    results = read_element_results(path, elasticity=STEEL)
    assert list(results.cells) == [name]
    at = element.shape(element.points)
    own = results.cells[name][0]
    assert at @ results.u[own] == pytest.approx(field(at @ results.points[own]), abs=1e-15)


def test_the_last_time_is_read_unless_another_is_asked_for():
    last, first = read_displacements(MOOSE), read_displacements(MOOSE, 0)
    assert last.displacement(np.array([[2.0, 2.0]])) != pytest.approx(0)
    assert np.array_equal(first.u, 0 * first.u)
    assert np.array_equal(read_displacements(MOOSE, -2).u, first.u)
    assert np.array_equal(read_element_results(MOOSE, elasticity=STEEL).u, last.u)
    with pytest.raises(ValueError, match="step = 2: steps with displacements: 2"):
        read_displacements(MOOSE, 2)


def test_blocks_are_joined_and_lines_left_out(tmp_path):
    points = np.array([[0.0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]])
    blocks = [np.array([[1, 2, 5, 4]]), np.array([[2, 3, 6, 5]])]
    path = write(tmp_path / "two.exo", "QUAD", points, [1e-3 * points], blocks)
    assert read_displacements(path).area() == pytest.approx(2)
    with netCDF4.Dataset(path, "a") as file:
        file["connect2"].elem_type = "BEAM2"
    assert read_displacements(path).area() == pytest.approx(1)


@pytest.mark.parametrize(
    ("called", "block", "message"),
    [
        (
            "PYRAMID5",
            [1, 2, 3, 4, 1],
            "connect1 has elements of type 'PYRAMID5' with 5 nodes: known are triangle",
        ),
        ("QUAD5", [1, 2, 3, 4, 1], "elements of type 'QUAD5' with 5 nodes"),
        ("QUAD4", [1, 2, 3, 5], "quad 0 names node 4: nodes are numbered from 0 to 3"),
        ("QUAD4", [0, 2, 3, 4], "quad 0 names node -1"),
    ],
)
def test_elements_that_do_not_fit_are_named(called, block, message, tmp_path):
    points = np.array(SQUARE[:4], dtype=float)
    path = write(tmp_path / "bad.e", called, points, [points], [np.array([block])])
    with pytest.raises(ValueError, match=rf"bad\.e: .*{message}"):
        read_displacements(path)


def test_a_mesh_without_times_holds_no_displacements(tmp_path):
    points = np.array(SQUARE[:4], dtype=float)
    path = write(tmp_path / "mesh.e", "QUAD4", points, [])
    with pytest.raises(ValueError, match=r"mesh\.e: step = -1: steps with displacements: 0"):
        read_displacements(path)


@given(data=st.data())
def test_damaged_bytes_are_refused_or_are_another_mesh(data, tmp_path_factory):
    text = bytearray(MOOSE.read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        text[data.draw(st.integers(0, len(text) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.getbasetemp() / "damaged.e"
    path.write_bytes(bytes(text[: data.draw(st.integers(len(text) - 300, len(text)))]))
    try:
        read_displacements(path)
    except ValueError as error:
        assert str(error).startswith(f"{path}: ")
