"""Recovered stress: exact for linear stress on any mesh, of third order on curved ones, and never without a value."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fem.recovery import recovered_stress
from slmm.mechanics.stress import plane_stiffness_matrix
from slmm.part.part import Part
from slmm.scene import gallery

E, NU = 3000.0, 0.3
C = plane_stiffness_matrix(E, NU)


def grid(nx, ny, jitter, seed=0):
    """Vertices (n, 2) and triangles of a rectangle nx x ny, the diagonals at random, inner vertices moved."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(nx + 1.0), np.arange(ny + 1.0))
    points = np.column_stack([x.ravel(), y.ravel()])
    inner = (points > 0).all(axis=1) & (points < [nx, ny]).all(axis=1)
    points[inner] += jitter * random.uniform(-1, 1, (inner.sum(), 2))
    triangles = []
    for j in range(ny):
        for i in range(nx):
            a = j * (nx + 1) + i
            b, c, d = a + 1, a + nx + 2, a + nx + 1
            triangles += [[a, b, c], [a, c, d]] if random.random() < 0.5 else [[a, b, d], [b, c, d]]
    return points, np.array(triangles)


def quadratic(points, triangles):
    """Nodes (n, 2), elements (m, 6), and which nodes are vertices that elements surround."""
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, number, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    nodes = np.concatenate([points, points[edges].mean(axis=1)])
    interior = np.ones(len(nodes), dtype=bool)
    interior[edges[count == 1]] = False
    return nodes, np.concatenate([triangles, len(points) + number.reshape(-1, 3)], axis=1), interior


def recover(nx, ny, jitter, u, seed=0):
    nodes, elements, interior = quadratic(*grid(nx, ny, jitter, seed))
    return nodes, recovered_stress(nodes, elements, u(nodes), C, interior)


def field(coefficients):
    """Displacements (n, 2) that are quadratic, by coefficients (6, 2), and their stress (n, 3)."""

    def u(p):
        x, y = p.T
        return np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y]) @ coefficients

    def stress(p):
        x, y = p.T
        zero, one = np.zeros_like(x), np.ones_like(x)
        by_x = np.column_stack([zero, one, zero, 2 * x, y, zero]) @ coefficients
        by_y = np.column_stack([zero, zero, one, zero, x, 2 * y]) @ coefficients
        return np.column_stack([by_x[:, 0], by_y[:, 1], by_x[:, 1] + by_y[:, 0]]) @ C

    return u, stress


@given(
    coefficients=arrays(float, (6, 2), elements=st.floats(-1, 1, width=32)),
    jitter=st.floats(0.0, 0.3),
    seed=st.integers(0, 100),
)
def test_linear_stress_is_recovered_exactly_on_any_mesh(coefficients, jitter, seed):
    u, stress = field(coefficients)
    points, triangles = grid(4, 3, jitter, seed)
    nodes, elements, interior = quadratic(points, triangles)
    found = recovered_stress(nodes, elements, u(nodes), C, interior)
    # an element that fills a corner of the body has no surrounded vertex
    near = np.unique(elements[interior[triangles].any(axis=1)])
    assert len(near) > 0.75 * len(nodes)
    assert found[near] == pytest.approx(stress(nodes)[near], abs=1e-8 * E)


def test_rigid_motions_cause_no_stress():
    found = recover(4, 4, 0.2, lambda p: np.column_stack([0.3 - 0.01 * p[:, 1], 0.2 + 0.01 * p[:, 0]]))[1]
    assert np.abs(found).max() < 1e-9 * E


@pytest.mark.parametrize("ny", [1, 2])
def test_a_body_one_element_wide_has_a_stress_all_the_same(ny):
    """No vertex is surrounded: the elements' own stress, exact where it is constant."""
    u, stress = field(np.array([[0, 0], [0.1, 0.2], [0.3, -0.1], [0, 0], [0, 0], [0, 0]]))
    nodes, found = recover(6, ny, 0.0, u)
    assert found == pytest.approx(stress(nodes), abs=1e-9 * E)
    bent, stress = field(np.array([[0, 0], [0, 0], [0, 0], [0.05, 0.0], [0, 0.1], [0, 0]]))
    nodes, found = recover(6, ny, 0.0, bent)
    assert np.isfinite(found).all()
    scale = np.abs(stress(nodes)).max()
    assert np.abs(found - stress(nodes)).max() < (0.3 if ny == 1 else 0.15) * scale


def test_where_few_vertices_are_surrounded_the_others_take_their_polynomials():
    """Two rows of elements: the patches lie on one line, yet the field on either side is still exact."""
    u, stress = field(np.random.default_rng(1).uniform(-1, 1, (6, 2)))
    nodes, found = recover(8, 2, 0.1, u)
    # corners of the body belong to elements without a surrounded vertex
    near = (nodes[:, 0] > 0.9) & (nodes[:, 0] < 7.1)
    assert found[near] == pytest.approx(stress(nodes)[near], abs=1e-8 * E)


def test_stress_beside_kirschs_hole_converges_with_the_third_order():
    scene = gallery.circular_hole(1.0, 20.0, load={"stress": 1.0})
    (outline,) = scene.outlines
    mesh = plate_mesh(Part.plate(20.0, 20.0, [outline]), policy=SizePolicy(turn=0.4))
    angle = np.linspace(0, 2 * np.pi, 360, endpoint=False)
    surface, normal = outline.points(angle), outline.normals(angle)
    found = []
    for _ in range(4):
        model = PlateModel(mesh, scene.material, scene.loading)
        found.append([model.stress(surface), model.stress(surface + 0.5 * normal)])
        mesh = mesh.refined()
    change = np.sqrt(np.mean(np.square(np.diff(found, axis=0)), axis=(2, 3)))
    on_surface, inside = np.log2(change[:-1] / change[1:]).T
    assert inside == pytest.approx([3.0, 3.0], abs=0.45)
    # a boundary node takes the polynomials of its neighbours beyond their patches
    assert np.all(on_surface > 2.0)


def test_kirschs_stress_on_the_hole():
    scene = gallery.circular_hole(1.0, 100.0, load={"stress": 1.0})
    (outline,) = scene.outlines
    model = PlateModel(
        plate_mesh(Part.plate(100.0, 100.0, [outline]), policy=SizePolicy(turn=0.06)),
        scene.material,
        scene.loading,
    )
    angle = np.linspace(0, 2 * np.pi, 180, endpoint=False)
    xx, yy, xy = model.stress(outline.points(angle)).T
    tx, ty = outline.tangents(angle).T
    along = xx * tx**2 + yy * ty**2 + 2 * xy * tx * ty
    # an edge of 100 radii is far enough
    assert along == pytest.approx(1 + 2 * np.cos(2 * angle), abs=0.02)


def test_the_free_surface_is_free():
    """Nothing in the recovery knows the boundary conditions: what it leaves there is its error."""
    scene = gallery.circular_hole(10.0)
    (outline,) = scene.outlines
    model = PlateModel(plate_mesh(Part.plate(100.0, 100.0, [outline])), scene.material, scene.loading)
    s = np.linspace(0, outline.length, 100, endpoint=False)
    xx, yy, xy = model.stress(outline.points(s)).T
    (nx, ny), largest = outline.normals(s).T, np.abs(yy).max()
    assert np.abs(np.stack([xx * nx + xy * ny, xy * nx + yy * ny])).max() < 0.01 * largest


def test_faces_of_a_crack_share_no_patch():
    """Sheared faces slide: the stress along the one is the opposite of that along the other."""
    crack = [[0.0, 10.0], [10.0, 10.0]]
    scene = gallery.edge_crack(
        plate={"width": 40.0, "height": 20.0}, cracks=[{"points": crack}], load={"strain": [0.0, 0.0, 0.01]}
    )
    model = PlateModel(
        plate_mesh(Part.plate(40.0, 20.0, cracks=[np.array(crack)])), scene.material, scene.loading
    )
    x, y = model.points.T
    face = np.flatnonzero((np.abs(y - 10) < 1e-12) & (x < 9) & (x > 2))
    face = face[np.argsort(x[face], kind="stable")].reshape(-1, 2)
    assert np.array_equal(x[face[:, 0]], x[face[:, 1]])
    along = model.nodal_stress[face, 0]
    assert along[:, 0] == pytest.approx(-along[:, 1], abs=0.03 * np.abs(along).max())
    assert np.abs(along).max() > 50 * np.abs(model.nodal_stress[face, 1]).max()
