"""Patterns of holes: counts of the paper and of a prototype, symmetry, and outlines on their level set."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.optimization.hole_patterns.patterns import (
    DIRECTIONS,
    expanded,
    fixed_cells,
    repaired,
    shape_of,
    symmetric,
    weakest_first,
)
from slmm.part.level_set import IslandError, LevelSet


def designs(pattern, grid):
    """All designs of a pattern."""
    cells = np.argwhere(~fixed_cells(pattern, grid))
    for bits in range(2 ** len(cells)):
        design = np.zeros(shape_of(pattern, grid), dtype=bool)
        design[tuple(cells.T)] = [(bits >> k) & 1 for k in range(len(cells))]
        yield design


def level_set(whole):
    return LevelSet(whole.astype(float), (40.0, 40.0), 50.0 / len(whole))


def is_valid(whole):
    try:
        level_set(whole).contours()
    except IslandError:
        return False
    return True


@pytest.mark.parametrize(
    ("pattern", "grid", "count"),
    [("reflected", 3, 10), ("reflected", 4, 10), ("rotated", 3, 6), ("rotated", 4, 10)],
)
def test_designs_that_differ_by_more_than_symmetry_are_as_many_as_the_paper_evaluated(pattern, grid, count):
    keys = {
        symmetric(whole).tobytes()
        for whole in (expanded(design, pattern, grid) for design in designs(pattern, grid))
        if is_valid(whole)
    }
    assert len(keys) == count


def test_a_quarter_of_the_designs_of_reflected_five_has_an_island():
    """125 of 512, as a prototype counted."""
    assert sum(not is_valid(expanded(design, "reflected", 5)) for design in designs("reflected", 5)) == 125


@given(st.sampled_from(list(DIRECTIONS)), st.integers(3, 8), st.integers(0, 2**32 - 1))
def test_a_pattern_looks_the_same_from_the_directions_that_are_left_out(pattern, grid, seed):
    whole = expanded(np.random.default_rng(seed).random(shape_of(pattern, grid)) < 0.5, pattern, grid)
    turns = {np.rot90(whole, k).tobytes() for k in range(4)}
    # upside down it breaks as well: half a turn and a mirror image in one
    assert len(turns) <= DIRECTIONS[pattern]
    for other in (np.rot90(whole), whole[::-1], whole[:, ::-1], whole.T):
        assert (symmetric(other) == symmetric(whole)).all()


@given(st.integers(3, 7), st.integers(0, 2**32 - 1))
def test_outlines_lie_on_the_threshold_and_turn_with_the_grid(grid, seed):
    whole = np.random.default_rng(seed).random((grid, grid)) < 0.4
    contours = level_set(whole)
    if not is_valid(whole) or contours.margin() < 0.05:
        return
    outlines = contours.outlines()
    turned = level_set(np.rot90(whole)).outlines()
    assert len(turned) == len(outlines)
    assert sum(o.length for o in turned) == pytest.approx(sum(o.length for o in outlines), rel=1e-6)
    for outline in outlines:
        points = outline.points(np.linspace(0.0, outline.length, 200))
        assert np.abs(contours(points) - 0.5).max() < 1e-5
        assert points.min() > 40.0 - 25.0 - 0.5 * 50.0 / grid


def test_diagonal_neighbours_are_near_a_saddle():
    near = sum(
        level_set(expanded(design, "reflected", 5)).margin() < 0.01 for design in designs("reflected", 5)
    )
    assert near == 14
    assert LevelSet(np.zeros((3, 3)), (0.0, 0.0), 1.0).margin() == np.inf


@given(st.integers(2, 8), st.integers(0, 2**32 - 1))
def test_from_the_left_a_grid_breaks_like_its_mirror_image_alone(grid, seed):
    whole = np.random.default_rng(seed).random((grid, grid)) < 0.5
    least = symmetric(whole, "left")
    assert (symmetric(whole[::-1], "left") == least).all()
    assert (least == whole).all() or (least == whole[::-1]).all()


@given(st.integers(2, 8), st.integers(0, 2**32 - 1))
def test_the_weakest_direction_turns_with_the_grid(grid, seed):
    """A quarter turn more here is one less there."""
    whole = np.random.default_rng(seed).random((grid, grid)) < 0.5
    pairs = [int((turn[:, 1:] & turn[:, :-1]).sum()) for turn in (np.rot90(whole, k) for k in range(4))]
    order = weakest_first(whole, 4)
    assert sorted(order) == [0, 1, 2, 3]
    assert [pairs[k] for k in order] == sorted(pairs, reverse=True)


@given(st.sampled_from(list(DIRECTIONS)), st.integers(3, 7), st.integers(0, 2**32 - 1))
def test_repaired_designs_have_more_holes_in_place_of_islands(pattern, grid, seed):
    fixed = fixed_cells(pattern, grid)
    design = (np.random.default_rng(seed).random(shape_of(pattern, grid)) < 0.7) & ~fixed

    def island(whole):
        try:
            LevelSet(whole.astype(float), (0.5, 0.5), 1.0 / grid).contours()
        except IslandError as error:
            return error.at
        return None

    valid = repaired(design, pattern, grid, island)
    assert island(expanded(valid, pattern, grid)) is None
    assert (valid >= design).all() and not valid[fixed].any()
    assert is_valid(expanded(design, pattern, grid)) == (valid == design).all()


def test_what_holes_cannot_repair_is_told():
    with pytest.raises(ValueError, match="no design has as many holes"):
        repaired(np.zeros((2, 2), bool), "reflected", 4, lambda whole: (0.5, 0.5))
