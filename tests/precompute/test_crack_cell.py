import numpy as np
import pytest
import scipy.sparse.linalg as spla
import skfem
from skfem.helpers import ddot, eye, sym_grad, trace

from precompute.crack_cell import HALF_HEIGHT, LENGTH, CellResult, cell_body, right_edge, solve_cell
from precompute.grading import Fineness, crack_line, graded
from precompute.modes import complete_modes, published_modes

LENGTHS = np.array([0.1, 0.25, 0.6, 1.0])
ETA = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 8)
COARSE = Fineness(tip=0.05, growth=2.0, coarsest=0.25)
PUBLISHED = published_modes()


def amplitudes(modes=PUBLISHED, **values):
    """Vector of mode amplitudes, e.g. u10=1 for a displacement xi along xi."""
    names = [f"{'uv'[mode.direction]}{mode.p}{mode.q}" for mode in modes]
    m = np.zeros(len(modes))
    for name, value in values.items():
        m[names.index(name)] = value
    return m


def cell(curvature=0.0, nu=0.3, lengths=LENGTHS, modes=PUBLISHED, fineness=COARSE) -> CellResult:
    return solve_cell(curvature, nu, lengths, ETA, modes, fineness)


def loss(result):
    """Psi of every length."""
    return result.K[0] - result.K[1:]


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.95])
def test_uniaxial_stress_is_exact_in_a_flat_cell(nu):
    result = cell(0.0, nu)
    m = amplitudes(u10=1.0, v01=-nu)
    assert m @ result.K[0] @ m == pytest.approx(2 * HALF_HEIGHT * LENGTH, rel=1e-10)
    assert np.einsum("m,mce->ce", m, result.stress) == pytest.approx(
        np.array([1.0, 0.0, 0.0])[:, None] * np.ones(len(ETA)), abs=1e-10
    )


@pytest.mark.parametrize("curvature", [-1.0, -0.3, 0.5])
def test_no_strain_no_energy(curvature):
    result = cell(curvature)
    turned = amplitudes(u01=-1.0, v10=1.0)
    end = right_edge(curvature)
    # (1 - xi^2)(end - eta) and its multiple with eta vanish on the straight edges but for a translation
    repeated = amplitudes(u01=1.0, u20=end, u21=-1.0), amplitudes(v01=end, v02=-1.0, v21=-end, v22=1.0)
    scale = np.abs(result.K[0]).max()
    for m in (turned, *repeated):
        assert np.abs(result.K @ m).max() < 1e-10 * scale
        assert np.abs(np.einsum("m,mce->ce", m, result.stress)).max() < 1e-9


@pytest.mark.parametrize("curvature", [-1.0, 0.0, 0.5])
@pytest.mark.parametrize("nu", [-0.9, 0.3, 0.98])
def test_energy_released_is_positive_and_grows_with_the_crack(curvature, nu):
    Psi = loss(cell(curvature, nu))
    for step in np.diff(Psi, axis=0, prepend=0.0):
        values = np.linalg.eigvalsh(step)
        assert values[0] > -1e-10 * np.abs(values).max()
        assert values[-1] > 0
    assert np.linalg.eigvalsh(cell(curvature, nu).K[-1])[0] > -1e-10 * np.abs(Psi[-1]).max()


def test_symmetric_and_antisymmetric_modes_do_not_couple():
    symmetric = np.array([mode.symmetric for mode in PUBLISHED])
    result = cell(-0.4)
    assert np.all(result.K[:, symmetric][:, :, ~symmetric] == 0)
    assert np.all(result.stress[symmetric, 2] == 0)
    assert np.all(result.stress[~symmetric, :2] == 0)


@skfem.BilinearForm
def plane_stress(u, v, w):
    strain = sym_grad(u)
    stress = (w.nu / (1 - w.nu**2)) * eye(trace(strain), 2) + strain / (1 + w.nu)
    return ddot(stress, sym_grad(v))


def stiffness_with_a_slit(curvature, nu, a, modes):
    """The naive way: the whole cell, two nodes for one along the crack, one factorisation for one length."""
    end = right_edge(curvature)
    right = graded(HALF_HEIGHT, COARSE.tip * LENGTHS[0], np.inf, COARSE.growth, COARSE.coarsest)
    along = crack_line(LENGTHS, end, COARSE, COARSE.coarsest)
    half = skfem.MeshQuad.init_tensor(right, along)
    left = np.array([-half.p[0], half.p[1]])
    # the nodes ahead of the tip and the tip itself belong to both sides
    shared = (half.p[0] == 0) & (half.p[1] >= a * (1 - 1e-9))
    number = np.where(shared, np.arange(half.nvertices), half.nvertices + np.cumsum(~shared) - 1)
    points = np.concatenate([half.p, left[:, ~shared]], axis=1)
    whole = skfem.MeshQuad(points, np.concatenate([half.t, number[half.t][::-1]], axis=1))
    square = skfem.MeshQuad2.from_mesh(whole)
    xi, depth = square.doflocs
    eta = curvature * xi**2 + (end - curvature * xi**2) * depth / end
    basis = skfem.Basis(
        skfem.MeshQuad2(np.array([xi, eta]), square.t),
        skfem.ElementVector(skfem.ElementQuadS2()),
        intorder=3,
    )
    K = plane_stress.assemble(basis, nu=nu).tocsc()
    at = skfem.Basis(square, skfem.ElementVector(skfem.ElementQuadS2()), intorder=1).doflocs
    held = (np.abs(at[0]) > HALF_HEIGHT - 1e-9) | (at[1] > end - 1e-9)
    direction = np.zeros(basis.N, dtype=int)
    for dofs in (basis.nodal_dofs, basis.facet_dofs):
        direction[dofs[1::2]] = 1
    u = np.stack([held * (direction == mode.direction) * mode(*basis.doflocs) for mode in modes], axis=1)
    u[~held] = -spla.splu(K[~held][:, ~held]).solve((K @ u)[~held])
    return u.T @ (K @ u)


@pytest.mark.parametrize(("curvature", "nu"), [(-0.7, 0.3), (0.5, -0.4), (0.0, 0.9)])
def test_equal_to_one_factorisation_per_crack_length(curvature, nu):
    modes = complete_modes(3)
    result = cell(curvature, nu, modes=modes)
    naive = np.array([stiffness_with_a_slit(curvature, nu, a, modes) for a in (0.0, *LENGTHS)])
    assert np.abs(result.K - naive).max() < 1e-9 * np.abs(naive).max()
    for ours, theirs in zip(loss(result), naive[0] - naive[1:], strict=True):
        assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()


def test_more_crack_lengths_change_the_others_by_the_mesh_alone():
    few = cell(lengths=LENGTHS[[0, 2, 3]], fineness=Fineness(tip=0.01))
    many = cell(lengths=LENGTHS, fineness=Fineness(tip=0.01))
    m = amplitudes(u10=1.0, v01=-0.3)
    released = np.einsum("m,amn,n->a", m, loss(many), m)[[0, 2, 3]]
    assert np.einsum("m,amn,n->a", m, loss(few), m) == pytest.approx(released, rel=3e-3)


def test_short_cracks_scale_with_the_length_squared_and_reach_the_half_plane():
    lengths = np.array([0.02, 0.04, 0.08, 0.16])
    result = cell(0.0, lengths=lengths, fineness=Fineness(tip=0.005))
    m = amplitudes(u10=1.0, v01=-0.3)
    ratio = np.einsum("m,amn,n->a", m, loss(result), m) / lengths**2
    assert ratio[0] == pytest.approx(1.12152**2 * np.pi, rel=5e-3)  # edge crack in a half plane under 1 MPa
    assert ratio[1] == pytest.approx(ratio[0], rel=5e-3)


def test_error_of_the_released_energy_is_linear_in_the_tip_size():
    m = amplitudes(u10=1.0, v01=-0.3)
    coarse, middle, fine = (
        np.einsum("m,amn,n->a", m, loss(cell(0.0, fineness=Fineness(tip, 1.5, 0.1))), m)
        for tip in (0.04, 0.02, 0.01)
    )
    assert np.log2((middle - coarse) / (fine - middle)) == pytest.approx(1.0, abs=0.25)
    assert np.abs((fine - middle) / fine).max() < 0.01


def test_stress_at_a_hole_is_kirschs():
    """The stress field of a hole, prescribed on the edges as well as the modes can, returns on the path."""
    modes = [mode for mode in complete_modes(8) if mode.symmetric]
    curvature = -0.25
    body = cell_body(curvature, LENGTHS, COARSE)
    xi, eta = body.where[:, body.held]
    u = np.where(body.direction[body.held] == 0, *hole_displacement(xi, eta, 0.5 / -curvature, 0.3))
    basis = np.stack([(body.direction[body.held] == m.direction) * m(xi, eta) for m in modes], axis=1)
    m = np.linalg.lstsq(basis, u, rcond=None)[0]
    stress = np.einsum("m,mce->ce", m, cell(curvature, modes=modes, fineness=Fineness(0.02)).stress)
    q = 2.0 / (2.0 + ETA)
    # a parabola is not a circle: the cell's corners have another outline
    assert stress[0] == pytest.approx(1 + 0.5 * q**2 + 1.5 * q**4, rel=0.03)
    assert np.abs(stress[2]).max() < 1e-9


def hole_displacement(xi, eta, R, nu):
    """Kirsch's hole in an unbounded plate, E = 1, tension 1 along xi; the hole's centre lies at eta = -R."""
    r, t = np.hypot(xi, eta + R) / R, np.arctan2(eta + R, xi)
    kappa, shear = (3 - nu) / (1 + nu), 0.5 / (1 + nu)
    u = (r + 2 / r) * (kappa + 1) * np.cos(t) + (2 / r - 2 / r**3) * np.cos(3 * t)
    v = (r * (kappa - 3) + 2 / r * (1 - kappa)) * np.sin(t) + (2 / r - 2 / r**3) * np.sin(3 * t)
    return R / (8 * shear) * u, R / (8 * shear) * v
