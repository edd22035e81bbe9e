"""The plate seen from its boundary: the same displacements and forces as the whole model, condensed or not."""

import itertools

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from slmm.fem.boundary_stiffness import BoundaryOfModel, BoundaryStiffness
from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.scene import gallery

pytest.importorskip("netgen")

KINDS = (BoundaryStiffness, BoundaryOfModel)
LOADS = {
    "strain": {"strain": [0.02, 0.1, 0.05]},
    "displacement": {"displacement": 1.0},
    "stress": {"stress": 7.0},
}


@pytest.fixture(scope="module", params=itertools.product([*LOADS, "cracked"], KINDS))
def plate(request):
    name, kind = request.param
    if name == "cracked":
        scene = gallery.edge_crack(load={"displacement": 0.1})
    else:
        scene = gallery.elliptic_hole(load=LOADS[name])
    mesh = plate_mesh(scene.part, policy=SizePolicy(largest=12.0))
    model = PlateModel(mesh, scene.material, scene.loading)
    return model, kind(model)


def sparse_solution(model, force, value):
    """Displacements and nodal forces (n, 2) under forces and prescribed displacements (n, 2)."""
    free = ~model.load.prescribed.ravel()
    u = np.where(free, 0.0, value.ravel())
    K = model.K.tocsc()
    u[free] = spsolve(K[free][:, free], (force.ravel() - K @ u)[free])
    return u.reshape(-1, 2), (K @ u).reshape(-1, 2)


def close(one, other):
    return one == pytest.approx(other, rel=1e-6, abs=1e-8 * np.abs(other).max())


def test_nodes_are_those_of_the_boundary_and_of_both_faces_of_cracks(plate):
    model, boundary = plate
    x, y = model.points[boundary.nodes].T
    width, height = model.points.max(axis=0)
    on_edge = (x == 0) | (x == width) | (y == 0) | (y == height)
    if height == 120:  # the cracked plate
        on_face = (np.abs(y - 60) < 1e-9) & (x <= 10)
        assert np.all(on_edge | on_face)
        tip = on_face & (x == 10)
        mouth_and_inner = np.unique(x[on_face & ~tip], return_counts=True)[1]
        assert tip.sum() == 1 and np.all(mouth_and_inner == 2)
    else:
        on_hole = ((x - 50) / 20) ** 2 + ((y - 50) / 10) ** 2
        assert np.abs(on_hole[~on_edge] - 1).max() < 1e-4
    assert len(np.unique(boundary.nodes)) == len(boundary.nodes)


def test_the_scenes_own_load_gives_the_models_displacements(plate):
    model, boundary = plate
    nodes = boundary.nodes
    u, f = boundary.response(model.load.force[nodes][..., None], model.load.value[nodes][..., None])
    assert close(u[..., 0], model.u[nodes])
    assert close(f[..., 0], (model.K @ model.u.ravel()).reshape(-1, 2)[nodes])


def test_any_load_on_the_boundary_gives_what_the_sparse_model_gives(plate):
    model, boundary = plate
    nodes = boundary.nodes
    random = np.random.default_rng(0)
    force, value = random.normal(size=(2, len(nodes), 2, 3))
    value *= 1e-3
    u, f = boundary.response(force, value)
    for k in range(3):
        whole_force, whole_value = np.zeros_like(model.points), np.zeros_like(model.points)
        whole_force[nodes], whole_value[nodes] = force[..., k], value[..., k]
        expected_u, expected_f = sparse_solution(model, whole_force, whole_value)
        assert close(u[..., k], expected_u[nodes])
        assert close(f[..., k], expected_f[nodes])


def test_what_is_prescribed_stays_and_what_is_free_carries_its_force(plate):
    model, boundary = plate
    held = model.load.prescribed[boundary.nodes]
    random = np.random.default_rng(1)
    force, value = random.normal(size=(2, *held.shape, 2))
    u, f = boundary.response(force, value)
    assert np.array_equal(u[held], value[held])
    assert np.array_equal(f[~held], force[~held])


def test_two_loads_do_the_same_work_on_each_others_displacements(plate):
    """Betti and Maxwell, with prescribed displacements among the loads."""
    boundary = plate[1]
    random = np.random.default_rng(2)
    force, value = random.normal(size=(2, len(boundary.nodes), 2, 2))
    u, f = boundary.response(force, 1e-3 * value)
    one_on_other = np.sum(f[..., 0] * u[..., 1])
    assert one_on_other == pytest.approx(np.sum(f[..., 1] * u[..., 0]), rel=1e-7)


def test_forces_balance_whatever_the_load(plate):
    model, boundary = plate
    force, value = np.random.default_rng(3).normal(size=(2, len(boundary.nodes), 2, 2))
    f = boundary.response(force, 1e-3 * value)[1]
    x, y = model.points[boundary.nodes].T
    size = np.abs(f).sum()
    assert np.abs(f.sum(axis=0)).max() < 1e-7 * size
    moment = np.einsum("b,bk->k", x, f[:, 1]) - np.einsum("b,bk->k", y, f[:, 0])
    assert np.abs(moment).max() < 1e-7 * size * np.abs(model.points).max()


def test_many_loads_at_once_are_each_as_alone(plate):
    boundary = plate[1]
    force, value = np.random.default_rng(4).normal(size=(2, len(boundary.nodes), 2, 5))
    together = boundary.response(force, value)
    for k in range(5):
        alone = boundary.response(force[..., k : k + 1], value[..., k : k + 1])
        for one, other in zip(together, alone, strict=True):
            assert close(one[..., k], other[..., 0])


@pytest.mark.parametrize("kind", KINDS)
def test_a_rigid_displacement_of_all_edges_needs_no_force(kind):
    scene = gallery.circular_hole()
    model = PlateModel(plate_mesh(scene.part, policy=SizePolicy(largest=12.0)), scene.material, scene.loading)
    boundary = kind(model)
    x, y = model.points[boundary.nodes].T
    motion = np.column_stack([0.3 - 0.01 * y, -0.2 + 0.01 * x])[..., None]
    u, f = boundary.response(np.zeros_like(motion), motion)
    assert u == pytest.approx(motion, abs=1e-9)
    assert np.abs(f).max() < 1e-8 * model.E
