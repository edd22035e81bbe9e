"""Laurent series of clusters against sums over all pairs."""

import numpy as np
import pytest

from slmm.boundary.far_field import Clusters


def scene(n, seed=0, stretched=1.0):
    rng = np.random.default_rng(seed)
    z, dz, h, d = (rng.normal(size=n) + 1j * rng.normal(size=n) for _ in range(4))
    return z.real * stretched + 1j * z.imag, dz, h, d


def by_pairs(z, dz, h, d, kappa):
    gap = z - z[:, None]
    np.fill_diagonal(gap, 1.0)
    C1, C3 = dz / gap, dz / gap.conj() - gap * dz.conj() / gap.conj() ** 2
    np.fill_diagonal(C1, 0.0)
    np.fill_diagonal(C3, 0.0)
    return kappa * C1 @ h + (C1 @ d).conj() + C3 @ h.conj()


@pytest.mark.parametrize(("n", "stretched"), [(30, 1.0), (700, 1.0), (700, 50.0)])
def test_sums_are_those_over_all_pairs(n, stretched):
    """What thirty terms leave out is 2^-30 of a cluster's largest part."""
    z, dz, h, d = scene(n, stretched=stretched)
    ours, exact = Clusters(z, dz).displacement(h, d, 2.1), by_pairs(z, dz, h, d, 2.1)
    assert np.abs(ours - exact).max() < 1e-8 * np.abs(exact).max()


def test_turning_and_moving_all_turns_the_sum():
    z, dz, h, d = scene(400)
    turn = np.exp(0.7j)
    moved = Clusters(z * turn + 30.0, dz * turn).displacement(h * turn, (d.conj() * turn).conj(), 2.1)
    np.testing.assert_allclose(moved, turn * Clusters(z, dz).displacement(h, d, 2.1), atol=1e-6)
