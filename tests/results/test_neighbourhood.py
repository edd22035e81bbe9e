"""Contours around tips and interfaces: topology alone, so that moving the nodes changes nothing."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.results.neighbourhood import interface_nodes, rings


def grid(columns, rows):
    """Quadrilaterals (rows * columns, 4), and the node (rows + 1, columns + 1) at each place."""
    node = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    corners = [node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]]
    return np.stack([c.ravel() for c in corners], axis=1), node


@given(row=st.integers(0, 6), column=st.integers(0, 8), n=st.integers(1, 10))
def test_contours_in_a_regular_mesh_are_squares(row, column, n):
    cells, node = grid(8, 6)
    found = rings({"CPE4": cells}, [node[row, column]], n)
    i, j = np.indices(node.shape)
    distance = np.maximum(abs(i - row), abs(j - column))
    assert len(found) == n
    for k, ring in enumerate(found):
        assert ring.tolist() == sorted(node[distance <= k])


def test_contours_cross_from_one_type_of_element_to_the_next():
    cells = {"CPE4": [[0, 1, 4, 3]], "CPE3": [[1, 2, 5], [1, 5, 4]], "CPE6": [[2, 6, 5, 7, 8, 9]]}
    assert [ring.tolist() for ring in rings(cells, 0, 4)] == [
        [0],
        [0, 1, 3, 4],
        [0, 1, 2, 3, 4, 5],
        list(range(10)),
    ]


def test_contours_go_around_both_faces_of_a_crack_but_not_across_it():
    """A strip cut along its middle up to the third node; node 2 of the cut is the tip."""
    cells, node = grid(4, 2)
    upper = cells[4:].copy()
    # the faces have nodes of their own
    upper[np.isin(upper, node[1, :2])] += 100
    cells = np.concatenate([cells[:4], upper])
    second = rings({"CPE4": cells}, [node[1, 2]], 2)[1]
    assert {node[1, 1], node[1, 1] + 100} <= set(second)
    mouth = rings({"CPE4": cells}, [node[1, 0]], 2)[1]
    assert mouth.tolist() == sorted([*node[0, :2], *node[1, :2]])


def test_all_nodes_of_a_collapsed_tip_are_the_first_contour():
    cells = {"CPE4": [[0, 2, 3, 1], [1, 3, 4, 1]]}
    assert [ring.tolist() for ring in rings(cells, [1, 0], 2)] == [[0, 1], [0, 1, 2, 3, 4]]


def test_interface_is_what_regions_share_whatever_the_elements():
    cells = {"CPE4": [[0, 1, 4, 3]], "CPE3": [[1, 2, 5], [1, 5, 4], [5, 6, 4]]}
    assert interface_nodes(cells, {"CPE4": [7], "CPE3": [2, 2, 2]}).tolist() == [1, 4]
    assert interface_nodes(cells, {"CPE4": [2], "CPE3": [2, 2, 5]}).tolist() == [4, 5]
    assert interface_nodes(cells, {"CPE4": [1], "CPE3": [1, 1, 1]}).tolist() == []


@given(st.lists(st.integers(0, 3), min_size=12, max_size=12))
def test_interface_of_any_regions_is_that_found_node_by_node(regions):
    cells, node = grid(4, 3)
    touching = [{regions[e] for e in np.flatnonzero((cells == n).any(axis=1))} for n in node.ravel()]
    expected = [n for n, found in enumerate(touching) if len(found) > 1]
    assert interface_nodes({"CPE4": cells}, {"CPE4": regions}).tolist() == expected


def test_wrong_input_is_named():
    cells = {"CPE3": [[0, 1, 2]]}
    with pytest.raises(ValueError, match="n = 0: must be at least 1 contour"):
        rings(cells, [0], 0)
    with pytest.raises(ValueError, match="tip names node 5: no element has it"):
        rings(cells, [0, 5], 1)
    with pytest.raises(ValueError, match="tip has no nodes"):
        rings(cells, [], 1)
    with pytest.raises(ValueError, match="cells has no elements"):
        rings({}, [0], 1)
    with pytest.raises(ValueError, match=r"cells\['CPE3'\] has the shape \(1, 3\) and numbers from -1"):
        interface_nodes({"CPE3": [[0, 1, -1]]}, {"CPE3": [0]})
    with pytest.raises(ValueError, match="region has no values of CPE3, of which there are 1 elements"):
        interface_nodes(cells, {})
    with pytest.raises(ValueError, match=r"region\['CPE3'\] has the shape \(2,\): there are 1 elements"):
        interface_nodes(cells, {"CPE3": [0, 1]})
