"""Several descents: each begins where it should, and all of them share what they have found."""

from collections import Counter

import numpy as np
import pytest

from slmm.optimization import Cantilever, Value, search
from slmm.optimization.algorithms.restarts import kicked
from slmm.optimization.algorithms.sampling import bf


class Trap:
    """Ones in a row, the fewer the better, but for all of them, which is best: one optimum, far from the others."""

    shape = (1, 8)
    fixed = start = np.zeros((1, 8), dtype=bool)
    objective = {"units": "1", "long_name": "ones"}  # noqa: RUF012

    def __init__(self):
        self.asked = Counter()

    def __repr__(self):
        return "Trap"

    def valid(self, designs):
        return np.ones(len(designs), dtype=bool)

    def evaluate(self, design, below):
        self.asked[design.tobytes()] += 1
        return Value(-1.0 if design.all() else float(design.sum()))


def test_a_descent_stays_in_a_trap_and_a_kick_leaves_it():
    assert search(Trap(), "tbfsl", depth=1, start=Trap.start).value == 0.0
    assert search(Trap(), "ils", starts=1, depth=1, start=Trap.start).value == 0.0
    found = search(Trap(), "ils", starts=3, depth=1, kick=8, start=Trap.start)
    # all eight flip
    assert found.value == -1.0 and found.best_design.all() and found.stopped == "all starts done"


def test_random_starts_are_other_ones_and_share_their_values():
    trap = Trap()
    found = search(trap, "ils", starts=20, depth=1, kick=0, seed=1)
    assert found.simulations > len(trap.asked) > 20
    assert set(trap.asked.values()) == {1}


def test_one_start_is_a_search_of_tbfsl():
    beam = Cantilever(4, 3)
    one, other = (
        search(beam, name, seed=5, depth=3, radius=2, **more)
        for name, more in (("ils", {"starts": 1}), ("tbfsl", {}))
    )
    assert (one.value, one.simulations) == (other.value, other.simulations)
    more = search(beam, "ils", seed=5, depth=3, radius=2, starts=5)
    assert (
        more.value <= one.value
        and more.history.value[: len(one.history.value)].tolist() == one.history.value.tolist()
    )


def test_kicked_designs_are_valid_and_so_far_away():
    beam, rng = Cantilever(5, 4), np.random.default_rng(0)
    full, cells = np.ones(beam.shape, dtype=bool), np.flatnonzero(~beam.fixed)
    for kick in (1, 3):
        other = kicked(beam, full, cells, kick, rng)
        assert (other != full).sum() == kick and beam.valid(other[None])[0] and other[beam.fixed].all()


def test_brute_force_with_a_good_start_need_know_less():
    trap = Trap()
    best = np.ones((1, 8), dtype=bool)
    asking = bf(trap, best, np.random.default_rng(0))
    assert next(asking).designs[0].all()
    assert asking.send(np.array([-1.0])).needed == -1.0
    assert search(trap, "bf", start=best).value == search(trap, "bf").value == -1.0


@pytest.mark.parametrize(
    ("settings", "words"),
    [({"starts": 0}, "ils: starts = 0"), ({"kick": -1}, "ils: kick = -1"), ({"depth": 0}, "ils: depth = 0")],
)
def test_settings_out_of_range_are_refused(settings, words):
    with pytest.raises(ValueError, match=words):
        search(Trap(), "ils", **settings)
