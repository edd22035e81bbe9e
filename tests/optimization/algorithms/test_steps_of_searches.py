"""Every step of an algorithm is taken: what it asks next is seen to depend on it."""

from itertools import islice, pairwise

import numpy as np
import pytest

from slmm.optimization import Cantilever
from slmm.optimization.algorithms.annealing import sa
from slmm.optimization.algorithms.breadth_first import bfsl
from slmm.optimization.algorithms.genetic import ga, recombined
from slmm.optimization.algorithms.sampling import rs

BEAM = Cantilever(6, 4)


class Free:
    """All designs are valid; a test says what they are worth."""

    def __init__(self, rows=3, columns=4):
        self.shape = rows, columns
        self.fixed = self.start = np.zeros(self.shape, dtype=bool)

    def valid(self, designs):
        return np.ones(len(designs), dtype=bool)

    def repaired(self, design):
        return design


def asked(asking, values):
    """Designs of each question, to which the answers are these values, or what a function makes of the designs."""
    designs = next(asking).designs[:]
    for value in values:
        yield designs
        try:
            designs = asking.send(np.atleast_1d(value(designs) if callable(value) else value)).designs[:]
        except StopIteration:
            return


def apart(one, other):
    """In how many cells two designs differ."""
    return int((one != other).sum())


def ask_annealing(values, **options):
    return [d[0] for d in asked(sa(Free(), None, np.random.default_rng(0), **options), values)]


def test_annealing_cools():
    # each design is worse than all before it: hot, all are kept, and cold none is
    worse = range(40)
    hot = ask_annealing(worse, temperature=1e9, cooling=1.0)
    assert all(apart(a, b) == 1 for a, b in pairwise(hot))
    cold = ask_annealing(worse, temperature=1e9, cooling=0.0)
    assert all(apart(cold[1], design) == 1 for design in cold[2:])
    assert any(apart(hot[1], design) > 1 for design in hot[2:])


def test_annealing_leaves_a_start_without_a_value():
    designs = ask_annealing([np.nan, 5.0, 6.0, 6.0, 6.0], temperature=0.0)
    assert all(apart(designs[1], design) == 1 for design in designs[2:])


def test_breadth_first_begins_again_with_one_cell_after_a_better_design():
    free = Free()
    all_worse = [np.full(n, 2.0) for n in (12, 66)]
    # the first one of three cells is better
    questions = list(
        asked(bfsl(free, None, np.random.default_rng(0), depth=3), [1.0, *all_worse, 0.5, np.full(12, 2.0)])
    )
    start, one, two, three, again = questions
    assert [apart(start[0], q[0]) for q in (one, two, three)] == [1, 2, 3]
    assert sorted(apart(three[0], design) for design in again) == [1] * 12


@pytest.mark.parametrize(
    ("recombinations", "mutation", "new"), [(0, 0.0, False), (4, 0.0, True), (0, 0.3, True)]
)
def test_generations_are_recombined_and_mutated(recombinations, mutation, new):
    options = {
        "population": 10,
        "recombinations": recombinations,
        "mutation": mutation,
        "patience": 3,
        "scale": 1.0,
    }
    questions = list(
        asked(
            ga(Free(), None, np.random.default_rng(0), **options), 3 * [lambda designs: np.ones(len(designs))]
        )
    )
    assert (len(questions) > 1) == new


def test_pairs_exchange_a_block_of_cells():
    rng = np.random.default_rng(0)
    designs = np.stack([np.zeros((3, 4), dtype=bool), np.ones((3, 4), dtype=bool)])
    seen = set()
    for _ in range(100):
        one, other = recombined(Free(), designs, 1, rng)
        assert (one != other).all()  # cell by cell one of them has it
        rows, columns = one.any(axis=1), one.any(axis=0)
        assert (one == np.outer(rows, columns)).all()  # a rectangle
        seen.add(int(one.sum()))
    assert {1, 2, 3, 4, 6}.issubset(seen)
    assert (recombined(Free(), designs, 0, rng) == designs).all()


def test_a_generation_is_selected_by_fitness():
    def value(designs):
        return designs.sum(axis=(1, 2)).astype(float)

    options = {"population": 40, "recombinations": 0, "mutation": 0.02, "patience": 3, "scale": 0.2}
    questions = list(islice(asked(ga(Free(), None, np.random.default_rng(0), **options), 6 * [value]), 6))
    assert value(questions[-1]).mean() < value(questions[0]).mean() - 2


def test_random_sampling_asks_for_no_design_twice():
    questions = asked(
        rs(Free(3, 3), None, np.random.default_rng(0), limit=-np.inf), 1000 * [lambda d: np.ones(len(d))]
    )
    names = [design.tobytes() for designs in questions for design in designs]
    assert len(names) == len(set(names)) == 2**9
