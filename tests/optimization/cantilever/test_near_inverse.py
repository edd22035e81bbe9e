"""The inverse near the diagonal is that of the whole stiffness matrix."""

import numpy as np
import pytest

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.near_inverse import NearInverse, places


def dense(beam, design):
    """Stiffness (n, n) and weight (n,), unknowns of the columns one after the other; without material: zeros."""
    place, on_left = places(beam.rows)
    m = 2 * (beam.rows + 1) + 2 * (2 * beam.rows + 1)
    # the line that is held comes first
    K, f = np.zeros(((beam.columns + 1) * m,) * 2), np.zeros((beam.columns + 1) * m)
    for row, column in np.argwhere(design):
        at = (column + 1 - on_left) * m + place[row]
        K[np.ix_(at, at)] += beam.cell[0]
        f[at] += beam.cell[1]
    return K[m:, m:], f[m:], m


@pytest.mark.parametrize("seed", range(4))
def test_blocks_are_those_of_the_dense_inverse(seed):
    beam = Cantilever(5, 4)
    rng = np.random.default_rng(seed)
    design = beam.repaired(beam.fixed | (rng.random(beam.shape) < 0.6))
    K, f, m = dense(beam, design)
    there = K.diagonal() > 0
    expected = np.zeros_like(K)
    expected[np.ix_(there, there)] = np.linalg.inv(K[np.ix_(there, there)])
    inverse = NearInverse(beam, design)
    inverse.extend(1)
    inverse.extend(3)
    assert inverse.near.shape == (4, 5, m, m)
    scale = np.abs(expected).max()
    for d in range(4):
        for c in range(d, 5):
            block = expected[c * m : (c + 1) * m, (c - d) * m : (c - d + 1) * m]
            np.testing.assert_allclose(inverse.near[d, c], block, atol=1e-10 * scale)
    np.testing.assert_allclose(
        inverse.displacements[..., 0].ravel(), expected @ f, atol=1e-9 * scale * f.max()
    )
    corner = 4 * m + inverse.corner
    np.testing.assert_allclose(inverse.displacements[..., 1].ravel(), expected[corner], atol=1e-10 * scale)


def test_a_design_that_is_loose_is_refused():
    loose = np.ones((3, 4), dtype=bool)
    loose[:, 2] = False
    with pytest.raises(ValueError, match="must be a valid design"):
        NearInverse(Cantilever(4, 3), loose)
