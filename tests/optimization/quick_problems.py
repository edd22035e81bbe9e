"""Problems that take no time, with and without models of neighbours, and when two results are the same."""

from typing import ClassVar

import numpy as np

from slmm.optimization import Cantilever
from slmm.optimization.ask import Flipped

BEAM = Cantilever(6, 4)


class Pattern:
    """How many cells differ from a hidden pattern: one optimum, no traps; some designs fail."""

    objective: ClassVar = {"units": "1", "long_name": "cells that are wrong"}
    fails = False

    def __init__(self, rows=4, columns=5):
        self.shape = rows, columns
        self.fixed = np.zeros(self.shape, dtype=bool)
        self.fixed[0, 0] = True
        self.start = self.fixed
        self.hidden = np.random.default_rng(0).random(self.shape) < 0.5
        self.hidden[0, 0] = True

    def __repr__(self):
        return f"Pattern{self.shape}"

    def valid(self, designs):
        return designs[:, 0, 0]

    def evaluate(self, designs):
        wrong = (designs != self.hidden).sum(axis=(1, 2)).astype(float)
        return np.where(wrong == 3, np.nan, wrong) if self.fails else wrong

    def repaired(self, design):
        return design | self.fixed

    def resized(self, columns, rows):
        return Pattern(rows, columns)


class Plain:
    """A cantilever without a quick model of neighbours."""

    def __init__(self, beam):
        self.beam = beam

    def __getattr__(self, name):
        if name in ("neighbours", "beam") or name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.beam, name)


class Rough(Plain):
    """A cantilever with a model of neighbours that is off by as much as it says, or knows nothing."""

    error = 2e-3

    def neighbours(self, centre):
        self.centre = centre
        return self

    def evaluate(self, asked):
        # flips come two-dimensional
        if asked.ndim == 3:
            return self.beam.evaluate(asked)
        rng = np.random.default_rng(asked.sum())
        error = self.error * rng.uniform(0, 2, len(asked))
        values = self.beam.evaluate(Flipped(self.centre, asked)[:]) + error * rng.uniform(-1, 1, len(asked))
        return np.where(rng.random(len(asked)) < 0.1, np.nan, values), error


def same(a, b):
    assert a.value == b.value and a.simulations == b.simulations and a.stopped == b.stopped
    np.testing.assert_array_equal(a.best_design, b.best_design)
    np.testing.assert_array_equal(a.history.value, b.history.value)
    np.testing.assert_array_equal(a.history.simulation, b.history.simulation)
    return True


class Returns(Pattern):
    """Whose evaluation returns something else."""

    def __init__(self, what):
        super().__init__()
        self.what = what

    def evaluate(self, designs):
        return self.what(super().evaluate(designs))
