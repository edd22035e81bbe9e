"""Continuous support values: what symmetry ties, which directions are alike, and topology."""

import numpy as np
import pytest

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.continuous import ContinuousPattern, connected
from slmm.optimization.hole_patterns.patterns import expanded
from slmm.optimization.hole_patterns.plate import CrackedPlate

PLATE = CrackedPlate()
SPOTS = np.array([[1, 0, 0, 1], [0, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 0]], bool)


@pytest.mark.parametrize(
    ("pattern", "grid"), [("reflected", 6), ("reflected", 7), ("rotated", 5), ("rotated", 8)]
)
def test_random_designs_of_a_pattern_have_its_variables(pattern, grid):
    problem = HolePattern(grid, pattern)
    rng = np.random.default_rng(0)
    design = rng.random(problem.shape) < 0.5
    near = ContinuousPattern(PLATE, problem.whole(design))
    assert len(near.start) == (~problem.fixed).sum() + 1
    values = near.values(rng.random(len(near.start)))
    turned = [np.rot90(values, 2), *([values[::-1]] if pattern == "reflected" else [np.rot90(values)])]
    assert all((other == values).all() for other in turned)
    assert (near.values(near.start) == problem.whole(design)).all()


def test_more_symmetry_than_the_patterns_ties_more():
    corners = expanded(np.array([[0, 1], [0, 0]], bool), "reflected", 4)
    near = ContinuousPattern(PLATE, corners)
    assert near.tied.tolist() == [[0, 1, 1, 0], [1, 2, 2, 1], [1, 2, 2, 1], [0, 1, 1, 0]]
    assert near.alike(2) == [0, 0] and near.alike(4) == [0, 0, 0, 0]
    # from the left alone a quarter turn changes something
    assert len(ContinuousPattern(PLATE, corners, "left").start) == 1 + 8
    # as mirrored at an upright line: from the left as from the right, and not from below as from above
    assert ContinuousPattern(PLATE, SPOTS).alike(4) == [0, 1, 0, 3]


def test_spacing_makes_frames():
    near = ContinuousPattern(PLATE, SPOTS)
    variables = near.start
    assert near.plate_of(variables) == PLATE
    variables[-1] = 1.1
    plate = near.plate_of(variables)
    assert plate.frame == pytest.approx(12.5)
    assert plate.level_set(SPOTS).spacing == pytest.approx(1.1 * PLATE.level_set(SPOTS).spacing)
    with pytest.raises(ValueError, match="frame = -10"):
        near.plate_of([*variables[:-1], 2.0])


def test_topology_is_which_points_lie_in_which_hole():
    near = ContinuousPattern(PLATE, SPOTS)
    assert connected(PLATE.level_set(SPOTS)).tolist() == [[1, 0, 0, 2], [0] * 4, [0, 3, 3, 0], [0] * 4]
    variables = near.start
    assert near.keeps_topology(variables)
    larger = np.where(variables > 0, 1.3, 0.1)
    assert near.keeps_topology(larger)
    gone, bridged = variables.copy(), variables.copy()
    gone[near.tied[0, 0]] = 0.3
    bridged[near.tied[0, 1]] = 0.9
    assert not near.keeps_topology(gone) and not near.keeps_topology(bridged)


def test_islands_and_empty_plates_have_no_topology():
    ring = np.ones((5, 5), bool)
    ring[2, 2] = False
    assert connected(PLATE.level_set(ring)) is None
    assert connected(PLATE.level_set(np.zeros((3, 3)))) is None
