"""A quick model of neighbours spares evaluations and changes no result."""

import numpy as np
import pytest
from quick_problems import BEAM, Plain, Rough, same

from slmm.optimization import Cantilever, search


def test_quick_neighbours_lead_to_what_direct_values_confirm():
    quick = search(Cantilever(12, 6), "tbfsl", depth=2, radius=2, seed=1)
    plain = search(Plain(Cantilever(12, 6)), "tbfsl", depth=2, radius=2, seed=1)
    assert quick.value == pytest.approx(plain.value, rel=1e-9)
    np.testing.assert_array_equal(quick.best_design, plain.best_design)
    assert quick.simulations == plain.simulations


@pytest.mark.parametrize("seed", range(3))
def test_a_rough_model_that_knows_its_error_changes_nothing(seed):
    assert same(search(Rough(BEAM), "tbfsl", seed=seed), search(Plain(BEAM), "tbfsl", seed=seed))


def test_what_a_model_says_is_worse_is_not_evaluated():
    def direct_evaluations(error):
        evaluated = []

        class Counting(Rough):
            def evaluate(self, designs):
                if designs.ndim == 3:
                    evaluated.append(len(designs))
                return super().evaluate(designs)

        Counting.error = error
        search(Counting(BEAM), "tbfsl", seed=0)
        return sum(evaluated)

    assert direct_evaluations(1e-9) < direct_evaluations(1e-3) < direct_evaluations(1.0)
