"""Crack tips are found where two faces that lie on each other end inside the material."""

import numpy as np
import pytest

from slmm.fracture.tips import find_crack_tips


def slit_square(n=8, element_type="CPE4", cut=(0, 4), row=4, jitter=0.0):
    """A square of n x n elements of side 1, slit along a row of nodes between two columns."""
    quadratic = element_type in ("CPE8", "CPE8R")
    step = 2 if quadratic else 1
    m = step * n + 1
    x, y = np.meshgrid(np.arange(m) / step, np.arange(m) / step)
    points = np.column_stack([x.ravel(), y.ravel()])
    number = np.arange(m * m).reshape(m, m)
    upper = number.copy()
    # nodes of the upper face: all between the ends, and an end on the boundary
    columns = np.arange(step * cut[0] + (cut[0] > 0), step * cut[1] + (cut[1] == n))
    upper[step * row, columns] = m * m + np.arange(len(columns))
    points = np.concatenate([points, points[number[step * row, columns]]])
    i, j = (a.ravel() for a in np.meshgrid(step * np.arange(n), step * np.arange(n), indexing="ij"))
    place = [(0, 0), (0, step), (step, step), (step, 0)]
    if quadratic:
        place += [(0, 1), (1, 2), (2, 1), (1, 0)]
    above = i >= step * row
    nodes = np.stack([np.where(above, upper[i + a, j + b], number[i + a, j + b]) for a, b in place], axis=1)
    return points, {element_type: nodes}


@pytest.mark.parametrize("element_type", ["CPE4", "CPE8"])
def test_a_slit_from_the_edge_has_one_tip_and_its_faces(element_type):
    points, cells = slit_square(element_type=element_type)
    (tip,) = find_crack_tips(points, cells)
    assert tip.position.tolist() == [4.0, 4.0]
    assert tip.angle == pytest.approx(0.0)
    assert tip.clear == pytest.approx(4.0)
    assert tip.upper.shape == tip.lower.shape == (4, 3 if element_type == "CPE8" else 2)
    # outwards from the tip, each face over the other
    np.testing.assert_array_equal(points[tip.upper], points[tip.lower])
    assert points[tip.upper[:, 1], 0].tolist() == [3.0, 2.0, 1.0, 0.0]
    above = np.isin(cells[element_type], tip.upper[:, 1]).any(axis=1)
    assert points[cells[element_type][above], 1].min() >= 4.0


def test_an_inner_slit_has_two_tips_that_point_apart():
    tips = find_crack_tips(*slit_square(cut=(2, 5)))
    assert sorted((tip.position[0], round(np.degrees(tip.angle)) % 360) for tip in tips) == [(2, 180), (5, 0)]
    # the slit's other end, and the plate's edge
    assert sorted(tip.clear for tip in tips) == [2.0, 3.0]


def test_a_whole_plate_and_a_plate_cut_through_have_no_tip():
    assert find_crack_tips(*slit_square(cut=(3, 3))) == []
    assert find_crack_tips(*slit_square(cut=(0, 8))) == []


def test_turned_and_scaled_plates_have_turned_and_scaled_tips():
    points, cells = slit_square(cut=(2, 5))
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for before, after in zip(
        find_crack_tips(points, cells), find_crack_tips(1e-3 * points @ turn.T, cells), strict=True
    ):
        np.testing.assert_allclose(after.position, 1e-3 * turn @ before.position, atol=1e-15)
        assert after.clear == pytest.approx(1e-3 * before.clear)
        assert np.cos(after.angle - before.angle - angle) == pytest.approx(1.0)
        np.testing.assert_array_equal(after.upper, before.upper)


def test_mirrored_plates_have_their_faces_exchanged():
    points, cells = slit_square()
    (tip,) = find_crack_tips(points, cells)
    (mirrored,) = find_crack_tips(points * [1, -1], {"CPE4": cells["CPE4"][:, ::-1]})
    np.testing.assert_array_equal(mirrored.upper, tip.lower)
    np.testing.assert_array_equal(mirrored.lower, tip.upper)


def test_faces_end_where_the_crack_is_no_longer_straight():
    points, cells = slit_square()
    # the outer half of the crack bends down
    bent = points[:, 1] - np.where((points[:, 1] == 4) & (points[:, 0] < 2), 0.2 * (2 - points[:, 0]), 0.0)
    (tip,) = find_crack_tips(np.column_stack([points[:, 0], bent]), cells)
    assert len(tip.upper) == 2
    assert tip.clear == pytest.approx(2.0)


def test_a_material_interface_ends_what_is_clear():
    points, cells = slit_square()
    right = points[cells["CPE4"]][..., 0].min(axis=1) >= 5
    (tip,) = find_crack_tips(points, cells, {"CPE4": right.astype(int)})
    assert tip.clear == pytest.approx(1.0)


def test_collapsed_elements_share_one_tip():
    """Quadrilaterals around the tip with two of their nodes in it, as Abaqus makes them."""
    sectors = 8
    theta = np.linspace(-np.pi, np.pi, sectors + 1)
    rings = [r * np.column_stack([np.cos(theta), np.sin(theta)]) for r in (0.0, 1.0, 2.0)]
    points = np.concatenate(rings)
    points[np.abs(points) < 1e-12] = 0.0
    n = sectors + 1
    for tip_nodes in (np.zeros(n, dtype=int), np.arange(n)):
        number = np.arange(3 * n).reshape(3, n)
        number[0] = tip_nodes
        cells = {
            "CPE4": np.array(
                [
                    [number[k, j], number[k + 1, j], number[k + 1, j + 1], number[k, j + 1]]
                    for k in range(2)
                    for j in range(sectors)
                ]
            )
        }
        (tip,) = find_crack_tips(points, cells)
        assert tip.position.tolist() == [0.0, 0.0]
        assert tip.clear == pytest.approx(2 * np.cos(np.pi / sectors))
        assert len(tip.upper) == 2


def test_solids_have_no_tips():
    with pytest.raises(ValueError, match="C3D8 is no plane element"):
        find_crack_tips(np.zeros((8, 3)), {"C3D8": np.arange(8)[None]})
