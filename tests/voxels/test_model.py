import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from voxel_reference import assemble, load, solve_directly

from slmm.part.coverage import area_fraction
from slmm.part.shapes import circle
from slmm.voxels.element import coefficients, element_matrix, largest_eigenvalue
from slmm.voxels.model import NotConvergedError, NotHeldError, solve_voxels

LOADS = [load(strain=(0.01, 0.02, -0.03)), load(displacement=0.1), load(stress=10.0)]
NAMES = ["strain", "displacement", "stress"]
SIZES = [(16, 16), (17, 31), (45, 40), (64, 21), (2, 5), (33, 70)]


def with_void(holes, void):
    return void + (1 - void) * (1 - holes)


def difference(u, v):
    return np.abs(u - v).max() / np.abs(v).max()


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("loaded", LOADS, ids=NAMES)
def test_solid_plate_has_uniform_strain(size, loaded):
    nx, ny = size
    width, height, nu, E = 0.1 * nx, 0.11 * ny, 0.3, 2000.0
    u = solve_voxels(np.ones((ny, nx)), width, height, nu, loaded, E=E).u
    if loaded.strain is not None:
        e_xx, e_yy, g_xy = loaded.strain
    else:
        e_yy = loaded.stress / E if loaded.displacement is None else loaded.displacement / height
        e_xx, g_xy = -nu * e_yy, 0.0
    np.testing.assert_allclose(np.diff(u[..., 0], axis=1), e_xx * 0.1, atol=1e-8 * np.abs(u).max())
    np.testing.assert_allclose(np.diff(u[..., 1], axis=0), e_yy * 0.11, atol=1e-8 * np.abs(u).max())
    np.testing.assert_allclose(np.diff(u[..., 0], axis=0), g_xy / 2 * 0.11, atol=1e-8 * np.abs(u).max())


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("loaded", LOADS, ids=NAMES)
def test_equals_direct_solution_of_the_assembled_system(size, loaded):
    nx, ny = size
    stiffness = np.random.default_rng(nx).uniform(0.01, 1, (ny, nx))
    stiffness[[0, -1]] = 0.7  # a stress load has to be in equilibrium
    width, height, E = 0.1 * nx, 0.1 * ny, 1000.0
    u = solve_voxels(stiffness, width, height, 0.35, loaded, E=E, tol=1e-10).u
    assert difference(u, solve_directly(stiffness, width, height, 0.35, loaded, E)) < 1e-7


@settings(max_examples=15, deadline=None)
@given(
    nx=st.integers(2, 40),
    ny=st.integers(2, 40),
    seed=st.integers(0, 1000),
    exponent=st.floats(0, 4),
    nu=st.floats(-0.4, 0.49),
    which=st.sampled_from([0, 1]),
)
def test_equals_direct_solution_on_random_grids(nx, ny, seed, exponent, nu, which):
    stiffness = np.random.default_rng(seed).uniform(0.01, 1, (ny, nx)) ** exponent
    u = solve_voxels(stiffness, nx, ny, nu, LOADS[which], tol=1e-12, max_iterations=500).u
    assert difference(u, solve_directly(stiffness, nx, ny, nu, LOADS[which])) < 1e-6


def test_turned_and_mirrored_plates_move_alike():
    holes = area_fraction([circle((30, 55), 14), circle((70, 30), 9)], 100, 100, 77, 77)
    stiffness = with_void(holes, 1e-6)
    u = solve_voxels(stiffness, 100, 100, 0.3, load(strain=(0.01, 0.1, 0.02)), tol=1e-11).u
    turned = solve_voxels(stiffness.T, 100, 100, 0.3, load(strain=(0.1, 0.01, 0.02)), tol=1e-11).u
    assert difference(turned, np.transpose(u, (1, 0, 2))[..., ::-1]) < 1e-8
    mirrored = solve_voxels(stiffness[:, ::-1], 100, 100, 0.3, load(strain=(0.01, 0.1, -0.02)), tol=1e-11).u
    mirrored = mirrored[:, ::-1] * [-1, 1] + [
        1.0,
        1.0,
    ]  # the edges of the mirrored plate are shifted by (1, -1)
    assert difference(mirrored, u) < 1e-8


def test_scaling_the_plate_scales_displacements_and_E_divides_them():
    stiffness = with_void(area_fraction([circle((5, 5), 2)], 10, 10, 40, 40), 1e-6)
    u = solve_voxels(stiffness, 10, 10, 0.3, load(stress=5.0), E=100.0).u
    assert difference(solve_voxels(stiffness, 30, 30, 0.3, load(stress=5.0), E=100.0).u, 3 * u) < 1e-7
    assert difference(solve_voxels(stiffness, 10, 10, 0.3, load(stress=-5.0), E=200.0).u, -u / 2) < 1e-12


@pytest.mark.parametrize("loaded", LOADS, ids=NAMES)
@pytest.mark.parametrize("n", [100, 200, 333])
def test_circular_hole_takes_few_iterations_whatever_the_grid(n, loaded):
    stiffness = with_void(area_fraction([circle((50, 50), 20)], 100, 100, n, n), 1e-6)
    solution = solve_voxels(stiffness, 100, 100, 0.35, loaded)
    assert solution.iterations <= 13
    assert solution.converged and solution.residual <= 1e-8


@pytest.mark.parametrize("void", [1e-2, 1e-6, 1e-9])
def test_sixty_overlapping_holes(void):
    rng = np.random.default_rng(1)
    holes = [circle((rng.uniform(0, 100), rng.uniform(8, 92)), rng.uniform(2, 6)) for _ in range(60)]
    stiffness = with_void(area_fraction(holes, 100, 100, 300, 300), void)
    for loaded, limit in zip(LOADS, (25, 30, 35), strict=True):
        assert solve_voxels(stiffness, 100, 100, 0.35, loaded).iterations <= limit


def test_ligament_of_one_voxel_between_two_holes():
    holes = area_fraction([circle((29.75, 50.25), 20), circle((70.75, 50.25), 20)], 100, 100, 200, 200)
    assert solve_voxels(with_void(holes, 1e-9), 100, 100, 0.35, LOADS[0]).iterations <= 25


@pytest.mark.parametrize("nu", [0.95, 0.98])
@pytest.mark.parametrize("loaded", LOADS, ids=NAMES)
@pytest.mark.parametrize(("nx", "ny"), [(58, 325), (200, 150), (900, 20)])
def test_plates_that_hardly_change_their_area_converge_too(nx, ny, loaded, nu):
    rng = np.random.default_rng(nx)
    holes = [circle((rng.uniform(0, nx), rng.uniform(0.3, 0.7) * ny), 0.15 * min(nx, ny)) for _ in range(6)]
    stiffness = with_void(area_fraction(holes, nx, ny, nx, ny), 1e-6)
    solution = solve_voxels(stiffness, nx, ny, nu, loaded)
    assert solution.iterations <= 60
    if nx * ny < 20_000:
        assert difference(solution.u, solve_directly(stiffness, nx, ny, nu, loaded)) < 1e-4


@pytest.mark.parametrize("loaded", LOADS, ids=NAMES)
def test_a_large_plate_converges_without_overflow(loaded):
    holes = [circle((30, 40), 12), circle((70, 60), 8), circle((62, 59), 3)]
    stiffness = with_void(area_fraction(holes, 100, 100, 1100, 1300), 1e-6)
    solution = solve_voxels(stiffness, 100, 100, 0.35, loaded, E=1e3)
    assert solution.iterations <= 30 and solution.residual <= 1e-8


@pytest.mark.parametrize("E", [1e-27, 1e15, 1e33])
@pytest.mark.parametrize("larger", [1e-9, 1e9])
@pytest.mark.parametrize("loaded", [1e-9, 1e9])
def test_units_far_from_one_change_neither_iterations_nor_digits(E, larger, loaded):
    stiffness = with_void(area_fraction([circle((50, 50), 20)], 100, 100, 60, 60), 1e-6)
    reference = solve_voxels(stiffness, 100, 100, 0.35, load(stress=10.0), E=1e3)
    side, stress = 100 * larger, 10 * loaded
    scaled = solve_voxels(1e-5 * stiffness, side, side, 0.35, load(stress=stress), E=E)
    assert scaled.iterations == reference.iterations
    # the share of material that a stress pulls at is as small as the stiffness
    assert difference(scaled.u * (E / 1e3 / (larger * loaded)), reference.u) < 1e-5


def test_material_that_nothing_holds_is_refused():
    density = np.ones((60, 20))
    density[25:35] = 0.0
    with pytest.raises(NotHeldError, match=r"2 pieces .* 500 voxels"):
        solve_voxels(with_void(1 - density, 1e-9), 20, 60, 0.3, load(stress=10.0))


def test_stress_acts_on_the_material_of_a_cut_edge_only():
    stiffness = with_void(area_fraction([circle((50, 0), 15), circle((50, 100), 15)], 100, 100, 40, 40), 1e-6)
    u = solve_voxels(stiffness, 100, 100, 0.3, load(stress=10.0), E=1000.0, tol=1e-10).u
    assert difference(u, solve_directly(stiffness, 100, 100, 0.3, load(stress=10.0), 1000.0)) < 1e-7
    forces = (assemble(stiffness, 100, 100, 0.3) @ u.ravel()).reshape(u.shape) * 1000
    assert forces[-1, :, 1].sum() == pytest.approx(10 * 2.5 * stiffness[-1].sum())


def test_stress_out_of_equilibrium_is_refused():
    stiffness = with_void(area_fraction([circle((50, 100), 15)], 100, 100, 40, 40), 1e-6)
    with pytest.raises(ValueError, match="equilibrium"):
        solve_voxels(stiffness, 100, 100, 0.3, load(stress=10.0))


def test_same_bits_every_time():
    stiffness = with_void(area_fraction([circle((50, 50), 20)], 100, 100, 90, 90), 1e-6)
    first, second = (solve_voxels(stiffness, 100, 100, 0.35, LOADS[0]).u for _ in range(2))
    assert np.array_equal(first, second)


def test_giving_up_is_an_error():
    stiffness = with_void(area_fraction([circle((50, 50), 20)], 100, 100, 90, 90), 1e-6)
    with pytest.raises(NotConvergedError, match="after 2 iterations"):
        solve_voxels(stiffness, 100, 100, 0.35, LOADS[0], max_iterations=2)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stiffness": np.zeros((8, 8))}, "above 0"),
        ({"stiffness": np.full((8, 8), np.nan)}, "nan"),
        ({"stiffness": np.ones(8)}, "shape"),
        ({"width": -1.0}, "width = -1.0"),
        ({"nu": 1.2}, "nu = 1.2"),
        ({"load": load()}, "exactly one"),
        ({"load": load(stress=1.0, displacement=1.0)}, "exactly one"),
        ({"load": load(displacement=np.inf)}, "load.displacement = inf"),
    ],
)
def test_bad_input_is_named(changes, message):
    arguments = {"stiffness": np.ones((8, 8)), "width": 1.0, "height": 1.0, "nu": 0.3, "load": LOADS[0]}
    with pytest.raises(ValueError, match=message):
        solve_voxels(**{**arguments, **changes})


def test_no_load_no_displacement():
    assert not solve_voxels(np.ones((20, 20)), 1, 1, 0.3, load(strain=(0.0, 0.0, 0.0))).u.any()


def test_element_has_three_rigid_motions_and_the_energy_of_uniform_strain():
    hx, hy, nu = 0.7, 0.9, 0.3
    K = element_matrix(hx, hy, nu)
    np.testing.assert_allclose(K, K.T)
    assert np.sum(np.linalg.eigvalsh(K) < 1e-12) == 3
    stretched = np.array([0, 0, hx, 0, 0, 0, hx, 0])
    assert stretched @ K @ stretched == pytest.approx(hx * hy / (1 - nu**2))
    assert coefficients(hx, hy, nu)[0] == K[0, 0]


def test_eigenvalue_bound_holds_for_any_densities():
    stiffness = np.random.default_rng(0).uniform(1e-6, 1, (12, 9)) ** 3
    A = assemble(stiffness, 9, 12, 0.3).toarray()
    scale = 1 / np.sqrt(np.diag(A))
    assert np.linalg.eigvalsh(A * scale * scale[:, None])[-1] <= largest_eigenvalue(1, 1, 0.3)
