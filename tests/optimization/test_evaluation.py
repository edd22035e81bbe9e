"""Designs go out as workers are free, and answers come in as they are asked for."""

from concurrent.futures import Future

import numpy as np
import pytest
from expensive_problems import Rows

from slmm.optimization.ask import Ask
from slmm.optimization.evaluation import Evaluation
from slmm.optimization.memory import Memory
from slmm.optimization.problem import Bound, Value
from slmm.optimization.workers import Failure


class Scripted(Evaluation):
    """Two workers that come back in a given order; answers by keys are of a single cell."""

    def __init__(self, values, order):
        self.values_of, self.order, self.sent = values, list(order), []
        self.number = 2
        super().__init__(self, Memory())
        self.futures = {}

    def one(self, problem, design, below):
        cell = int(design.argmax())
        self.sent.append(cell)
        self.futures[cell] = Future()
        return self.futures[cell]

    def take_in(self):
        cell = self.order.pop(0)
        self.futures[cell].set_result(self.values_of[cell])
        super().take_in()


def single_cells(cells):
    designs = np.zeros((len(cells), 4, 4), dtype=bool)
    designs.reshape(-1, 16)[np.arange(len(cells)), cells] = True
    return designs


def test_the_next_design_goes_out_as_soon_as_a_worker_is_free():
    values = {0: Value(5.0), 1: Bound(4.0), 2: Failure("lost"), 3: Value(1.0), 4: Value(2.0), 5: Value(0.5)}
    at_work = Scripted(values, order=[1, 2, 3, 0, 4])
    parts = at_work.answer(Ask(Rows(), single_cells([0, 1, 2, 3, 4, 5]), below=3.0, needed=3.0))
    (first,) = parts
    # 0 takes longest; no other waits for it, and behind 3, which is good enough, none goes out
    assert at_work.sent == [0, 1, 2, 3]
    np.testing.assert_array_equal(first.values, [np.inf, np.inf, np.nan, 1.0])


def test_the_answer_ends_with_the_first_in_order_and_later_ones_are_remembered():
    values = {0: Value(2.5), 1: Value(1.0), 2: Value(4.0), 3: Value(2.0)}
    at_work = Scripted(values, order=[1, 0, 2, 3])
    (part,) = at_work.answer(Ask(Rows(), single_cells([0, 1, 2]), below=3.0, needed=3.0))
    assert part.values.tolist() == [2.5] and at_work.sent == [0, 1]
    # the next question knows it, but tells it as one worker would, who had found a bound
    parts = at_work.answer(Ask(Rows(), single_cells([2, 1, 3]), below=0.9, needed=0.9))
    assert [value for part in parts for value in part.values] == [np.inf] * 3
    assert at_work.sent == [0, 1, 2, 3]


def test_what_is_still_out_serves_the_next_question():
    values = {0: Value(2.0), 1: Value(1.0), 2: Value(5.0)}
    at_work = Scripted(values, order=[0, 2, 1])
    (part,) = at_work.answer(Ask(Rows(), single_cells([0, 1]), below=3.0, needed=3.0))
    assert part.values.tolist() == [2.0] and list(at_work.out) == [b"4x4:\x40\x00"]
    parts = list(at_work.answer(Ask(Rows(), single_cells([1, 2]), below=1.5, needed=1.5)))
    assert [part.values.tolist() for part in parts] == [[1.0]]
    assert at_work.sent == [0, 1, 2] and not at_work.out and not at_work.order


def test_a_bound_that_does_not_answer_is_asked_again():
    at_work = Scripted({0: Bound(2.0)}, order=[0, 0])
    list(at_work.answer(Ask(Rows(), single_cells([0]), below=1.5, needed=1.5)))
    list(at_work.answer(Ask(Rows(), single_cells([0]), below=2.0, needed=2.0)))
    assert at_work.sent == [0]
    at_work.values_of[0] = Value(2.25)
    (part,) = at_work.answer(Ask(Rows(), single_cells([0]), below=3.0, needed=3.0))
    assert part.values.tolist() == [2.25] and at_work.sent == [0, 0]


def test_a_question_needs_at_least_what_is_below_its_limit():
    with pytest.raises(ValueError, match=r"needed = 1.0: must not be less than below = 2.0"):
        Ask(Rows(), single_cells([0]), below=2.0, needed=1.0)
