"""Pressures between faces: none pulls, nothing overlaps, and where faces are apart none acts."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.mechanics.faces_in_contact import ContactError, closing_pressures


def held(A, gap):
    pressure, closed = closing_pressures(np.asarray(gap), lambda places: A[:, places], np.abs(gap).max())
    return pressure, closed, gap + A @ pressure


def compliance(random, m):
    """Symmetric and positive definite, of any sign off the diagonal."""
    B = random.normal(size=(m, m))
    return B @ B.T + 0.1 * np.eye(m)


@given(m=st.integers(1, 30), seed=st.integers(0, 10**6))
def test_pressures_push_and_faces_do_not_overlap(m, seed):
    random = np.random.default_rng(seed)
    A, gap = compliance(random, m), random.normal(size=m)
    pressure, closed, left = held(A, gap)
    scale = np.abs(gap).max()
    assert pressure.min() >= 0 and left.min() > -1e-8 * scale
    assert np.all(pressure[~closed] == 0) and np.abs(left[closed]).max(initial=0.0) < 1e-8 * scale


@given(seed=st.integers(0, 10**6))
def test_it_is_the_one_answer_of_all_sets_of_places(seed):
    random = np.random.default_rng(seed)
    A, gap = compliance(random, 5), random.normal(size=5)
    pressure, _, _ = held(A, gap)
    found = []
    for chosen in product((False, True), repeat=5):
        on = np.array(chosen)
        tried = np.zeros(5)
        tried[on] = np.linalg.solve(A[np.ix_(on, on)], -gap[on])
        if tried.min() >= 0 and (gap + A @ tried)[~on].min(initial=0.0) >= 0:
            found.append(tried)
    assert len(found) == 1 and pressure == pytest.approx(
        found[0], abs=1e-9 * np.abs(found[0]).max(initial=1.0)
    )


def test_where_all_that_is_wrong_changes_sides_for_ever_places_change_one_by_one():
    """Of this one the set of closed places goes round and round (Murty's example of a cycle)."""
    A = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 2.0], [2.0, 0.0, 1.0]])
    pressure, closed, left = held(A, -np.ones(3))
    assert closed.all() and pressure == pytest.approx(np.full(3, 1 / 3)) and left == pytest.approx(0.0)


@given(m=st.integers(1, 12), seed=st.integers(0, 10**6))
def test_compliances_that_are_not_symmetric_have_an_answer_too(m, seed):
    """Positive principal minors are enough for one, and for it to be the only one."""
    random = np.random.default_rng(seed)
    skew = random.normal(size=(m, m))
    A, gap = compliance(random, m) + skew - skew.T, random.normal(size=m)
    pressure, closed, left = held(A, gap)
    scale = np.abs(gap).max()
    assert pressure.min() >= 0 and left.min() > -1e-8 * scale
    assert np.all(pressure[~closed] == 0) and np.abs(left[closed]).max(initial=0.0) < 1e-8 * scale


def test_open_faces_are_left_alone_and_no_compliance_is_asked_for():
    def never(places):
        raise AssertionError(places)

    pressure, closed = closing_pressures(np.array([0.0, 1.0, -1e-12]), never, 1.0)
    assert not pressure.any() and not closed.any()


def test_what_cannot_be_held_says_so():
    with pytest.raises(ContactError, match="no set of places where the faces touch was found in 6 trials"):
        held(np.array([[-1.0, 0.0], [0.0, -1.0]]), np.array([-1.0, -1.0]))
