"""Voxels for parts: uniform stress, Lamé's ring, turned parts, what holds them, and how errors fall."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from voxel_reference import assemble

from slmm.initiation.raster import grid_size
from slmm.scene.scene import Scene
from slmm.voxels.grid import VoxelGrid
from slmm.voxels.part_load import part_load
from slmm.voxels.part_model import PartVoxels

VOID = 1e-6
PMMA = {"name": "PMMA"}


def solved(scene, voxels, tol=1e-9):
    part, (E, nu) = scene.part, scene.material.plane_stress_equivalent
    (left, bottom), (right, top) = part.box.tolist()
    nx, ny = grid_size(right - left, top - bottom, voxels)
    grid = VoxelGrid((left, bottom), (right - left) / nx, (top - bottom) / ny, nx, ny)
    density = grid.density(part)
    load = part_load(part, scene.loading, grid, E)
    return (
        grid,
        density,
        load,
        PartVoxels(grid, VOID + (1 - VOID) * density, E, nu, load).solve(load, tol).u.reshape(-1, 2),
    )


def polygon(points, *boundary, **tables):
    outline = {"shape": "polygon", "points": points}
    return Scene.from_dict(
        {"part": {"outline": outline}, "material": PMMA, "boundary": [*boundary], **tables}
    )


def slanted(voxels):
    """A trapezium under all-round tractions of one uniform stress: strains in whole voxels off the exact one."""
    stress = np.array([[4.0, 1.0], [1.0, -2.0]])
    points = np.array([(0.0, 0.0), (31.0, 4.0), (26.0, 23.0), (-5.0, 17.0)])
    boundary = []
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        x, y = (b - a) / np.hypot(*(b - a))
        boundary.append({"from": a.tolist(), "to": b.tolist(), "traction": (stress @ [y, -x]).tolist()})
    scene = polygon(points.tolist(), *boundary)
    grid, density, _, u = solved(scene, voxels)
    u = u.reshape(grid.ny + 1, grid.nx + 1, 2)
    e_xx = 0.5 * (np.diff(u[1:, :, 0], axis=1) + np.diff(u[:-1, :, 0], axis=1)) / grid.hx
    E, nu = scene.material.plane_stress_equivalent
    exact = (stress[0, 0] - nu * stress[1, 1]) / E
    # an error at cut voxels fades within a few of them
    whole = density > 0.999
    deep = whole.copy()
    deep[3:-3, 3:-3] &= whole[:-6, 3:-3] & whole[6:, 3:-3] & whole[3:-3, :-6] & whole[3:-3, 6:]
    deep[[0, 1, 2, -3, -2, -1]] = False
    return np.sqrt(np.mean((e_xx[deep] / exact - 1) ** 2))


def test_a_part_with_slanted_edges_is_stretched_evenly():
    """The patch test, as far as cut voxels allow: a hundredth, and less with more voxels."""
    coarse, fine = slanted(2_000), slanted(32_000)
    assert coarse < 1e-2
    assert fine < 0.5 * coarse


def test_edges_along_the_grid_pass_the_patch_test():
    u_left = {"from": [0, 20], "to": [0, 0], "displacement": [0.0, "free"]}
    scene = polygon(
        [[0, 0], [30, 0], [30, 20], [0, 20]],
        u_left,
        {"from": [30, 0], "to": [30, 20], "traction": [6.0, 0.0]},
    )
    grid, _, load, u = solved(scene, 1_000)
    E, nu = scene.material.plane_stress_equivalent
    assert load.free.shape == (1, 3)  # along y
    np.testing.assert_allclose(u[:, 0], 6.0 / E * grid.nodes[:, 0], atol=1e-6 * np.abs(u).max())
    np.testing.assert_allclose(np.ptp(u[:, 1]), nu * 6.0 / E * 20.0, rtol=1e-6)


def ring(voxels):
    """Relative error of the widening of Lamé's ring under pressure inside, of nodes in the material."""
    a, b, p = 10.0, 20.0, 5.0
    scene = Scene.from_dict(
        {
            "part": {"outline": {"shape": "circle", "center": [3.0, 1.0], "radius": b}},
            "holes": [{"shape": "circle", "center": [3.0, 1.0], "radius": a}],
            "material": PMMA,
            "boundary": [{"on": "hole 0", "pressure": p}],
        }
    )
    grid, _, load, u = solved(scene, voxels)
    assert load.free.shape == (3, 3)
    out = grid.nodes - [3.0, 1.0]
    r = np.hypot(*out.T)
    inside = (r > a + 2 * grid.size) & (r < b - 2 * grid.size)
    radial = (u * out).sum(axis=1)[inside] / r[inside]
    E, nu = scene.material.plane_stress_equivalent
    A = p * a**2 / (b**2 - a**2)
    wanted = A / E * ((1 - nu) * r + (1 + nu) * b**2 / r)[inside]
    # a shift is free; it has no mean around the ring
    return abs(radial.mean() / wanted.mean() - 1)


def test_the_ring_of_lame():
    errors = [ring(n) for n in (4_000, 64_000)]
    assert errors[0] < 5e-3
    assert errors[1] < 0.5 * errors[0]


def lug(turned=0):
    """Held by a slanted edge, pulled by a pin, turned by right angles."""

    def placed(*points):
        z = np.array([complex(*point) for point in points]) * 1j**turned
        return np.column_stack([z.real, z.imag]).tolist()

    ((pull,),) = (placed((30.0, 12.0)),)
    a, b, c, d = placed((0, 0), (42, 0), (42, 22), (7, 22))
    (middle,) = placed((32.0, 11.0))
    return polygon(
        [a, b, c, d],
        {"from": d, "to": a, "displacement": [0.0, 0.0]},
        {"on": "hole 0", "traction": pull},
        holes=[{"shape": "circle", "center": middle, "radius": 6.0}],
    )


def test_turned_by_right_angles_it_moves_alike():
    grid, _, _, u = solved(lug(), 5_000, 1e-11)
    field = u.reshape(grid.ny + 1, grid.nx + 1, 2)
    for k in (1, 2):
        other, _, _, v = solved(lug(k), 5_000, 1e-11)
        z = (field[..., 0] + 1j * field[..., 1]) * 1j**k
        turned = np.rot90(z, -k)  # rows run upwards
        w = v.reshape(other.ny + 1, other.nx + 1, 2)
        # the void follows the material as well as 1e-6 of its stiffness tells
        assert np.abs(w[..., 0] + 1j * w[..., 1] - turned).max() < 1e-6 * np.abs(turned).max()


def test_equals_the_direct_solution_with_springs_and_held_nodes():
    scene = lug()
    grid, density, load, u = solved(scene, 600, 1e-11)
    E, nu = scene.material.plane_stress_equivalent
    A = E * assemble(VOID + (1 - VOID) * density, grid.nx * grid.hx, grid.ny * grid.hy, nu)
    n = 2 * len(load.force)
    for nodes, share, stiffness, _ in load.springs:
        for i in range(2):
            rows = np.repeat(np.arange(len(nodes)), 4), (2 * nodes + i).ravel()
            at = sp.csr_array((share.ravel(), rows), shape=(len(nodes), n))
            A = A + at.T @ sp.diags_array(stiffness[:, i]) @ at
    free = ~load.held.ravel()
    exact = np.zeros(n)
    exact[free] = splu(A.tocsr()[free][:, free].tocsc()).solve((load.force + load.pulls).ravel()[free])
    np.testing.assert_allclose(u.ravel(), exact, atol=1e-6 * np.abs(exact).max())


def test_what_is_held_aslant_gives_way_by_less_than_a_voxel_allows():
    """Springs: the slanted edge of a bar under tension moves by a thirtieth of a voxel's stretch, about."""
    scene = lug()
    _, _, load, u = solved(scene, 8_000)
    nodes, share, _, _ = load.springs[0]
    moved = np.abs(np.einsum("kn,kni->ki", share, u[nodes]))
    assert moved.max() < 0.02 * np.abs(u).max()


def test_a_crack_is_a_slot_that_ends_where_it_does():
    scene = polygon(
        [[0, 0], [20, 0], [20, 10], [0, 10]],
        {"from": [0, 10], "to": [0, 0], "displacement": [0.0, 0.0]},
        {"from": [20, 0], "to": [20, 10], "traction": [1.0, 0.0]},
        cracks=[{"points": [[10.25, 0.0], [10.25, 4.75]]}],
    )
    density = VoxelGrid((0.0, 0.0), 0.5, 0.5, 40, 20).density(scene.part)
    np.testing.assert_allclose(density[:11, 20], [0.0] * 9 + [0.5, 1.0], atol=1e-9)
    assert density.sum() == pytest.approx(800 - 9.5)


def test_along_a_line_of_the_grid_a_crack_takes_both_sides():
    scene = polygon(
        [[0, 0], [20, 0], [20, 10], [0, 10]],
        {"from": [0, 10], "to": [0, 0], "displacement": [0.0, 0.0]},
        {"from": [20, 0], "to": [20, 10], "traction": [1.0, 0.0]},
        cracks=[{"points": [[10.0, 0.0], [10.0, 5.0]]}],
    )
    density = VoxelGrid((0.0, 0.0), 0.5, 0.5, 40, 20).density(scene.part)
    assert (density[:10, 19:21] < 1e-9).all() and (density[10:] == 1).all()


def test_loads_that_do_not_balance_are_refused():
    scene = polygon(
        [[0, 0], [20, 0], [20, 10], [0, 10]],
        {"from": [0, 10], "to": [0, 0], "traction": [-1.0, 0.0]},
        {"from": [20, 0], "to": [20, 10], "traction": [1.0, 0.0]},
    )
    grid = VoxelGrid((0.0, 0.0), 1.0, 1.0, 20, 10)
    half = type(scene.loading)(scene.loading.conditions[:1])
    with pytest.raises(ValueError, match=r"does not balance: forces of \(-10, 0\) N"):
        part_load(scene.part, half, grid, 1.0)


def test_a_rigid_body_moves_as_by_boundary_integrals():
    from slmm.boundary.model import BoundaryModel

    scene = polygon(
        [[0, 0], [30, 5], [28, 18], [0, 18]],
        {"from": [0, 18], "to": [0, 0], "displacement": [0.0, 0.0]},
        {"from": [30, 5], "to": [28, 18], "stiff": True, "force": [200.0, -50.0], "moment": 300.0},
    )
    points = np.array([[20.0, 10.0], [26.0, 6.0], [27.0, 16.0], [10.0, 4.0]])
    exact = BoundaryModel(scene.part, scene.material, scene.loading).displacement(points)
    errors = []
    for step in (0.5, 0.25):
        grid = VoxelGrid((0.0, 0.0), step, step, round(30 / step), round(18 / step))
        part, (E, nu) = scene.part, scene.material.plane_stress_equivalent
        load = part_load(part, scene.loading, grid, E)
        assert len(load.bodies) == 3
        model = PartVoxels(grid, VOID + (1 - VOID) * grid.density(part), E, nu, load)
        nodes, share = grid.shares(points)
        u = np.einsum("kn,kni->ki", share, model.solve_bodies(load).u.reshape(-1, 2)[nodes])
        errors.append(np.abs(u - exact).max() / np.abs(exact).max())
    assert errors[0] < 1e-2
    assert errors[1] < 0.7 * errors[0]
