"""The nearest points: the same by all distances and by a tree, and the same when all is turned."""

import numpy as np
import pytest

from slmm.mechanics import nearest
from slmm.mechanics.nearest import Nearest

GENERATOR = np.random.default_rng(11)
AMONG, OF = GENERATOR.normal(size=(300, 2)), 2.0 * GENERATOR.normal(size=(80, 2))


@pytest.mark.parametrize("count", [1, 8])
def test_all_distances_and_a_tree_tell_the_same(count, monkeypatch):
    by_all = Nearest(AMONG).numbers(OF, count)
    monkeypatch.setattr(nearest, "PAIRS", 0)
    np.testing.assert_array_equal(by_all, Nearest(AMONG).numbers(OF, count))
    assert by_all.shape == (len(OF), count)


def test_the_nearest_comes_first_and_none_is_nearer():
    numbers = Nearest(AMONG).numbers(OF, 5)
    distance = np.linalg.norm(OF[:, None] - AMONG, axis=2)
    np.testing.assert_array_equal(np.take_along_axis(distance, numbers, 1), np.sort(distance, axis=1)[:, :5])


def test_turned_points_have_the_same_neighbours():
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    np.testing.assert_array_equal(
        Nearest(AMONG).numbers(OF, 3), Nearest(AMONG @ turn.T).numbers(OF @ turn.T, 3)
    )
