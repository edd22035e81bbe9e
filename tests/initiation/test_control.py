"""Bounds of the released energy and the weight between them, on matrices whose answer is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.initiation.control import (
    auto_weight,
    displacement_controlled,
    force_controlled_modes,
    mixed_release,
)


def random_cells(seed, n=3, lengths=4, m=5):
    """Stiffnesses K0 > K(a), all positive definite but for one rigid motion that they share."""
    rng = np.random.default_rng(seed)
    basis = np.linalg.qr(rng.normal(size=(m, m)))[0][:, 1:]
    A = rng.normal(size=(n, m - 1, m - 1))
    K0 = A @ A.swapaxes(1, 2) + 0.5 * np.eye(m - 1)
    L = np.linalg.cholesky(K0)
    loss = np.linspace(0.1, 0.6, lengths)[None, :, None, None] * (L @ L.swapaxes(1, 2))[:, None]
    return basis @ K0 @ basis.T, basis @ loss @ basis.T, rng.normal(size=(n, m)), np.arange(1.0, lengths + 1)


def test_force_control_keeps_the_reaction_forces():
    K0, Psi, modes, _ = random_cells(0)
    released = force_controlled_modes(K0, Psi, modes)
    forces = np.einsum("namk,nak->nam", K0[:, None] - Psi, released)
    np.testing.assert_allclose(forces, np.einsum("nmk,nk->nm", K0, modes)[:, None] + 0 * forces, atol=1e-9)


@given(seed=st.integers(0, 1000))
def test_release_grows_with_the_weight_from_held_to_released(seed):
    K0, Psi, modes, lengths = random_cells(seed)
    released = force_controlled_modes(K0, Psi, modes)
    q = mixed_release(Psi, modes, released, lengths)
    held = displacement_controlled(Psi, modes, lengths)
    np.testing.assert_allclose(q[0], held)
    np.testing.assert_allclose(q.sum(axis=0), displacement_controlled_at(Psi, released, lengths), rtol=1e-9)
    w = np.linspace(0, 1, 11)[:, None, None]
    values = q[0] + w * (q[1] + w * q[2])
    assert np.all(np.diff(values, axis=0) > -1e-9 * values.max())


def displacement_controlled_at(Psi, modes, lengths):
    return 0.5 * np.einsum("nam,namk,nak->na", modes, Psi, modes) / lengths


def test_weight_at_which_two_cells_agree():
    # 1 + 2 w against 2 + w: equal at 1; against 1.5 + w: equal at 0.5; quadratic: w^2 against 0.25
    small = np.array([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 1.0]])
    large = np.array([[2.0, 1.5, 0.25], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(auto_weight(small, large), [1.0, 0.5, 0.5])


def test_weight_stays_between_its_bounds_and_comes_as_near_as_it_can():
    small = np.array([[1.0, 1.0], [0.1, -0.1], [0.0, 0.0]])
    large = np.array([[2.0, 2.0], [0.0, 0.0], [0.0, 0.0]])
    np.testing.assert_allclose(auto_weight(small, large), [1.0, 0.0])


def test_cells_that_agree_anyway_need_no_relaxation():
    same = np.array([[1.0], [2.0], [3.0]])
    assert auto_weight(same, same)[0] == pytest.approx(0.0)


@given(c=st.lists(st.floats(-10, 10), min_size=6, max_size=6))
def test_no_weight_in_between_is_better(c):
    small, large = np.array(c[:3])[:, None], np.array(c[3:])[:, None]
    w = auto_weight(small, large)[0]
    d = (small - large)[:, 0]
    trial = np.linspace(0, 1, 201)
    difference = np.abs(d[0] + trial * (d[1] + trial * d[2]))
    assert abs(d[0] + w * (d[1] + w * d[2])) <= difference.min() + 1e-6 * (1 + np.abs(d).max())
