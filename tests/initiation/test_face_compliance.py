"""Compliance of crack faces at a hole or an edge, against handbooks, finite elements and its own limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import legendre
from scipy.interpolate import CubicSpline

from slmm.initiation.face_compliance import (
    LONGEST,
    ORDERS,
    compliance,
    face_compliance,
    legendre_coefficients,
)
from slmm.initiation.meta_model import load_meta_model
from slmm.running.cell_file import shipped_database

#: K/(S sqrt(pi L)) of one crack at a circular hole under tension S, by high-order finite elements (1e-4)
L_OVER_R = np.array([0.01, 0.1, 0.2, 0.5, 1.0, 2.0])
ONE_CRACK = np.array([3.2932, 2.7727, 2.3746, 1.7279, 1.3061, 1.0307])


def released(a, radius, stress, mode=0):
    """Energy (n,) for E = 1 of cracks of lengths a (n,) under a stress (function of the depth) on their path."""
    x, w = legendre.leggauss(64)
    x, w = 2 * ((x + 1) / 2) ** 2 - 1, w * (x + 1)  # dense towards the mouth
    at = a[:, None] * (x + 1) / 2
    p = np.einsum("kq,nq->nk", legendre_coefficients(ORDERS, x, w), stress(at))
    return 0.5 * np.einsum("nk,nkl,nl->n", p, face_compliance()(a, radius)[:, mode], p)


def shape_factor(L, radius, stress):
    """K/(S sqrt(pi L)) from the energy: K^2 = E dW/da."""
    a = np.geomspace(0.5 * L.min(), min(1.2 * L.max(), LONGEST * radius), 120)
    energy = CubicSpline(np.log(a), np.log(released(a, radius, stress)))
    K2 = np.exp(energy(np.log(L))) * energy(np.log(L), 1) / L
    return np.sqrt(K2 / (np.pi * L))


def kirsch(radius):
    def stress(eta):
        q = radius / (radius + eta)
        return 1 + q**2 / 2 + 1.5 * q**4

    return stress


@pytest.mark.parametrize("mode", [0, 1])
def test_crack_at_an_edge_under_constant_stress(mode):
    C = face_compliance()(np.array([1.0, 7.0]), np.inf)[:, mode, 0, 0]
    assert np.sqrt(C / (np.pi * np.array([1.0, 49.0]))) == pytest.approx(1.1215223, rel=2e-6)


def test_crack_at_an_edge_under_a_linear_stress():
    """K = 0.439 sigma sqrt(pi a) where the stress falls to zero at the tip (Tada, Paris and Irwin)."""
    F = shape_factor(np.array([1.0]), np.inf, lambda eta: 1 - eta)
    assert pytest.approx(0.439, abs=1e-3) == F


@pytest.mark.parametrize("radius", [0.05, 1.0, 30.0])
def test_one_crack_at_a_circular_hole_in_tension(radius):
    F = shape_factor(L_OVER_R * radius, radius, kirsch(radius))
    assert pytest.approx(ONE_CRACK, rel=1e-4) == F


def test_a_long_crack_is_one_as_long_as_the_hole_and_itself():
    """The hole's end of such a crack is blunt, which matters less and less."""
    L = np.array([5.0, 10.0, 20.0, 40.0])
    excess = shape_factor(L, 1.0, kirsch(1.0)) / np.sqrt((L + 2) / (2 * L)) - 1
    assert np.all(np.diff(excess) < 0) and np.all(excess > 0)
    assert excess[0] < 0.012 and excess[-1] < 0.0025


@pytest.mark.parametrize("mode", [0, 1])
def test_long_cracks_approach_half_the_compliance_of_two_such_cracks_end_to_end(mode):
    """Without the hole the energy is that of a crack with two tips, pi p^2 (a/2)^2/E; the hole adds to it."""
    a = np.array([5.0, 10.0, 20.0, 50.0])
    ratio = face_compliance()(a, 1.0)[:, mode, 0, 0] / (0.5 * np.pi * a**2)
    excess = ratio - 1
    assert np.all(excess > 0) and np.all(np.diff(excess) < 0)
    # it falls about as fast as the crack grows
    assert excess[-1] < 0.13 and np.all(excess[1:] / excess[:-1] < 0.75)


@given(ratio=st.floats(1e-3, LONGEST), mode=st.sampled_from([0, 1]))
def test_compliance_is_symmetric_and_positive_definite(ratio, mode):
    C = face_compliance()(np.array([1.0]), 1 / ratio)[0, mode]
    assert np.abs(C - C.T).max() < 1e-9 * C[0, 0]
    assert np.linalg.eigvalsh(C).min() > 1e-3 * C[0, 0]


@given(ratio=st.floats(1e-3, LONGEST), factor=st.floats(0.01, 100.0))
def test_compliance_goes_with_the_square_of_the_size(ratio, factor):
    one, other = (face_compliance()(np.array([k * ratio]), k)[0] for k in (1.0, factor))
    assert other == pytest.approx(factor**2 * one, rel=1e-9)


@pytest.mark.parametrize("ratio", [1e-3, 0.03, 0.4, 3.0, 49.0])
def test_interpolation_over_the_ratio_loses_nothing(ratio):
    one = face_compliance()(np.array([1.0]), 1 / ratio)[0]
    assert one == pytest.approx(compliance(1 / ratio), abs=1e-9)


@pytest.mark.parametrize("radius", [0.05, 0.5, np.inf])
def test_points_along_the_crack_are_enough(radius):
    once, twice = compliance(radius), compliance(radius, 40)
    assert np.abs(once - twice).max() < 3e-5 * once[0, 0, 0]


def test_a_hole_is_stiffer_than_an_edge_and_the_more_so_the_smaller_it_is():
    a = np.ones(1)
    C = [face_compliance()(a, R)[0, :, 0, 0] for R in (0.05, 0.5, 5.0, 500.0, np.inf)]
    assert np.all(np.diff(C, axis=0) > 0)
    assert C[-2] == pytest.approx(C[-1], rel=5e-3)


def test_compliance_is_that_of_the_databases_finite_elements():
    """The first orders; of the higher ones that mesh has too few elements at its shortest crack."""
    meta = load_meta_model(0.35, shipped_database())
    for curvature, theirs in zip(meta.curvature, meta.compliance, strict=True):
        if curvature > 0:  # no hole and no edge
            continue
        radius = np.inf if curvature == 0 else -0.5 / curvature
        ours = face_compliance()(meta.lengths, radius) / meta.lengths[:, None, None, None] ** 2
        theirs = theirs.swapaxes(0, 1)
        difference = np.abs(ours - theirs) / theirs[..., :1, :1]
        assert difference[..., :4, :4].max() < 7e-4
        assert difference.max() < 4e-3


def test_legendre_coefficients_are_those_of_the_polynomials():
    x, w = legendre.leggauss(12)
    wanted = np.random.default_rng(0).normal(size=6)
    assert legendre_coefficients(6, x, w) @ legendre.legval(x, wanted) == pytest.approx(wanted)
