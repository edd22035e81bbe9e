"""Slits: every face has nodes of its own, tips stay whole, and nothing else changes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay, cKDTree

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.slit import open_slits, split_vertices
from slmm.part import shapes
from slmm.part.outline import Outline
from slmm.part.part import Part

pytest.importorskip("netgen")


def triangulation(n, seed=0):
    """Points (n, 2) and counter-clockwise triangles of the unit square."""
    random = np.random.default_rng(seed)
    points = np.concatenate([random.uniform(0.05, 0.95, (n - 4, 2)), [[0, 0], [1, 0], [1, 1], [0, 1]]])
    triangles = Delaunay(points).simplices.astype(np.int64)
    a, b, c = points[triangles].swapaxes(0, 1)
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    return points, triangles


def edges_of(triangles):
    """Edges (e, 2) as ascending pairs, and how many triangles each belongs to."""
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return np.unique(pairs, axis=0, return_counts=True)


POINTS, TRIANGLES = triangulation(40)
EDGES, OF_TRIANGLES = edges_of(TRIANGLES)
INNER = EDGES[OF_TRIANGLES == 2]
ON_BOUNDARY = np.unique(EDGES[OF_TRIANGLES == 1])


@given(chosen=st.lists(st.integers(0, len(INNER) - 1), max_size=30, unique=True))
def test_a_vertex_has_as_many_copies_as_sectors_around_it(chosen):
    """Whatever slits cross, branch or turn back: n of them cut an inner vertex in n, one on the boundary in n + 1."""
    slits = INNER[chosen]
    triangles, origin = split_vertices(TRIANGLES, slits, len(POINTS))
    at = np.bincount(slits.ravel(), minlength=len(POINTS))
    sectors = np.maximum(at, 1)
    sectors[ON_BOUNDARY] = at[ON_BOUNDARY] + 1
    assert np.array_equal(np.bincount(origin, minlength=len(POINTS)), sectors)
    assert np.array_equal(origin[: len(POINTS)], np.arange(len(POINTS)))
    assert np.array_equal(origin[triangles], TRIANGLES)
    # every copy is used
    assert np.array_equal(np.unique(triangles), np.arange(len(origin)))


@given(chosen=st.lists(st.integers(0, len(INNER) - 1), max_size=30, unique=True))
def test_only_slits_become_boundary_and_each_has_two_faces(chosen):
    slits = INNER[chosen]
    triangles, origin = split_vertices(TRIANGLES, slits, len(POINTS))
    edges, count = edges_of(triangles)
    n = len(POINTS)
    key, slit_key, old_key = (np.sort(e, axis=1) @ [n, 1] for e in (origin[edges], slits, EDGES))
    # an edge alone inside the material has two tips and cannot open
    opens = (np.bincount(origin, minlength=n)[slits] > 1).any(axis=1)
    is_face = np.isin(key, slit_key[opens])
    assert np.array_equal(np.sort(key[is_face]), np.sort(np.repeat(slit_key[opens], 2)))
    assert np.all(count[is_face] == 1)
    assert np.array_equal(np.sort(key[~is_face]), np.setdiff1d(old_key, slit_key[opens]))
    assert (count == 1).sum() == (OF_TRIANGLES == 1).sum() + 2 * opens.sum()


def test_a_cross_a_branch_and_a_kink_by_hand():
    """Four triangles around the middle of a square: a slit all through cuts it in two."""
    square = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    copies = [
        np.bincount(split_vertices(square, np.array(slits), 5)[1]).tolist()
        for slits in (
            [[0, 4], [4, 2]],
            [[0, 4], [4, 1]],
            [[0, 4], [4, 2], [4, 1]],
            [[0, 4], [1, 4], [2, 4], [3, 4]],
        )
    ]
    assert copies == [[2, 1, 2, 1, 2], [2, 2, 1, 1, 2], [2, 2, 2, 1, 3], [2, 2, 2, 2, 4]]


@pytest.fixture(scope="module")
def opened():
    """A plate with a hole, a kinked crack from its edge, another from the hole, and a path from that one's tip."""
    outline = Outline.through(shapes.circle((50, 40), 15.0))
    cracks = [
        np.array([[0.0, 40.0], [10.0, 40.0], [18.0, 48.0]]),
        np.array([[65.0, 40.0], [70.0, 40.0]]),
    ]
    # a crack's tip has elements of a thousandth of its length: the path goes on with such
    depth = np.concatenate([[0.0], 0.005 * np.cumsum(1.25 ** np.arange(25))])
    path = np.array([70.0, 40.0]) + depth[:, None] * [0.8, 0.6]
    mesh = plate_mesh(Part.plate(100.0, 80.0, [outline], cracks=cracks), path)
    return mesh, open_slits(mesh)


def areas(points, triangles):
    a, b, c = points[triangles].swapaxes(0, 1)
    return 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def test_areas_are_unchanged(opened):
    mesh, slit = opened
    assert areas(slit.mesh.p.T, slit.mesh.t.T) == pytest.approx(areas(mesh.vertices, mesh.triangles))


def test_faces_of_the_path_pair_up_node_by_node_from_the_mouth_inwards(opened):
    mesh, slit = opened
    points = slit.mesh.doflocs.T
    right, left = points[slit.right], points[slit.left]
    assert len(right) == 2 * (len(mesh.path) - 1)
    assert np.array_equal(right, left)
    assert not np.intersect1d(slit.right, slit.left).size
    line = mesh.vertices[mesh.path]
    assert np.array_equal(right[::2], line[:-1])
    assert right[1::2] == pytest.approx((line[1:] + line[:-1]) / 2)


def test_faces_lie_on_their_sides(opened):
    slit = opened[1]
    nodes = np.concatenate([slit.mesh.t, slit.mesh.nvertices + slit.mesh.t2f[:3]]).T
    middle = slit.mesh.p[:, slit.mesh.t].mean(axis=1).T
    along = np.array([0.8, 0.6])
    for face, side in ((slit.right, -1), (slit.left, 1)):
        # a midside node belongs to one element, an inner corner to several on the same side of the path
        for node in face[2:]:
            offset = middle[np.any(nodes == node, axis=1)] - slit.mesh.doflocs.T[node]
            assert np.all(side * (along[0] * offset[:, 1] - along[1] * offset[:, 0]) > 0)


def test_tips_stay_single_and_everything_behind_them_is_double(opened):
    mesh, slit = opened
    copies = np.bincount(slit.origin, minlength=len(mesh.vertices))
    first, second = mesh.cracks
    assert copies[first[-1]] == 1 and np.all(copies[first[:-1]] == 2)
    # the second crack's tip is the mouth of the path
    assert second[-1] == mesh.path[0]
    assert np.all(copies[second] == 2) and np.all(copies[mesh.path[:-1]] == 2)
    assert copies[mesh.path[-1]] == 1
    assert copies.sum() == len(mesh.vertices) + 2 + len(first) - 3 + len(second) + len(mesh.path) - 2


def test_curved_edges_keep_their_midside_nodes_on_the_curve(opened):
    mesh, slit = opened
    centre = np.array([50, 40])
    nodes = slit.mesh.doflocs.T
    wanted = mesh.edge_midpoints()
    assert cKDTree(nodes).query(wanted)[0].max() < 1e-12
    # and there is no second one on the chord
    chord = mesh.vertices[mesh.edges].mean(axis=1)
    assert (
        cKDTree(nodes).query(chord)[0].min() > 0.5 * (15 - np.linalg.norm(chord - centre, axis=1)).min() > 0
    )
    # all others lie half way between their ends
    straight = slit.mesh.p[:, slit.mesh.facets].mean(axis=1).T
    moved = np.linalg.norm(nodes[slit.mesh.nvertices :] - straight, axis=1) > 1e-12
    assert moved.sum() == len(mesh.edges)


def test_a_path_from_a_sharp_corner():
    outline = Outline.of_pieces(shapes.polygon([[30, 30], [70, 30], [70, 50], [30, 50]]))
    depth = np.concatenate([[0.0], 0.02 * np.cumsum(1.25 ** np.arange(15))])
    path = np.array([70.0, 50.0]) + depth[:, None] * [0.6, 0.8]
    mesh = plate_mesh(Part.plate(100.0, 80.0, [outline]), path)
    slit = open_slits(mesh)
    assert np.bincount(slit.origin)[mesh.path].tolist() == [2] * (len(path) - 1) + [1]
    assert slit.mesh.doflocs.T[slit.right[0]] == pytest.approx([70.0, 50.0])


def test_without_slits_the_mesh_is_what_it_was():
    mesh = plate_mesh(Part.plate(10.0, 8.0), policy=SizePolicy(largest=2.0))
    slit = open_slits(mesh)
    assert np.array_equal(slit.mesh.p.T[: len(mesh.vertices)], mesh.vertices)
    assert np.array_equal(slit.mesh.t.T, np.sort(mesh.triangles, axis=1))
    assert len(slit.right) == len(slit.left) == 0
