"""Moments by recursion against quadrature, beside a panel and on it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import legendre

from slmm.boundary.crack_panels import slope_at_tip, tip_rule
from slmm.boundary.moments import chord_log, is_far, line_log, moments
from slmm.boundary.rules import integration, refinement, rule, slopes_at, values_at


@given(x=st.floats(-1.5, 1.5), y=st.floats(0.2, 1.2), sign=st.sampled_from([-1, 1]))
def test_moments_are_the_integrals_they_stand_for(x, y, sign):
    zeta = complex(x, sign * y)
    found = np.empty((3, 10), dtype=complex)
    moments(zeta, chord_log(zeta), 2, found)
    s, w = legendre.leggauss(200)
    P = legendre.legvander(s, 9)
    for order, factor in ((0, 1.0), (1, 1.0), (2, 2.0)):
        exact = factor * (w / (s - zeta) ** (order + 1)) @ P
        assert found[order] == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())


def test_the_finite_part_on_the_line_is_the_mean_of_both_sides():
    for x in (-0.7, 0.0, 0.31):
        above, below = chord_log(complex(x, 1e-12)), chord_log(complex(x, -1e-12))
        assert line_log(x) == pytest.approx(0.5 * (above + below).real, abs=1e-9)
        assert above - below == pytest.approx(2j * np.pi, abs=1e-9)


def test_far_is_where_the_plain_rule_serves():
    assert is_far(2.1 + 0j) and is_far(2j) and not is_far(1.5 + 0.5j)


def test_rules_on_panels_are_exact_for_their_polynomials():
    p = 8
    x, w = rule(p)
    f = x**7 - 3 * x**2
    at = np.array([-0.93, 0.2, 1.0])
    assert values_at(at, p) @ f == pytest.approx(at**7 - 3 * at**2)
    assert slopes_at(at, p) @ f == pytest.approx(7 * at**6 - 6 * at)
    assert (integration(p) @ f)[-1] == pytest.approx(w @ f)
    assert refinement(p) @ f == pytest.approx(rule(2 * p)[0] ** 7 - 3 * rule(2 * p)[0] ** 2)


def test_a_panel_at_a_tip_knows_the_slope_in_the_root_of_the_distance():
    t, _, _ = tip_rule(6)
    assert slope_at_tip(6) @ (2.5 * t - t**5) == pytest.approx(2.5)


def test_rounding_does_not_decide_by_which_rule_a_neighbour_of_the_same_length_is_seen():
    # its middle lies at 2, in half panels
    for zeta in (2.0, np.nextafter(2.0, 3.0), -2.0, np.nextafter(-2.0, -3.0), 2.0 + 1e-12j):
        assert not is_far(complex(zeta))
    assert is_far(2.01 + 0j)
