"""The toughest design that does not fork, among designs that are told what shifts do to them."""

from typing import ClassVar

import numpy as np
import xarray as xr

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.margins import SHIFTS
from slmm.optimization.hole_patterns.steady import toughest_steady


class Told(HolePattern):
    """U_T is 100 mJ for each hole, less what shifts cost: with three holes they cost a tenth, with two a thousandth."""

    COSTS: ClassVar = {4: 0.2, 3: 0.1, 2: 1e-3, 1: 0.0}

    def fracture(self, scene, *arguments, **options):
        values = np.array(scene.holes[0].values)
        shift = scene.holes[0].center[1] - 40.0
        holes = int(values.sum())
        lost = self.COSTS[holes] if abs(shift - SHIFTS[0]) < 1e-12 else 0.0
        if holes == 4 and shift > 0:
            raise ValueError("failed: for a test")
        return xr.Dataset({"U_T": 100.0 * holes * (1 - lost)})


def designs(*counts):
    for count in counts:
        yield (np.arange(4) < count).reshape(2, 2), 100.0 * count


def test_the_first_steady_one_ends_it_and_what_fails_is_passed_over():
    problem = Told(2, "full", sides="left")
    found = toughest_steady(problem, designs(4, 3, 2, 1))
    # one hole is no tougher than three with their holes shifted the worse way
    assert [(each.value, round(each.worst, 6), each.is_steady) for each in found] == [
        (300.0, 270.0, False),
        (200.0, 199.8, True),
    ]


def test_it_goes_on_while_a_later_one_may_be_the_best_shifted_one(monkeypatch):
    monkeypatch.setattr(Told, "COSTS", {3: 0.4, 2: 0.004, 1: 0.0})
    problem = Told(2, "full", sides="left")
    listed = [*designs(3, 2), (np.eye(2, dtype=bool), 199.5), *designs(1)]
    found = toughest_steady(problem, listed)
    assert len(found) == 3 and found[1].is_steady and max(found, key=lambda each: each.worst) is found[1]


def test_none_is_steady_where_all_fork():
    assert not any(each.is_steady for each in toughest_steady(Told(2, "full", sides="left"), designs(3)))
