"""What is asked for wrongly, or answered by a problem, is named before or instead of the work."""

import numpy as np
import pytest
from quick_problems import BEAM, Pattern, Returns

from slmm.optimization import Cantilever, search


@pytest.mark.parametrize(
    ("what", "words"),
    [
        (
            lambda values: values[:-1],
            r"must return 1 real numbers for as many designs, and returned float64 of shape \(0,\)",
        ),
        (lambda values: values[:, None], r"returned float64 of shape \(1, 1\)"),
        (lambda values: 1.0, r"returned float64 of shape \(\)"),
        (lambda values: values + 1j, "returned complex128"),
    ],
)
def test_values_of_a_wrong_shape_or_kind_are_named(what, words):
    with pytest.raises(ValueError, match=words):
        search(Returns(what), "tbfsl", seed=1)


def test_a_journal_needs_a_problem_that_has_a_name(tmp_path):
    class Nameless(Pattern):
        __repr__ = object.__repr__

    with pytest.raises(ValueError, match="needs a __repr__ of its own"):
        search(Nameless(), journal=tmp_path / "run.sqlite")
    assert not any(tmp_path.iterdir())
    assert repr(Cantilever(np.int64(6), 4)) == repr(BEAM)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"algorithm": "newton"}, "algorithm = 'newton': must be one of"),
        ({"speed": 3}, "speed: is no setting; must be one of depth, radius"),
        ({"depth": 0}, "depth = 0: must be a whole number"),
        ({"workers": 0}, "workers = 0: must be a whole number"),
        ({"resume": True}, "resume: needs a journal"),
        ({"algorithm": "rs"}, "limit: must be given"),
        ({"seed": 2**63}, "seed = 9223372036854775808: must be a whole number from 0 to"),
        ({"algorithm": "ga", "scale": "x"}, "scale = 'x': must be a number"),
        ({"algorithm": "ga", "scale": 0}, "scale = 0: must be positive"),
        ({"algorithm": "mg", "stages": 5}, "stages = 5: must be a sequence"),
        (
            {"algorithm": "mg", "stages": [(6, 4, "tbfsl")]},
            "must be columns, rows, an algorithm and its settings",
        ),
        (
            {"algorithm": "mg", "stages": [(4, 3, "tbfsl", {}), (6, 4, "tbfsl", {"depth": 0})]},
            "mg: stage 6 x 4: tbfsl: depth = 0: must be",
        ),
        (
            {"algorithm": "mg", "stages": [(6, 4, "tbfsl", {})], "start": np.ones(4)},
            "start: must be one design",
        ),
        ({"start": np.zeros((4, 6))}, "start: must have the fixed cells"),
        ({"start": np.ones((3, 6))}, "start: must have 4 rows and 6 columns"),
    ],
)
def test_bad_requests_are_refused_by_name(options, words):
    with pytest.raises(ValueError, match=words):
        search(BEAM, **options)


def test_too_many_neighbours_are_refused_before_the_work():
    evaluated = []

    class Watched(Pattern):
        def evaluate(self, designs):
            evaluated.append(len(designs))
            return super().evaluate(designs)

    with pytest.raises(ValueError, match="120,691,649 combinations of 899 cells"):
        search(Watched(30, 30), "bfsl", depth=4)
    assert not evaluated
