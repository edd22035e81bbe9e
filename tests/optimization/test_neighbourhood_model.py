"""Neighbours by a few unknowns are what direct solves find."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.optimization.ask import Flipped
from slmm.optimization.cantilever import Cantilever
from slmm.optimization.neighbourhood_model import WIDEST, NeighbourhoodModel


def design_of(beam, seed, share=0.6):
    rng = np.random.default_rng(seed)
    return beam.repaired(beam.fixed | (rng.random(beam.shape) < share))


def compared(beam, design, flips):
    """Approximate and direct values of the valid ones."""
    designs = Flipped(design, flips)[:]
    valid = beam.is_valid(designs)
    assert valid.any()
    ours = NeighbourhoodModel(beam, design).evaluate(flips[valid])
    return ours, beam.endpoint_displacement(designs[valid])


@pytest.mark.parametrize("grid", [(6, 4), (3, 3), (2, 5)])
@pytest.mark.parametrize("seed", range(3))
def test_all_single_and_double_flips_are_those_of_direct_solves(grid, seed):
    beam = Cantilever(*grid)
    design = design_of(beam, seed)
    free = np.flatnonzero(~beam.fixed.ravel())
    for k in (1, 2):
        ours, direct = compared(beam, design, np.array(list(combinations(free, k))))
        np.testing.assert_allclose(ours, direct, rtol=1e-8)


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
    valid = beam.is_valid(designs)
    ours = NeighbourhoodModel(beam, design).evaluate(flips[valid])
    direct = beam.endpoint_displacement(designs[valid])
    np.testing.assert_allclose(ours, direct, rtol=1e-8)


def test_cells_far_apart_are_solved_directly():
    beam = Cantilever(WIDEST + 4, 3)
    design = np.ones(beam.shape, dtype=bool)
    flips = np.array([[beam.columns + 1, 2 * beam.columns - 1]])
    ours, direct = compared(beam, design, flips)
    assert ours[0] == direct[0]


def test_the_first_material_at_the_free_end_comes_and_the_last_goes():
    beam = Cantilever(6, 4)
    lightest = beam.fixed.copy()
    last = 2 * beam.columns - 1  # below the upper right cell
    grown = lightest.copy()
    grown.ravel()[last] = True
    (more,) = NeighbourhoodModel(beam, lightest).evaluate(np.array([[last]]))
    (less,) = NeighbourhoodModel(beam, grown).evaluate(np.array([[last]]))
    light, heavy = beam.endpoint_displacement([lightest, grown])
    assert more == pytest.approx(heavy, rel=1e-9)
    assert less == pytest.approx(light, rel=1e-9)


def test_a_link_that_goes_while_another_comes_is_solved_directly():
    # a long coil hangs on the cell under the corner; without it the cell beside it holds it all
    beam = Cantilever(24, 12)
    design = beam.fixed.copy()
    design[2:, 23:3:-2] = True
    design[1, 23] = True
    design[11, 22:3:-4] = design[2, 20:3:-4] = True
    flips = np.array([[2 * 24 - 1, 2 * 24 - 3]])
    ours, direct = compared(beam, design, flips)
    assert ours[0] == direct[0]
    free = np.flatnonzero(~beam.fixed.ravel())
    flips = np.array([[a, b] for a, b in combinations(free, 2) if b - a in (1, 23, 24, 25)])
    flips = flips[beam.is_valid(Flipped(design, flips)[:])]
    ours, direct = compared(beam, design, flips)
    np.testing.assert_allclose(ours, direct, rtol=1e-6)


def test_values_do_not_depend_on_what_was_asked_before():
    beam = Cantilever(12, 6)
    design = design_of(beam, 1)
    free = np.flatnonzero(~beam.fixed.ravel())
    flips = np.array([[a, b] for a, b in combinations(free, 2)])
    flips = flips[beam.is_valid(Flipped(design, flips)[:])]
    at_once = NeighbourhoodModel(beam, design).evaluate(flips)
    model = NeighbourhoodModel(beam, design)
    backwards = np.concatenate([model.evaluate(part) for part in np.array_split(flips[::-1], 7)])[::-1]
    np.testing.assert_array_equal(at_once, backwards)


def test_a_problem_keeps_the_model_of_the_last_centre():
    beam = Cantilever(6, 4)
    design = design_of(beam, 2)
    model = beam.neighbours(design)
    assert beam.neighbours(design.copy()) is model
    assert Cantilever(6, 4).neighbours(design) is model
    assert beam.neighbours(np.ones(beam.shape, dtype=bool)) is not model
