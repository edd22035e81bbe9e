"""The table of element types says nothing twice, and what follows from it is what other programs' manuals say."""

from collections import Counter

import numpy as np
import pytest

from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.mechanics.elements import ELEMENTS, element_named, type_named

TYPES = list(ELEMENT_TYPES.values())


def test_no_name_and_no_number_means_two_types():
    for meanings in (
        [name for known in TYPES for name in known.elements],
        [known.frd.number for known in TYPES if known.frd],
        [(cell.number, known.count) for known in TYPES for cell in known.vtk],
        [(begin, known.count) for known in TYPES if known.exodus for begin in known.exodus.beginnings],
    ):
        assert {number for number, count in Counter(meanings).items() if count > 1} == set()


@pytest.mark.parametrize("kind", ELEMENT_TYPES)
def test_every_order_names_each_node_once(kind):
    known = ELEMENT_TYPES[kind]
    orders = [known.frd and known.frd.order, known.exodus and known.exodus.order]
    orders += [order for cell in known.vtk for order in (cell.order, cell.former)]
    for order in filter(None, orders):
        assert sorted(order) == list(range(known.count))
    for element in known.elements.values():
        assert element.nodes.shape == element.exponents.shape == (known.count, element.dimension)


def test_what_is_said_of_names_is_said_of_names_that_are_there():
    for known in TYPES:
        assert {*known.plane_stress, *known.incompatible} <= set(known.elements)
        assert all("CPS" in name for name in known.plane_stress)
        assert [name for name in known.elements if "CPS" in name] == sorted(known.plane_stress)


def test_elements_of_a_type_have_its_nodes_and_points_of_their_own():
    for name in ELEMENTS:
        known = type_named(name)
        assert np.array_equal(element_named(name).nodes, known.element.nodes)
    assert [len(element_named(name).points) for name in ("CPE8", "CPS8", "CPE8R", "CPS8R")] == [9, 9, 4, 4]


#: of VTK's manual: nodes on one side, and over them on the other
OPPOSITE = {
    "wedge": [((0, 1, 2), (3, 4, 5))],
    "wedge15": [((0, 1, 2, 6, 7, 8), (3, 4, 5, 9, 10, 11))],
    "wedge18": [((0, 1, 2, 6, 7, 8), (3, 4, 5, 9, 10, 11))],
    "hexahedron": [
        ((0, 1, 2, 3), (4, 5, 6, 7)),
        ((0, 1, 5, 4), (3, 2, 6, 7)),
        ((0, 3, 7, 4), (1, 2, 6, 5)),
    ],
    "hexahedron20": [
        ((0, 1, 2, 3, 8, 9, 10, 11), (4, 5, 6, 7, 12, 13, 14, 15)),
        ((0, 1, 5, 4, 8, 17, 12, 16), (3, 2, 6, 7, 10, 18, 14, 19)),
        ((0, 3, 7, 4, 11, 19, 15, 16), (1, 2, 6, 5, 9, 18, 13, 17)),
    ],
    "hexahedron27": [
        ((0, 1, 2, 3, 8, 9, 10, 11, 24), (4, 5, 6, 7, 12, 13, 14, 15, 25)),
        ((0, 1, 5, 4, 8, 17, 12, 16, 22), (3, 2, 6, 7, 10, 18, 14, 19, 23)),
        ((0, 3, 7, 4, 11, 19, 15, 16, 20), (1, 2, 6, 5, 9, 18, 13, 17, 21)),
    ],
}


@pytest.mark.parametrize("kind", ELEMENT_TYPES)
def test_opposite_faces_are_those_of_the_manual(kind):
    known = ELEMENT_TYPES[kind]
    assert bool(known.side) == (kind in OPPOSITE)
    if known.side:
        faces = known.element.opposite_faces(ELEMENT_TYPES[known.side].element)
        found = [(tuple(face.tolist()), tuple(opposite.tolist())) for face, opposite in faces]
        assert found == [pair for own in OPPOSITE[kind] for pair in (own, own[::-1])]


@pytest.mark.parametrize("name", ["CPE4", "CPE8", "QUAD9"])
def test_quadrilaterals_have_four_corners_and_edges_whatever_their_nodes(name):
    element = element_named(name)
    assert element.corners == len(element.edges) == 4
    assert element.edges[:, :2].tolist() == [[0, 1], [1, 2], [2, 3], [3, 0]]
    assert element.edges[:, 2:].ravel().tolist() == ([] if name == "CPE4" else [4, 5, 6, 7])
