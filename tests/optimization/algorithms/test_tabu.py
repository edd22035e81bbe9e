"""Tabu search: it leaves local optima, bars what has flipped, and simulates nothing twice."""

from typing import ClassVar

import numpy as np
import pytest

from slmm.optimization import Cantilever, search
from slmm.optimization.algorithms.tabu import first_better_or_least_worse, tabu

BEAM = Cantilever(5, 5)
#: mm, of all 2180 valid designs
BEST_OF_5_X_4 = 0.0065322346


class Flat:
    """All designs are equally good; where asked to, those with an odd number of cells fail."""

    objective: ClassVar = {"units": "1", "long_name": "nothing"}

    def __init__(self, rows=3, columns=4, fails=False):
        self.shape = rows, columns
        self.fixed = np.zeros(self.shape, dtype=bool)
        self.fixed[0, 0] = True
        self.start = self.fixed
        self.fails = fails

    def valid(self, designs):
        return designs[:, 0, 0]

    def evaluate(self, designs):
        odd = designs.sum(axis=(1, 2)) % 2 == 1
        return np.where(odd & self.fails, np.nan, 1.0)


def answered(asking, problem):
    """All designs that were asked for up to the first below the limit, and what came back."""
    designs, value = [], None
    while True:
        try:
            ask = asking.send(value)
        except StopIteration as end:
            return designs, end.value
        value = problem.evaluate(ask.designs)
        if (below := value < ask.below).any():
            value = value[: below.argmax() + 1]
        designs += [ask.designs[i] for i in range(len(value))]


@pytest.mark.parametrize("seed", [2, 5])
def test_it_leaves_local_optima_in_which_it_would_stay_if_nothing_were_barred(seed):
    beam = Cantilever(5, 4)
    found = search(beam, "bfsl", depth=1, seed=seed)
    options = {"start": found.best_design, "seed": seed, "steps": 600, "patience": 600}
    left = search(beam, "tabu", **options)
    kept = search(beam, "tabu", tenure=0.0, focus=0, **options)
    assert kept.value == found.value > 1.1 * BEST_OF_5_X_4
    assert left.value == pytest.approx(BEST_OF_5_X_4, rel=1e-7)


def test_where_it_knows_all_it_goes_on_from_a_random_design():
    beam = Cantilever(5, 4)
    found = search(beam, "bfsl", depth=1, seed=2)
    options = {"start": found.best_design, "seed": 2, "steps": 600, "tenure": 0.0, "focus": 0}
    assert search(beam, "tabu", patience=600, **options).value == found.value
    assert search(beam, "tabu", patience=5, **options).value == pytest.approx(BEST_OF_5_X_4, rel=1e-7)


def test_no_design_is_simulated_twice():
    beam = Cantilever(5, 4)
    designs, stopped = answered(tabu(beam, None, np.random.default_rng(1), steps=500), beam)
    valid = [design.tobytes() for design in designs if beam.valid(design[None])[0]]
    assert len(valid) == len(set(valid)) > 100
    assert stopped == "all steps done"
    assert search(beam, "tabu", seed=1, steps=500).simulations == len(valid)


def test_a_barred_cell_is_not_tried_until_its_tenure_is_over():
    problem, start = Flat(), np.ones((3, 4), dtype=bool)

    def simulated(steps):
        asking = tabu(problem, start, np.random.default_rng(2), steps=steps, tenure=1.0, focus=0)
        return answered(asking, problem)[0]

    # eleven cells are free: one less each time, until all have flipped
    opposite = ~start | problem.fixed
    assert len(simulated(11)) == 1 + sum(range(1, 12))
    np.testing.assert_array_equal(simulated(11)[-1], opposite)
    # in the step after that all of them are barred; then only the one that flipped first is free
    assert len(simulated(12)) == len(simulated(11))
    (last,) = simulated(13)[len(simulated(12)) :]
    assert (last != opposite).sum() == 1


def test_near_a_new_best_design_the_focused_tenure_is_in_force():
    problem, start = Flat(), np.ones((3, 4), dtype=bool)

    def simulated(focus):
        asking = tabu(
            problem, start, np.random.default_rng(0), steps=6, tenure=1.0, focus=focus, focused_tenure=2
        )
        return answered(asking, problem)[0]

    # always two cells are barred then, and some of the nine neighbours are known; otherwise one more in each step
    assert len(simulated(focus=0)) == 1 + 11 + 10 + 9 + 8 + 7 + 6
    assert 1 + 11 + 10 + 9 + 9 < len(simulated(focus=4)) != len(simulated(focus=0))
    # the start was the best one: four steps later that is over
    assert len(simulated(focus=6)) > len(simulated(focus=4))


def test_the_first_better_one_is_taken_and_what_is_known_costs_nothing():
    problem = Flat()
    design = np.ones((3, 4), dtype=bool)
    cells = np.array([5, 1, 7, 2])
    neighbours = np.repeat(design.reshape(1, -1), 4, axis=0)
    neighbours[np.arange(4), cells] ^= True
    names = [neighbour.reshape(3, 4).tobytes() for neighbour in neighbours]

    def choice(known, answers):
        asking = first_better_or_least_worse(problem, design, 1.0, cells, known)
        try:
            ask = asking.send(None)
            assert ask.below == 1.0 and len(ask.designs) == len(answers)
            below = np.flatnonzero(np.array(answers) < 1.0)
            asking.send(np.array(answers[: below[0] + 1] if below.size else answers))
        except StopIteration as end:
            return end.value
        raise AssertionError("it asks again")

    assert choice({}, [3.0, 0.5, 0.1, 2.0]) == (1, 0.5)
    assert choice({}, [3.0, np.nan, 2.0, 4.0]) == (2, 2.0)
    assert choice({}, [np.nan] * 4) is None
    # the third one is known to be better: the fourth is not asked for
    assert choice({names[2]: 0.9}, [3.0, 2.0]) == (2, 0.9)
    assert choice({names[2]: 0.9}, [3.0, 0.95]) == (1, 0.95)
    assert choice(dict.fromkeys(names, 2.0) | {names[3]: 1.5}, []) == (3, 1.5)
    known = {names[0]: 1.0}
    choice(known, [0.7, 5.0, 6.0])
    assert known == {names[0]: 1.0, names[1]: 0.7}


def test_designs_without_a_value_are_never_gone_to():
    problem = Flat(fails=True)
    start = np.ones((3, 4), dtype=bool)
    designs, stopped = answered(tabu(problem, start, np.random.default_rng(0), steps=5), problem)
    # all neighbours fail, so it stays where it is
    assert len(designs) == 1 + 11 and all((design != start).sum() <= 1 for design in designs)
    assert stopped == "all steps done"


def test_same_seed_same_result_and_another_seed_another_way():
    first, again, other = (search(BEAM, "tabu", seed=seed, steps=300) for seed in (3, 3, 4))
    assert first.value == again.value and first.simulations == again.simulations
    np.testing.assert_array_equal(first.history.value, again.history.value)
    assert not np.array_equal(first.history.value, other.history.value)
    assert BEAM.solved_directly(first.best_design) == pytest.approx(first.value, rel=1e-9)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"steps": 0}, "steps = 0: must be a whole number"),
        ({"tenure": 1.5}, r"tenure = 1.5: must lie between 0 and 1"),
        ({"focus": -1}, "focus = -1: must be a whole number"),
        ({"focused_tenure": 0.5}, "focused_tenure = 0.5: must be a whole number"),
        ({"patience": 0}, "patience = 0: must be a whole number"),
    ],
)
def test_settings_out_of_range_are_refused_by_name(options, words):
    with pytest.raises(ValueError, match=words):
        search(BEAM, "tabu", **options)
