"""Parts with nodes of their own hang together again; the faces of a crack never do."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from slmm.fracture import crack_tip_loading
from slmm.fracture.configurational_forces import forces_within, nodal_configurational_forces
from slmm.mechanics.elasticity import Elasticity
from slmm.results.joined_nodes import joined, mean_of_joined
from slmm.results.mesh_step import mesh_displacements
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

DATA, CASES = Path(__file__).parents[1] / "data", Path(__file__).parents[3] / "shared" / "cases"
WHOLE, APART = CASES / "05-half-model" / "whole.vtu", CASES / "18-unshared-nodes" / "dg.vtu"
STEEL = Elasticity(210e3, 0.3)


def squares(n):
    """n x n squares, and displacements that bend."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    points = np.column_stack([x.ravel(), y.ravel()])
    number = np.arange(len(points)).reshape(n + 1, n + 1)
    corners = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1)
    u = 1e-3 * np.column_stack([points[:, 0] + 0.1 * points[:, 1] ** 2, points[:, 0] * points[:, 1]])
    return points, corners.reshape(-1, 4), u


def apart(points, nodes, u):
    """The same elements, each with nodes of its own."""
    return points[nodes].reshape(-1, 2), np.arange(nodes.size).reshape(nodes.shape), u[nodes].reshape(-1, 2)


def written(path, points, cells, u, **data):
    points, u = (np.pad(a, ((0, 0), (0, 1))) for a in (points, u))
    meshio.write_points_cells(path, points, cells, {"u": u} | data)
    return path


def loading(path):
    return crack_tip_loading(read_element_results(path, elasticity=STEEL))


def test_a_cracked_plate_of_separate_elements_is_the_plate():
    whole, again = loading(WHOLE), loading(APART)
    assert again.sizes["tip"] == whole.sizes["tip"] == 1
    for name in ("x", "y", "G", "K_I"):
        assert again[name].values == pytest.approx(whole[name].values, rel=1e-9)
    assert again.G.values == pytest.approx([23.68], rel=1e-3)
    a, b = (read_element_results(path, elasticity=STEEL) for path in (WHOLE, APART))
    assert a.points.shape == b.points.shape


def test_the_field_of_separate_elements_is_that_of_the_whole(tmp_path):
    plate = read_displacements(DATA / "plate.vtu")
    path = written(tmp_path / "apart.vtu", *apart_cells(plate))
    again = read_displacements(path)
    points = np.random.default_rng(0).uniform(-0.5, 20.5, (300, 2))
    assert again.displacement(points) == pytest.approx(plate.displacement(points), abs=1e-9)
    # the rim of the model is that of the part, and no longer every edge
    assert len(again._boundary.element) == len(plate._boundary.element)


def apart_cells(field):
    ((kind, nodes),) = field.cells.items()
    points, own, u = apart(field.points, nodes, field.u)
    return points, {kind: own}, u


@pytest.mark.parametrize("digits", [None, 6])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_digits_of_a_file_do_not_keep_nodes_apart(kind, digits):
    points, nodes, u = apart(*squares(5))
    u = u + 0.02  # a rigid motion beside the strains
    if digits:
        u = np.array([[float(f"{value:.{digits}g}") for value in row] for row in u])
    rng = np.random.default_rng(0)
    noise = np.finfo(kind).eps * rng.uniform(-1, 1, u.shape) * np.abs(u)
    cells, _ = joined(points.astype(kind).astype(float) * 3.7, {"quad": nodes}, u + noise)
    assert len(np.unique(cells["quad"])) == 36


def test_patches_of_elements_are_joined():
    # deal.II cuts each of its cells into patches whose nodes are shared among themselves alone
    points, nodes, u = squares(6)
    patch = (points[nodes].mean(axis=1) // 2) @ [1, 3]
    ids, own = np.unique(np.column_stack([np.repeat(patch, 4), nodes.ravel()]), axis=0, return_inverse=True)
    first = ids[:, 1].astype(int)
    cells, _ = joined(points[first], {"quad": own.reshape(-1, 4)}, u[first])
    assert len(first) == 81 and len(np.unique(cells["quad"])) == 49


def test_elements_of_several_kinds_are_joined():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [1, 0], [2, 0], [1, 1]], dtype=float)
    cells, _ = joined(
        points, {"quad": np.array([[0, 1, 2, 3]]), "triangle": np.array([[4, 5, 6]])}, 0.1 * points
    )
    assert cells["triangle"].tolist() == [[1, 5, 2]]


def test_the_faces_of_a_crack_stay_apart_even_when_they_move_as_one():
    points, nodes, u = squares(4)
    # a slit along y = 2 up to x = 2, closed
    slit = np.flatnonzero((points[:, 1] == 2) & (points[:, 0] < 2))
    upper = points[nodes].mean(axis=1)[:, 1] > 2
    nodes[upper] = np.select(
        [nodes[upper] == k for k in slit], len(points) + np.arange(len(slit)), nodes[upper]
    )
    points, u = np.concatenate([points, points[slit]]), np.concatenate([u, u[slit]])
    cells, node = joined(points, {"quad": nodes}, u)
    assert np.array_equal(cells["quad"], nodes) and np.array_equal(node, np.arange(len(points)))


def test_a_crack_between_parts_stays_where_it_is_open():
    points, nodes, u = squares(4)
    points, nodes, u = apart(points, nodes, u)
    upper = np.repeat(points[nodes].mean(axis=1)[:, 1] > 2, 4)
    u[upper & (points[:, 1] == 2) & (points[:, 0] < 2), 1] += 1e-5
    cells, _ = joined(points, {"quad": nodes}, u)
    assert len(np.unique(cells["quad"])) == 25 + 2


def test_parts_that_do_not_touch_are_parts():
    points, nodes, u = squares(2)
    cells, _ = joined(
        np.concatenate([points, points + np.array([5, 0])]),
        {"quad": np.concatenate([nodes, nodes + len(points)])},
        np.concatenate([u, u]),
    )
    assert len(np.unique(cells["quad"])) == 18


@pytest.mark.parametrize("n", [2, 6])
def test_displacements_that_jump_from_element_to_element_are_refused(n, tmp_path):
    points, nodes, u = apart(*squares(n))
    u = u + np.repeat(1e-5 * np.random.default_rng(0).standard_normal((n * n, 2)), 4, axis=0)
    path = written(tmp_path / "dg.vtu", points, {"quad": nodes}, u)
    for read in (read_displacements, lambda path: read_element_results(path, elasticity=STEEL)):
        with pytest.raises(
            ValueError, match=r"dg\.vtu: elements share no nodes, and their displacements jump by up to"
        ):
            read(path)


def test_a_strip_whose_displacements_jump_is_refused():
    points, nodes, u = apart(*(a for a in squares(4)))
    row = slice(0, 4)  # four squares in a row
    with pytest.raises(ValueError, match="jump by up to"):
        joined(points[:16], {"quad": nodes[row]}, u[:16] + np.repeat(np.arange(4.0), 4)[:, None])


def test_a_plate_in_two_parts_that_slide_is_two_parts():
    points, nodes, u = squares(4)
    upper = points[nodes].mean(axis=1)[:, 1] > 2
    nodes[upper] += len(points)
    both, moved = np.concatenate([points, points]), np.concatenate([u, u + np.array([1e-4, 0])])
    cells, _ = joined(both, {"quad": nodes}, moved)
    assert np.array_equal(cells["quad"], nodes)


def test_nodal_stresses_of_nodes_that_are_one_become_their_mean(tmp_path):
    points, nodes, u = apart(*squares(1))
    points, nodes = np.concatenate([points, points + np.array([1, 0])]), np.concatenate([nodes, nodes + 4])
    u = 1e-3 * points
    stress = np.repeat([[1.0, 0, 0, 0, 0, 0], [3.0, 0, 0, 0, 0, 0]], 4, axis=0)
    path = written(tmp_path / "two.vtu", points, {"quad": nodes}, u, stress=stress, energy=np.ones(8))
    step = mesh_displacements(path, -1)
    assert sorted(step.mesh.point_data["stress"][:, 0].tolist()) == [1, 1, 2, 2, 2, 2, 3, 3]
    results = read_element_results(path)
    assert results.stress["CPE4"][:, :, 0, 0].mean() == pytest.approx(2)
    values = np.arange(6.0).reshape(3, 2)
    assert mean_of_joined(values, np.array([0, 0, 2])).tolist() == [[1, 2], [1, 2], [4, 5]]


def test_forces_of_separate_elements_are_those_of_the_whole():
    forces = []
    for path in (WHOLE, APART):
        r = read_element_results(path, elasticity=STEEL)
        nodal = nodal_configurational_forces(r.points, r.cells, r.u, r.stress, r.energy, r.method)
        forces.append(forces_within(r.points, nodal, [20, 20], [4, 8]))
    assert forces[1] == pytest.approx(forces[0], rel=1e-9, abs=1e-9)
