"""A problem whose designs are evaluated one at a time, with bounds and failures, and its relatives."""

import json
import time
from typing import ClassVar

import numpy as np

from slmm.optimization.ask import Flipped
from slmm.optimization.problem import Bound, Value


class Rows:
    """How far the rows of a design are from a hidden one; row after row is looked at, and a bad design given up.

    Some designs fail after the first rows, if they are not given up before. What is evaluated is written to a file.
    """

    objective: ClassVar = {"units": "mm", "long_name": "distance"}
    shape = (4, 4)
    start = np.zeros(shape, dtype=bool)
    fixed = np.arange(16).reshape(shape) >= 12
    hidden = np.random.default_rng(5).random(shape) < 0.5
    weight = np.random.default_rng(6).uniform(0.5, 1.5, shape)

    def __init__(self, log=None, seconds=0.0, fails=0.2):
        self.log, self.seconds, self.fails = log, seconds, fails

    def __repr__(self):
        return f"Rows(fails={self.fails})"

    def valid(self, designs):
        return designs.sum(axis=(1, 2)) % 7 != 6

    def repaired(self, design):
        return design ^ (np.arange(16).reshape(4, 4) == 0) if design.sum() % 7 == 6 else design

    def evaluate(self, design, below):
        time.sleep(self.seconds * np.random.default_rng().exponential())
        found = self.found(design, below)
        if self.log is not None:
            with open(self.log, "a") as file:
                file.write(json.dumps([self.name(design).hex(), below, str(found)]) + "\n")
        if isinstance(found, Exception):
            raise found
        return found

    def found(self, design, below):
        fails = np.random.default_rng(np.packbits(design)).random() < self.fails
        total = 0.0
        for row in range(4):
            total += float((self.weight[row] * (design[row] != self.hidden[row])).sum())
            if total >= below:
                return Bound(total)
            if fails and row == 1:
                return ArithmeticError("the mesh is tangled")
        return Value(total)

    def name(self, design):
        return np.packbits(design).tobytes()


class AtOnce(Rows):
    """The same by values of many designs."""

    def evaluate(self, designs):
        found = [self.found(design, np.inf) for design in designs]
        return np.array([each.value if isinstance(each, Value) else np.nan for each in found])


class Mirrored(Rows):
    """Where designs are equal to their mirror images."""

    def key(self, design):
        return min(np.packbits(design).tobytes(), np.packbits(design[:, ::-1]).tobytes())

    name = key

    def found(self, design, below):
        design = np.unpackbits(np.frombuffer(self.key(design), dtype=np.uint8)).reshape(4, 4).astype(bool)
        return super().found(design, below)


class WithModel(Rows):
    """With a quick model of neighbours, which is off by as much as it says, or knows nothing."""

    def neighbours(self, centre):
        return Around(self, centre)


class Around:
    def __init__(self, problem, centre):
        self.problem, self.centre = problem, centre

    def evaluate(self, flips):
        values = [self.problem.found(design, 1e9) for design in Flipped(self.centre, flips)[:]]
        values = np.array([each.value if isinstance(each, Value) else np.nan for each in values])
        dice = np.random.default_rng(flips.sum())
        error = dice.uniform(0, 0.5, len(flips))
        return np.where(dice.random(len(flips)) < 0.1, np.nan, values + error * dice.uniform(-1, 1)), error
