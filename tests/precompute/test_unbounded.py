import numpy as np
import pytest
from numpy.polynomial import legendre
from scipy.interpolate import CubicSpline

from precompute.grading import Fineness
from precompute.unbounded import legendre_loads, unbounded_body, unbounded_compliance
from slmm.mechanics.crack_line import crack_factor

#: K = F S sqrt(pi L) of one crack at a circular hole of radius R in an unbounded plate under tension S, from
#: high-order finite elements (1e-4). The shortest crack is an edge crack in a half plane under 3 S.
L_OVER_R = [0.0, 0.01, 0.1, 0.2, 0.5, 1.0, 2.0]
F_OF_HOLE = [3 * 1.12152, 3.2932, 2.7727, 2.3746, 1.7279, 1.3061, 1.0307]


def extrapolated(curvature, lengths, orders):
    """The error is linear in the element size at the tip."""
    coarse, fine = (
        unbounded_compliance(curvature, lengths, orders, Fineness(tip, 1.5, 0.1)) for tip in (0.016, 0.008)
    )
    return 2 * fine - coarse


def test_loads_are_those_of_the_tractions():
    eta = np.array([0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9])
    loads = legendre_loads(eta, 0.5, 3)
    assert loads.shape == (4, 3)
    whole = np.concatenate([loads, np.zeros((1, 3))])
    # Simpson's rule on the element that ends at the tip gives a sixth to the tip itself
    assert whole[:, 0].sum() == pytest.approx(0.5 - 0.3 / 6)


def test_half_plane_under_uniform_pressure_and_shear():
    compliance = extrapolated(0.0, np.array([0.5, 1.0]), 2)
    assert compliance[:, :, 0, 0] == pytest.approx(1.12152**2 * np.pi, rel=1e-3)


def test_compliance_over_length_squared_is_the_same_for_every_length_in_a_half_plane():
    compliance = unbounded_compliance(0.0, np.array([0.1, 0.4, 1.0]), 4, Fineness(0.01))
    assert compliance[:, 1:] == pytest.approx(compliance[:, :-1], rel=5e-3, abs=1e-2)


def test_one_crack_at_a_circular_hole():
    R, lengths = 1.0, np.array([0.1, 0.5, 1.0])
    C = extrapolated(-0.5 / R, lengths, 6)[0]
    share = np.array(L_OVER_R) / (1 + np.array(L_OVER_R))
    F = CubicSpline(share, F_OF_HOLE)
    x, w = legendre.leggauss(40)
    for a, C_a in zip(lengths, C, strict=True):
        eta = a * (x + 1) / 2
        expected = np.sum(w * a / 2 * F(eta / (R + eta)) ** 2 * np.pi * eta)
        q = R / (R + eta)
        p = legendre.legvander(x, 5).T @ (w * (1 + q**2 / 2 + 1.5 * q**4)) * (np.arange(6) + 0.5)
        assert 0.5 * a**2 * p @ C_a @ p == pytest.approx(expected, rel=1e-3)


def test_compliance_is_symmetric_and_positive():
    for curvature in (-1.0, 0.5):
        C = unbounded_compliance(curvature, np.array([0.1, 1.0]), 6, Fineness(0.05, 2.0))
        assert np.array_equal(C, C.swapaxes(-1, -2))
        assert np.linalg.eigvalsh(C).min() > 0


def test_scaled_body_has_the_same_compliance():
    fineness = Fineness(0.02, 2.0)
    once = unbounded_compliance(-0.4, np.array([0.2, 0.5]), 4, fineness)
    twice = unbounded_compliance(-0.2, np.array([0.4, 1.0]), 4, Fineness(0.02, 2.0, 2 * fineness.coarsest))
    assert twice == pytest.approx(once, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("curvature", [-0.8, 0.0, 0.4])
def test_compliance_does_not_depend_on_poissons_ratio(curvature):
    lengths = np.array([0.3, 1.0])
    for direction in (0, 1):
        body = unbounded_body(curvature, lengths, Fineness(0.01), direction)
        loads = legendre_loads(body.line_eta, lengths[-1], 3)
        compliance = []
        for nu in (-0.5, 0.0, 0.3, 0.8):
            S = body.factorise(body.stiffness(nu)).line_stiffness(direction)[: len(loads), : len(loads)]
            y = crack_factor(S, loads)
            compliance.append(y.T @ y)
        for C in compliance[1:]:
            # but for the mesh
            assert np.abs(C - compliance[0]).max() < 5e-3 * np.abs(compliance[0]).max()
