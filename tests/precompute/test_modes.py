import numpy as np
import pytest

from precompute.modes import Mode, complete_modes, published_modes


def test_published_modes_are_those_of_paper_a():
    modes = published_modes()
    assert len(modes) == 16
    assert {(m.p, m.q) for m in modes} == {(p, q) for p in range(3) for q in range(3)} - {(0, 0)}
    assert sum(m.direction == 0 for m in modes) == 8


@pytest.mark.parametrize("degree", range(2, 9))
def test_more_modes_begin_with_the_published_ones(degree):
    modes = complete_modes(degree)
    assert modes[:16] == published_modes()
    assert len(set(modes)) == len(modes)
    assert set(modes) <= set(complete_modes(degree + 1))


@pytest.mark.parametrize("mode", complete_modes(5), ids=lambda m: m.name)
def test_parity_is_that_of_the_mirror_image(mode):
    xi, eta = np.array([0.3, 0.7]), np.array([0.2, 1.1])
    mirror = -1 if mode.direction == 0 else 1  # reflection at xi = 0 turns the displacement along xi round
    assert np.allclose(mirror * mode(-xi, eta), mode(xi, eta) * (1 if mode.symmetric else -1))


@pytest.mark.parametrize("degree", [3, 4])
def test_complete_modes_span_all_polynomials_on_the_straight_edges(degree):
    t = np.linspace(-1, 1, 41)
    end = 1.7
    edges = np.concatenate(
        [[t, np.full(41, end)], [np.full(41, -1.0), t * end], [np.full(41, 1.0), t * end]], axis=1
    )
    along_xi = [m for m in complete_modes(degree) if m.direction == 0]
    basis = np.stack([m(*edges) for m in along_xi] + [np.ones(edges.shape[1])], axis=1)
    for p in range(degree + 1):
        for q in range(degree + 1 - p):
            wanted = Mode(0, p, q)(*edges)
            left = wanted - basis @ np.linalg.lstsq(basis, wanted, rcond=None)[0]
            assert np.abs(left).max() < 1e-10
