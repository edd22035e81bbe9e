"""Iterations for many right-hand sides: exact solutions, and less to search for each that follows."""

import numpy as np
import pytest

from slmm.boundary.recycled import NotSolvedError, Recycled


def system(n=80, seed=0):
    rng = np.random.default_rng(seed)
    A = np.eye(n) + 0.4 * rng.normal(size=(n, n)) / np.sqrt(n)
    return A, Recycled(lambda x: A @ x, lambda r: r)


def test_solutions_are_those_of_a_direct_solver():
    A, ours = system()
    right = np.random.default_rng(1).normal(size=(80, 5))
    np.testing.assert_allclose(ours.solve(right), np.linalg.solve(A, right), atol=1e-8)
    np.testing.assert_allclose(ours.solve(right[:, 0]), np.linalg.solve(A, right[:, 0]), atol=1e-8)


def test_a_sum_of_what_was_solved_needs_no_search():
    A, ours = system()
    right = np.random.default_rng(1).normal(size=(80, 2))
    ours.solve(right)
    before = ours.searched
    np.testing.assert_allclose(
        ours.solve(right @ [2.0, -3.0]), np.linalg.solve(A, right @ [2.0, -3.0]), atol=1e-7
    )
    assert ours.searched <= before + 1


def test_a_right_hand_side_of_nothing_has_no_solution_but_nothing():
    _, ours = system()
    assert not ours.solve(np.zeros(80)).any()


def test_what_does_not_converge_is_said():
    turned = Recycled(lambda x: np.roll(x, 1), lambda r: r)
    with pytest.raises(NotSolvedError, match="the residual is"):
        turned.solve(np.eye(400)[0])
