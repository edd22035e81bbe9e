"""What a user adds: an algorithm by a line in the table, a problem with what it has, and words on what it lacks."""

from typing import ClassVar

import numpy as np
import pytest

from slmm.command.optimize_command import ALGORITHMS as ON_THE_COMMAND_LINE
from slmm.command.optimize_command import BRUTE_FORCE
from slmm.optimization import Bound, Cantilever, Value, search
from slmm.optimization.algorithms.annealing import above_kept, accepts
from slmm.optimization.algorithms.registry import ON_ONE_GRID
from slmm.optimization.ask import Ask, Flipped
from slmm.optimization.problem import start_design


class Least:
    """Cells that are on, at least so many: no more than every problem needs."""

    shape = (2, 5)
    fixed = np.zeros(shape, dtype=bool)
    start = fixed
    objective: ClassVar = {"units": "1", "long_name": "cells that are on"}

    def __init__(self, cells=2):
        self.cells = cells

    def __repr__(self):
        return f"Least({self.cells})"

    def valid(self, designs):
        return designs.sum(axis=(1, 2)) >= self.cells

    def evaluate(self, designs):
        return designs.sum(axis=(1, 2)) + 0.0


class LeastOneByOne(Least):
    """The same, one at a time."""

    def evaluate(self, design, below):
        value = float(design.sum())
        return Value(value) if value < below else Bound(value)


def steepest(problem, start, rng, *, steps=20):
    """Take the best neighbour, as long as it is better."""
    design = start_design(problem, start, rng)
    (value,) = yield Ask(problem, design[None])
    for _ in range(steps):
        neighbours = Flipped(design, np.flatnonzero(~problem.fixed)[:, None])
        values = yield Ask(problem, neighbours, needed=value)
        if np.isnan(values).all() or not np.nanmin(values) < value:
            return "no better neighbour"
        place = int(np.nanargmin(values))
        design, value = neighbours[place : place + 1][0], values[place]
    return "all steps done"


@pytest.mark.parametrize("problem", [Least(), LeastOneByOne()])
def test_an_algorithm_is_a_function_and_a_line_in_the_table(problem, monkeypatch, tmp_path):
    monkeypatch.setitem(ON_ONE_GRID, "steepest", steepest)
    found = search(problem, "steepest", seed=1, journal=tmp_path / "run.sqlite")
    assert (found.value, found.stopped) == (2.0, "no better neighbour")
    assert search(problem, "steepest", steps=1, seed=1).stopped == "all steps done"
    with pytest.raises(ValueError, match="steepest: speed: is no setting; must be one of steps"):
        search(problem, "steepest", speed=1)
    stages = [(4, 3, "steepest", {}), (6, 4, "tbfsl", {"depth": 1})]
    assert search(Cantilever(6, 4), "mg", stages=stages).stopped == "last grid: no better neighbour"


def test_the_command_line_has_all_of_them():
    assert set(ON_THE_COMMAND_LINE) == {*ON_ONE_GRID, "mg", BRUTE_FORCE}


@pytest.mark.parametrize("algorithm", ["tbfsl", "bfsl", "fs", "sa", "rs", "bf", "tabu", "ils"])
def test_no_more_is_needed_than_an_algorithm_uses(algorithm):
    settings = {"rs": {"limit": 2}, "sa": {"temperature": 1e-3, "iterations": 500}}.get(algorithm, {})
    for problem in (Least(), LeastOneByOne()):
        found = search(problem, algorithm, **settings)
        # FS flips cells on the edge alone, and not all are
        assert found.value == 2.0 or algorithm == "fs"


@pytest.mark.parametrize(
    ("algorithm", "lacks"), [("ga", "no repaired"), ("mg", "no repaired and no resized")]
)
def test_what_a_problem_lacks_is_told_before_anything_is_opened(algorithm, lacks, tmp_path):
    with pytest.raises(ValueError, match=rf"{algorithm}: problem: Least\(2\) has {lacks}, needed here"):
        search(Least(), algorithm, journal=tmp_path / "run.sqlite", workers=2)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("algorithm", ["tbfsl", "tabu"])
def test_random_designs_that_are_never_valid_need_a_start_or_repair(algorithm):
    problem = Least(10)
    with pytest.raises(
        ValueError, match=r"none of 1000 random designs is valid, and Least\(10\) has no repaired"
    ):
        search(problem, algorithm)
    if algorithm == "tbfsl":
        assert search(problem, algorithm, start=np.ones((2, 5))).value == 10.0
    else:  # which goes on from random ones
        with pytest.raises(ValueError, match=r"Least\(10\) has no repaired"):
            search(problem, algorithm, start=np.ones((2, 5)))


def test_a_problem_without_what_all_need_is_refused():
    class Nothing:
        shape = (2, 2)

        def __repr__(self):
            return "Nothing"

    with pytest.raises(
        ValueError, match="Nothing has no fixed and no start and no objective and no valid and no"
    ):
        search(Nothing())


def test_annealing_asks_for_what_it_would_keep():
    rng = np.random.default_rng(1)
    for _ in range(2000):
        value, temperature = rng.normal() * 10.0 ** rng.integers(-3, 4), 10.0 ** rng.uniform(-6, 3)
        chance = rng.random()
        limit = above_kept(value, temperature, chance)
        # the last number that is kept, and one beyond the limit
        kept = value - temperature * np.log(chance) * (1 - 1e-12)
        assert not accepts(kept - value, temperature, chance) or kept < limit
        assert not accepts(limit * (1 + np.sign(limit) * 1e-8) - value, temperature, chance)
        assert value < limit
    assert above_kept(1.0, 0.5, 0.0) == np.inf
    assert 1.0 < above_kept(1.0, 0.0, 0.0) < 1.0 + 1e-8
