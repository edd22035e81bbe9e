import numpy as np
import pytest

from precompute.grading import Fineness, crack_line, graded


@pytest.mark.parametrize(("first", "last"), [(0.01, 0.05), (0.01, np.inf), (np.inf, 0.02)])
def test_sizes_grow_from_fine_ends(first, last):
    sizes = np.diff(graded(3.0, first, last, 1.5, 0.4))
    assert sizes.sum() == pytest.approx(3.0)
    assert sizes[0] <= first * 1.0001
    assert sizes[-1] <= last * 1.0001
    assert sizes.max() <= 0.4
    ratios = np.sort(np.stack([sizes[1:], sizes[:-1]]), axis=0)
    # where the two sides meet the sizes may differ by one step more
    assert (ratios[1] / ratios[0]).max() < 1.5**2 + 1e-9


def test_every_tip_is_an_element_end_with_fine_elements_on_both_sides():
    lengths = np.array([0.02, 0.1, 0.45, 1.0])
    fineness = Fineness(tip=0.01)
    line = crack_line(lengths, 1.5, fineness, fineness.coarsest)
    at = np.abs(line - lengths[:, None]).argmin(axis=1)
    assert np.allclose(line[at], lengths, rtol=1e-12)
    sizes = np.diff(line)
    assert np.all(sizes > 0)
    assert np.all(sizes[at - 1] <= 0.01 * lengths * 1.0001)
    assert np.all(sizes[at] <= 0.01 * lengths * 1.0001)


def test_crack_may_reach_the_far_end():
    assert crack_line(np.array([0.5, 1.0]), 1.0, Fineness(), 0.1)[-1] == pytest.approx(1.0)


def test_division_up_to_the_last_tip_does_not_depend_on_the_end():
    lengths = np.array([0.1, 0.5])
    short, long = (crack_line(lengths, end, Fineness(), 0.1) for end in (0.7, 2.0))
    n = np.searchsorted(short, 0.5 + 1e-9)
    assert np.array_equal(short[:n], long[:n])
