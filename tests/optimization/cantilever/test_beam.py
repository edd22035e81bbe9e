"""The benchmark problem: physics of the beam, and one value by two solvers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.optimization.cantilever.beam import HEIGHT, LENGTH, MATERIAL, WEIGHT, Cantilever


def random_designs(beam, n, seed=0):
    """Random cells beside the fixed ones, valid or not."""
    rng = np.random.default_rng(seed)
    return beam.fixed | (rng.random((n, beam.rows, beam.columns)) < 0.6)


def test_a_full_beam_sags_as_beam_theory_with_shear_says():
    """u = q L^4 / 8 E I + q L^2 / 2 k G A; the held edge and the grid matter little at L = 3 h."""
    q = WEIGHT * HEIGHT
    bending = q * LENGTH**4 / (8 * MATERIAL.E * HEIGHT**3 / 12)
    shear = q * LENGTH**2 / (2 * MATERIAL.mu * HEIGHT * 5 / 6)
    (u,) = Cantilever(48, 16).endpoint_displacement(np.ones((1, 16, 48), dtype=bool))
    assert u == pytest.approx(bending + shear, rel=0.02)


@pytest.mark.parametrize("grid", [(8, 5), (12, 6), (3, 2), (1, 4), (6, 1)])
def test_columns_eliminated_one_by_one_give_what_a_sparse_solve_gives(grid):
    beam = Cantilever(*grid)
    designs = random_designs(beam, 60)
    ours = beam.endpoint_displacement(designs)
    assert np.isfinite(ours).sum() > 3
    for design, u in zip(designs, ours, strict=True):
        assert u == pytest.approx(beam.solved_directly(design), rel=1e-9, nan_ok=True)


def test_what_hangs_on_nothing_is_not_valid():
    beam = Cantilever(6, 4)
    lonely = beam.fixed.copy()
    lonely[3, 4] = True
    corner = beam.fixed.copy()
    corner[2, 2] = True
    corner[1, 1] = True  # touches it at a corner only
    bare = np.zeros((4, 6), dtype=bool)
    assert beam.valid([lonely, corner, bare, beam.fixed]).tolist() == [False, False, False, True]
    assert np.isnan(beam.endpoint_displacement([lonely])[0])
    assert beam.valid(beam.repaired(lonely)[None])[0]
    assert not beam.repaired(lonely)[3, 4]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_repaired_designs_are_valid_and_only_lose_cells(seed):
    beam = Cantilever(7, 5)
    (design,) = random_designs(beam, 1, seed)
    repaired = beam.repaired(design)
    assert beam.valid(repaired[None])[0]
    assert not (repaired & ~design).any()
    if beam.valid(design[None])[0]:
        assert (repaired == design).all()


def test_a_cell_below_the_end_pulls_it_down():
    beam = Cantilever(8, 5)
    heavier = beam.fixed.copy()
    heavier[1, 7] = True
    lightest, pulled = beam.endpoint_displacement([beam.fixed, heavier])
    assert pulled > lightest > 0


def test_displacements_are_zero_where_held_and_unknown_where_nothing_is():
    beam = Cantilever(5, 3)
    u = beam.displacements(beam.fixed)
    assert u.shape == (7, 11, 2)
    assert (u[:, 0] == 0).all()
    assert np.isnan(u[-1, -1]).all()
    assert u[0, -1, 1] == pytest.approx(beam.endpoint_displacement(beam.fixed[None])[0], rel=1e-9)
    with pytest.raises(ValueError, match="must hang together"):
        beam.displacements(np.zeros((3, 5), dtype=bool))


@pytest.mark.parametrize(
    ("designs", "words"),
    [
        (np.ones((5, 8)), r"designs have the shape \(5, 8\): must be \(n, 5, 8\)"),
        (np.full((1, 5, 8), 0.5), "must be True or False, or 1 and 0"),
    ],
)
def test_other_shapes_and_values_are_refused(designs, words):
    with pytest.raises(ValueError, match=words):
        Cantilever(8, 5).endpoint_displacement(designs)


def test_grids_are_whole_numbers():
    with pytest.raises(ValueError, match="rows = 0: must be a whole number"):
        Cantilever(8, 0)
