"""Crack tips are found where the boundary turns back between two faces that lie on each other, or nearly so."""

import numpy as np
import pytest
from cracked_square import loaded, square, tension

from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fracture.loading import crack_tip_loading
from slmm.fracture.tips import find_crack_tips
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading


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


def one_tip(results, **options):
    loading = crack_tip_loading(results, **options)
    assert loading.sizes["tip"] == 1
    assert loading.status.values.tolist() == ["ok"]
    return loading.isel(tip=0)


@pytest.fixture(scope="module")
def slit():
    return {kind: one_tip(loaded(*square(kind), tension())) for kind in ("CPE4", "CPE6", "CPE8")}


@pytest.mark.parametrize("one_sided", [False, True])
@pytest.mark.parametrize("gap", [1e-3, 0.02, 0.05, 0.1, 0.15])
@pytest.mark.parametrize("kind", ["CPE4", "CPE6", "CPE8"])
def test_faces_that_stand_apart_and_end_in_a_node_are_a_crack(kind, gap, one_sided, slit):
    """A gap of up to 1/130 of the crack's length, which the edges next to the tip close."""
    edge = 2.0
    points, cells = square(kind, gap=lambda d: gap * np.minimum(d / edge, 1.0), one_sided=one_sided)
    tip = one_tip(loaded(points, cells, tension()))
    assert float(tip.K_I) == pytest.approx(float(slit[kind].K_I), rel=2e-3)
    assert float(tip.G) == pytest.approx(float(slit[kind].G), rel=3e-3)
    assert float(tip.x) == pytest.approx(20.0)
    assert abs(float(tip.angle)) < 0.2


@pytest.mark.parametrize("gap", [1e-3, 0.1, 0.5])
def test_a_crack_in_a_deformed_mesh_is_a_narrow_wedge(gap, slit):
    tip = one_tip(loaded(*square(gap=lambda d: gap * d / 20), tension()))
    assert float(tip.K_I) == pytest.approx(float(slit["CPE8"].K_I), rel=1e-3)


@pytest.mark.parametrize("gap", [1e-3, 0.02, 0.1])
def test_a_narrow_blunt_end_is_a_tip(gap, slit):
    """The elements between the faces are taken out of a mesh with a thin row of them."""
    tip = one_tip(loaded(*uncut(gap), tension()))
    assert [float(tip.x), float(tip.y)] == pytest.approx([20.0, 20.0], abs=1e-9)
    assert float(tip.angle) == pytest.approx(0.0, abs=1e-9)
    assert float(tip.K_I) == pytest.approx(float(slit["CPE8"].K_I), rel=1e-2)
    assert float(tip.G) == pytest.approx(float(slit["CPE8"].G), rel=1e-2)


def uncut(gap, n=20):
    """Elements of 2 mm and between them a row as high as the gap, without those of it behind x = 20 mm."""
    below = np.linspace(0.0, 20.0 - gap / 2, n + 1)
    y = np.concatenate([below, [20.0], 40.0 - below[::-1]])
    x, y = np.meshgrid(np.linspace(0.0, 40.0, 2 * n + 1), y)
    points = np.column_stack([x.ravel(), y.ravel()])
    number = np.arange(x.size).reshape(x.shape)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(0, 2 * n + 2, 2), np.arange(0, 2 * n, 2), indexing="ij"))
    place = [(0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0)]
    nodes = np.stack([number[i + a, j + b] for a, b in place], axis=1)
    void = (i == n) & (j < n)
    used, nodes = np.unique(nodes[~void], return_inverse=True)
    return points[used], {"CPE8": nodes.reshape(-1, 8)}


@pytest.mark.parametrize("degrees", [3, 10, 30])
def test_the_tip_of_a_narrow_notch_may_be_given(degrees, slit):
    slope = 2 * np.tan(np.radians(degrees / 2))
    results = loaded(*square(gap=lambda d: slope * d), tension())
    alone = crack_tip_loading(results)
    assert alone.sizes["tip"] == 0
    assert "--tip X,Y" in alone.attrs["remark"]
    tip = one_tip(results, tips=[(20.2, 19.9)])
    assert [float(tip.x), float(tip.y), float(tip.angle)] == pytest.approx([20.0, 20.0, 0.0], abs=1e-9)
    assert float(tip.K_I) == pytest.approx(float(slit["CPE8"].K_I), rel=1e-2)
    assert float(tip.spread) < 0.02


def test_a_wide_notch_a_place_inside_and_a_place_on_a_smooth_side_are_no_tips():
    points, cells = square(gap=lambda d: 2 * np.tan(np.radians(20)) * d)
    with pytest.raises(
        ValueError, match="does not turn back between two straight faces that open by 30 degrees"
    ):
        find_crack_tips(points, cells, given=[(20, 20)])
    with pytest.raises(ValueError, match=r"tip = \(30, 10\) mm: no boundary is there"):
        find_crack_tips(*square(), given=[(30, 10)])
    with pytest.raises(ValueError, match="does not turn back"):
        find_crack_tips(*square(), given=[(40, 10)])


def test_a_tip_that_is_given_and_found_is_one_and_its_direction_may_be_given():
    points, cells = square()
    (found,) = find_crack_tips(points, cells)
    (given,) = find_crack_tips(points, cells, given=[(20, 20)])
    assert given.angle == found.angle
    (turned,) = find_crack_tips(points, cells, given=[(20, 20, 0.5)])
    assert turned.angle == pytest.approx(np.radians(0.5))


def test_holes_and_slots_are_no_cracks():
    """A slot of 1/40 of its length has two straight sides and turns back; its end is no tip."""
    points, cells = uncut(0.5)
    assert find_crack_tips(points, cells) == []


def test_behind_a_kink_near_by_the_direction_is_that_of_the_last_segment():
    """The first nodes behind a kink may pass for straight: they turned the tip by as much as faces may bend."""
    part = Part.plate(20.0, 20.0, cracks=[[(4.0, 10.0), (9.0, 10.0), (12.0, 11.3)]])
    loading = plate_loading(20.0, 20.0, stress=1.0)
    model = PlateModel(plate_mesh(part), Material.from_name("PMMA"), loading)
    tips = crack_tip_loading(model.results)
    angle = sorted(tips.angle.values % 360)
    assert angle == pytest.approx([np.degrees(np.arctan2(1.3, 3.0)), 180.0], abs=1e-6)
