"""The meta-model: interpolation, positive semi-definite, refusals; the unbounded release against known values."""

import numpy as np
import pytest

from slmm.initiation.cells import select_modes
from slmm.initiation.contact import tip_opening
from slmm.initiation.meta_model import (
    interpolate_poisson,
    load_meta_model,
    polynomial_matrix,
)
from slmm.running.cell_file import read_cells, shipped_database
from slmm.running.model_file import DatabaseError, checksum


@pytest.fixture(scope="module")
def cells():
    return read_cells(shipped_database()).dataset()


@pytest.fixture(scope="module")
def meta():
    return load_meta_model(0.35)


@pytest.mark.parametrize("nu", [-0.85, -0.3, 0.2, 0.35, 0.7, 0.97])
def test_psi_is_positive_semidefinite_between_the_stored_cells(nu):
    meta = load_meta_model(nu)
    rng = np.random.default_rng(0)
    Psi = meta.stiffness_loss(rng.uniform(meta.curvature[0], meta.curvature[-1], 40))
    values = np.linalg.eigvalsh(Psi)
    assert values.min() >= -1e-12 * values.max()


def test_stored_ratios_are_reproduced_by_the_interpolation(cells):
    # leaving out nothing: at a stored ratio the interpolation must return what is stored
    from slmm.initiation.meta_model import _between

    j = 5
    nu = float(cells.poisson[j])
    symmetric = (cells.mode_p % 2 == 1).values == (cells.mode_direction == 0).values
    K0, Psi, stress = _between(cells.poisson.values, cells.K.values, cells.stress.values, nu, symmetric)
    stored = cells.K.values[:, j]
    np.testing.assert_allclose(K0, stored[:, 0], atol=1e-6 * np.abs(stored).max())
    np.testing.assert_allclose(Psi, stored[:, :1] - stored[:, 1:], atol=1e-6 * np.abs(stored).max())
    np.testing.assert_allclose(stress, cells.stress.values[:, j], atol=1e-5 * np.abs(cells.stress).max())


def test_rigid_rotation_costs_nothing(meta):
    turn = np.array(
        [(d == 0 and (p, q) == (0, 1)) - (d == 1 and (p, q) == (1, 0)) for d, p, q in meta.powers.tolist()],
        float,
    )
    c = np.array([-0.55, 0.13])
    assert np.abs(meta.stiffness(c) @ turn).max() < 1e-5
    assert np.abs(meta.path_stress(c, np.tile(turn, (2, 1)))).max() < 1e-5


def test_uniform_tension_along_a_straight_edge(meta):
    """u = (xi, -nu eta) in a cell without curvature is uniaxial tension; its release is that of the half plane."""
    modes = np.array(
        [
            1.0 * (d == 0 and (p, q) == (1, 0)) - 0.35 * (d == 1 and (p, q) == (0, 1))
            for d, p, q in meta.powers.tolist()
        ]
    )[None]
    stress = meta.path_stress(np.zeros(1), modes)
    # what is left is the interpolation between Poisson's ratios
    np.testing.assert_allclose(stress[0, 0], 1.0, rtol=1e-4)
    np.testing.assert_allclose(stress[0, 1:], 0.0, atol=1e-4)
    G, work = meta.unbounded_release(np.zeros(1), stress)
    # energy K^2/E integrated: 1.12152^2 pi a^2/2, over a
    np.testing.assert_allclose(G[0], 1.12152**2 * np.pi * meta.lengths / 2, rtol=1e-3)
    # constant traction does positive work on the opening, which is open up to the tip
    assert np.all(work[..., 0] > 0) and np.all(tip_opening(work) > 0)


def test_release_in_an_unbounded_plate_with_a_hole(meta):
    """Kirsch's stress on the path, K of one crack at a circular hole (high order, 1e-4)."""
    ratio = np.array([0.0, 0.01, 0.1, 0.2, 0.5, 1.0, 2.0])
    F = np.array([1.12152 * 3, 3.2932, 2.7727, 2.3746, 1.7279, 1.3061, 1.0307])
    from scipy.interpolate import CubicSpline

    factor = CubicSpline(ratio / (1 + ratio), np.log(F))
    for c in (-0.5, -0.35, -0.25):  # 0.35 and 0.25 lie between the stored curvatures
        radius = -0.5 / c
        x = 1 + meta.eta / radius
        stress = np.zeros((1, 3, len(meta.eta)))
        stress[0, 0] = 1 + 0.5 / x**2 + 1.5 / x**4
        G, _ = meta.unbounded_release(np.array([c]), stress)
        for a, ours in zip(meta.lengths, G[0], strict=True):
            L = np.linspace(0, a / radius, 2001)
            K2 = np.exp(2 * factor(L / (1 + L))) * np.pi * L
            expected = np.sum(0.5 * (K2[1:] + K2[:-1]) * np.diff(L)) / (a / radius) * radius
            assert ours == pytest.approx(expected, rel=2e-3), (c, a)


def test_modes_of_the_paper_are_selectable(meta):
    assert len(select_modes(meta, "important").powers) == 5
    assert len(select_modes(meta, "published").powers) == 16
    assert len(select_modes(meta, "all").powers) == 22
    with pytest.raises(ValueError, match="important"):
        select_modes(meta, "five")


def test_poissons_ratios_beyond_the_table_are_refused_with_a_way_out():
    with pytest.raises(DatabaseError, match=r"slmm-precompute --poisson -0\.95"):
        load_meta_model(-0.95)


def test_a_table_of_one_ratio_serves_that_ratio_only(cells):
    single = cells.isel(poisson=[6]).copy()
    single.attrs["checksum"] = checksum(single)
    nu = float(single.poisson[0])
    assert interpolate_poisson(single, nu).nu == nu
    with pytest.raises(DatabaseError, match="holds the effective"):
        interpolate_poisson(single, nu + 0.05)


def test_cells_of_another_length_are_refused(cells):
    longer = cells.assign(right_edge=cells.right_edge + 0.5)
    with pytest.raises(DatabaseError, match="2 mm long"):
        interpolate_poisson(longer, 0.35)


def test_polynomial_matrix_is_exact_for_polynomials():
    nodes = np.cos(np.pi * np.arange(9) / 8)[::-1] + 3
    at = np.linspace(2, 4, 20)
    np.testing.assert_allclose(polynomial_matrix(nodes, at) @ nodes**8, at**8, rtol=1e-10)
