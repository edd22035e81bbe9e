"""Neighbours by a few unknowns are what direct solves find."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.optimization.algorithms.breadth_first import flips_within
from slmm.optimization.ask import Flipped
from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.neighbourhood_model import WIDEST, NeighbourhoodModel


def design_of(beam, seed, share=0.6):
    rng = np.random.default_rng(seed)
    return beam.repaired(beam.fixed | (rng.random(beam.shape) < share))


def compared(beam, design, flips):
    """Approximate values, their errors, and direct values of the valid ones."""
    designs = Flipped(design, flips)[:]
    valid = beam.valid(designs)
    assert valid.any()
    return *NeighbourhoodModel(beam, design).evaluate(flips[valid]), beam.endpoint_displacement(
        designs[valid]
    )


@pytest.mark.parametrize("grid", [(6, 4), (3, 3), (2, 5)])
@pytest.mark.parametrize("seed", range(3))
def test_all_single_and_double_flips_are_those_of_direct_solves(grid, seed):
    beam = Cantilever(*grid)
    design = design_of(beam, seed)
    free = np.flatnonzero(~beam.fixed.ravel())
    for k in (1, 2):
        ours, error, direct = compared(beam, design, np.array(list(combinations(free, k))))
        assert (np.abs(ours - direct) <= error).all()
        assert np.median(np.abs(ours / direct - 1)) < 1e-9
        assert np.median(error / np.abs(direct)) < 1e-7  # a model that knows nothing tells no such error


def test_the_centre_sags_as_it_does():
    beam = Cantilever(7, 4)
    design = design_of(beam, 5)
    (direct,) = beam.endpoint_displacement(design[None])
    assert NeighbourhoodModel(beam, design).sag == pytest.approx(direct, rel=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 12), st.integers(2, 6))
def test_cells_anywhere_may_be_flipped(seed, columns, rows):
    beam = Cantilever(columns, rows)
    design = design_of(beam, seed)
    free = np.flatnonzero(~beam.fixed.ravel())
    rng = np.random.default_rng(seed)
    k = min(len(free), 5)
    flips = np.array([rng.choice(free, k, replace=False) for _ in range(20)])
    designs = Flipped(design, flips)[:]
    valid = beam.valid(designs)
    ours, error = NeighbourhoodModel(beam, design).evaluate(flips[valid])
    direct = beam.endpoint_displacement(designs[valid])
    known = ~np.isnan(ours)
    off = np.abs(ours - direct)[known]
    assert (off <= error[known]).all()
    assert not known.any() or np.median(off / np.abs(direct[known])) < 1e-8


def test_of_cells_far_apart_nothing_is_known():
    beam = Cantilever(WIDEST + 4, 3)
    design = np.ones(beam.shape, dtype=bool)
    flips = np.array([[beam.columns + 1, 2 * beam.columns - 1]])
    ours, error, _ = compared(beam, design, flips)
    assert np.isnan(ours).all() and np.isnan(error).all()


def test_the_first_material_at_the_free_end_comes_and_the_last_goes():
    beam = Cantilever(6, 4)
    lightest = beam.fixed.copy()
    last = 2 * beam.columns - 1  # below the upper right cell
    grown = lightest.copy()
    grown.ravel()[last] = True
    (more,), _ = NeighbourhoodModel(beam, lightest).evaluate(np.array([[last]]))
    (less,), _ = NeighbourhoodModel(beam, grown).evaluate(np.array([[last]]))
    light, heavy = beam.endpoint_displacement([lightest, grown])
    assert more == pytest.approx(heavy, rel=1e-9)
    assert less == pytest.approx(light, rel=1e-9)


def test_of_a_coil_the_error_is_told():
    # a long coil hangs on the cell under the corner; without it the cell beside it holds it all
    beam = Cantilever(24, 12)
    design = beam.fixed.copy()
    design[2:, 23:3:-2] = True
    design[1, 23] = True
    design[11, 22:3:-4] = design[2, 20:3:-4] = True
    free = np.flatnonzero(~beam.fixed.ravel())
    flips = np.array([[a, b] for a, b in combinations(free, 2) if b - a in (1, 2, 23, 24, 25)])
    ours, error, direct = compared(beam, design, flips)
    assert (np.abs(ours - direct) <= error).all()
    assert error.max() > 1e3 * error.min()


def test_round_off_is_told_where_removed_cells_have_held_much():
    # of two removed cells one has held much of the rest, and the added one holds it now
    beam = Cantilever(6, 14)
    rows = "111111 100010 111010 101011 110001 101000 111101 100111 101001 111110 100101 111011 100101 111111"
    design = np.array([[cell == "1" for cell in row] for row in rows.split()])
    ours, error, direct = compared(beam, design, np.array([[23, 29, 35]]))
    assert beam.endpoint_displacement([design])[0] > direct[0]
    assert 1e-6 < abs(ours[0] - direct[0]) < error[0] < 0.01


def maze(beam, rng):
    """Paths that hardly meet, so that single cells hold much."""
    design = beam.fixed.copy()
    for _ in range(10):
        for i, j in rng.permutation(np.argwhere(~beam.fixed)):
            beside = np.pad(design, 1)
            if beside[i, j + 1] + 0 + beside[i + 2, j + 1] + beside[i + 1, j] + beside[i + 1, j + 2] == 1:
                design[i, j] = True
    return design


@pytest.mark.parametrize("grid", [(6, 14), (14, 6), (10, 10)])
def test_in_mazes_errors_are_told(grid):
    rng = np.random.default_rng(0)
    beam = Cantilever(*grid)
    design = maze(beam, rng)
    for depth in (1, 2, 3):
        flips = flips_within(~beam.fixed, depth, 2)
        ours, error, direct = compared(beam, design, rng.permutation(flips)[:500])
        assert (np.isnan(ours) | (np.abs(ours - direct) <= error)).all()
        assert np.isnan(ours).mean() < 0.01


def test_values_do_not_depend_on_what_was_asked_before():
    beam = Cantilever(12, 6)
    design = design_of(beam, 1)
    free = np.flatnonzero(~beam.fixed.ravel())
    flips = np.array([[a, b] for a, b in combinations(free, 2)])
    flips = flips[beam.valid(Flipped(design, flips)[:])]
    at_once, _ = NeighbourhoodModel(beam, design).evaluate(flips)
    model = NeighbourhoodModel(beam, design)
    backwards = np.concatenate([model.evaluate(part)[0] for part in np.array_split(flips[::-1], 7)])[::-1]
    np.testing.assert_array_equal(at_once, backwards)


def test_a_problem_keeps_the_model_of_the_last_centre():
    beam = Cantilever(6, 4)
    design = design_of(beam, 2)
    model = beam.neighbours(design)
    assert beam.neighbours(design.copy()) is model
    assert Cantilever(6, 4).neighbours(design) is model
    assert beam.neighbours(np.ones(beam.shape, dtype=bool)) is not model
