"""Listed hole patterns: what is shipped is complete and agrees with simulations; searches on it."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from slmm.optimization import Bound, HolePattern, Value, search
from slmm.optimization.hole_patterns.listed import ListedPattern

FILE = Path(__file__).parents[3] / "validation" / "results" / "hole_pattern_values.nc"
#: classes of valid designs that are not equal by symmetry: the paper's numbers of iterations of the first four
CLASSES = {
    ("reflected", 3): 10,
    ("reflected", 4): 10,
    ("rotated", 3): 6,
    ("rotated", 4): 10,
    ("rotated", 5): 65,
    ("full", 3): 100,
    ("rotated", 6): 224,
    ("reflected", 5): 213,
    ("reflected", 6): 212,
}
#: how many of them have no value: faces of cracks touch in no way that is found
FAILED = {("rotated", 6): 1}


@pytest.mark.parametrize("space", CLASSES)
def test_a_space_is_complete(space):
    listed = ListedPattern.read(FILE, *space)
    assert len(listed.values) == CLASSES[space]
    assert np.isnan(list(listed.values.values())).sum() == FAILED.get(space, 0)
    cells = np.argwhere(~listed.fixed)
    for bits in range(2 ** len(cells)):
        design = listed.start
        design[tuple(cells.T)] = (bits >> np.arange(len(cells))) & 1
        assert listed.valid(design[None])[0] == HolePattern.valid(listed, design[None])[0]


def test_a_simulation_finds_what_is_listed():
    """To 5e-4: engines may be quicker than the one that made the list."""
    listed = ListedPattern.read(FILE, "rotated", 4)
    found = search(listed, "bf")
    simulated = HolePattern(4, "rotated").evaluate(found.best_design, np.inf)
    assert isinstance(simulated, Value) and simulated.value == pytest.approx(found.value, rel=5e-4)
    assert listed.rank(found.value) == 1


def test_limits_are_kept_as_by_a_simulation():
    listed = ListedPattern.read(FILE, "rotated", 3)
    solid = listed.evaluate(listed.start, np.inf)
    assert isinstance(solid, Value) and solid.value == pytest.approx(-106.92, rel=5e-4)
    assert listed.evaluate(listed.start, solid.value) == Bound(solid.value)
    assert listed.rank(solid.value) > listed.rank(search(listed, "tbfsl", depth=3, radius=3).value)


def test_ranked_designs_are_those_of_their_values():
    listed = ListedPattern.read(FILE, "rotated", 6)
    ranked = listed.ranked()
    assert len(ranked) == 223 and all(one[1] >= other[1] for one, other in pairwise(ranked))
    whole, U_T = ranked[0]
    assert listed.values[np.packbits(whole).tobytes()] == -U_T == search(listed, "bf").value


def test_spaces_that_are_not_listed_are_refused():
    with pytest.raises(ValueError, match="has no values of full patterns of 9 x 9 points"):
        ListedPattern.read(FILE, "full", 9)
