"""Williams' series: eigenvalues, fields that obey elasticity, and the crack on a notch's bisector."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import gamma as gamma_function

from slmm.mechanics.williams import (
    decaying_fields,
    exponents,
    half_angle,
    release_coefficient,
    singular_exponent,
    williams_fields,
)

E, NU = 3.0, 0.35
OPENINGS = st.floats(0.0, np.pi)
#: a crack, notches with real and complex exponents, one beside lambda_2 = 1, the straight edge
ANGLES = np.radians([0.0, 7.0, 30.0, 60.0, 90.0, 102.0, 135.0, 170.0, 180.0])


def all_fields(opening):
    return [
        field
        for symmetric in (True, False)
        for field in williams_fields(opening, symmetric, 5) + decaying_fields(opening, symmetric, 2)
    ]


def cartesian_stress(field, x, y):
    """sigma_xx, sigma_yy, sigma_xy; x along the bisector."""
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    rr, tt, rt = field.stress(r, theta)
    c, s = np.cos(theta), np.sin(theta)
    return np.array(
        [
            rr * c**2 + tt * s**2 - 2 * rt * s * c,
            rr * s**2 + tt * c**2 + 2 * rt * s * c,
            (rr - tt) * s * c + rt * (c**2 - s**2),
        ]
    )


def slopes(f, x, y, h=1e-3):
    """Derivatives of f along x and y by central differences of fourth order."""

    def difference(dx, dy):
        return (
            8 * (f(x + dx, y + dy) - f(x - dx, y - dy))
            - f(x + 2 * dx, y + 2 * dy)
            + f(x - 2 * dx, y - 2 * dy)
        ) / (12 * h)

    return difference(h, 0.0), difference(0.0, h)


def points(opening, n=40):
    random = np.random.default_rng(1)
    r, theta = random.uniform(0.7, 1.5, n), random.uniform(-0.98, 0.98, n) * half_angle(opening)
    return r * np.cos(theta), r * np.sin(theta)


@pytest.mark.parametrize(
    ("degrees", "expected"),
    [(0, 0.5), (30, 0.5015), (60, 0.5122), (90, 0.5445), (120, 0.6157), (150, 0.7520)],
)
def test_exponent_of_mode_1_is_the_published_one(degrees, expected):
    """The table that goes back to Williams (1952), in Leguillon (2002) and in every paper on V-notches."""
    assert singular_exponent(np.radians(degrees)) == pytest.approx(expected, abs=6e-5)


def test_exponent_of_mode_2_at_a_right_angle_and_where_it_ceases_to_be_singular():
    assert singular_exponent(np.pi / 2, symmetric=False) == pytest.approx(0.9085, abs=6e-5)
    # lambda_2 = 1 is a double root where tan 2 gamma = 2 gamma: 257.45 degrees of material
    critical = 2 * np.pi - 4.493409457909064
    assert singular_exponent(critical - 1e-3, symmetric=False) < 1
    assert singular_exponent(critical + 1e-3, symmetric=False) > 1


@given(opening=OPENINGS, symmetric=st.booleans())
def test_exponents_solve_the_characteristic_equation_and_ascend(opening, symmetric):
    gamma, lam = half_angle(opening), exponents(opening, symmetric, 8)
    residual = np.sin(2 * lam * gamma) + (1 if symmetric else -1) * lam * np.sin(2 * gamma)
    assert np.abs(residual).max() < 1e-10
    assert np.all(np.diff(lam.real) > -1e-9)
    assert lam[0].imag == 0
    assert 0.5 <= lam[0].real <= (1 if symmetric else 2) + 1e-12


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("opening", ANGLES[1:-1])
def test_no_exponent_is_missed(opening, symmetric):
    """The argument of an analytic function turns once around a contour for every root within."""
    gamma, lam = half_angle(opening), exponents(opening, symmetric, 12)
    right, top = 0.5 * (lam[7].real + lam[8].real), 2.0
    corners = np.array([0.05, right, right + 1j * top, 0.05 + 1j * top]) - 1j * np.array([top, top, 0, 0])
    path = np.concatenate(
        [a + (b - a) * np.linspace(0, 1, 4000) for a, b in zip(corners, np.roll(corners, -1), strict=True)]
    )
    value = np.sin(2 * path * gamma) + (1 if symmetric else -1) * path * np.sin(2 * gamma)
    turns = np.unwrap(np.angle(value))
    found = lam[:8]
    rotation = 0 if symmetric else 1  # lambda = 1, a rigid rotation, is left out
    expected = np.sum(np.where(found.imag > 0, 2, 1)) + rotation
    assert round((turns[-1] - turns[0]) / (2 * np.pi)) == expected


@pytest.mark.parametrize("opening", ANGLES)
def test_flanks_carry_no_traction(opening):
    for field in all_fields(opening):
        for side in (-1, 1):
            _, normal, shear = field.stress(np.array(0.8), np.array(side * half_angle(opening)))
            scale = np.abs(field.stress(np.full(9, 0.8), np.linspace(-1, 1, 9))).max()
            assert max(abs(normal), abs(shear)) < 1e-10 * scale


@pytest.mark.parametrize("opening", ANGLES)
def test_stresses_are_in_equilibrium(opening):
    x, y = points(opening)
    for field in all_fields(opening):
        along, across = slopes(lambda x, y, field=field: cartesian_stress(field, x, y), x, y)
        force = np.array([along[0] + across[2], along[2] + across[1]])
        assert np.abs(force).max() < 1e-7 * np.abs(cartesian_stress(field, x, y)).max()


@pytest.mark.parametrize("opening", ANGLES)
def test_displacements_strain_as_the_stresses_demand(opening):
    x, y = points(opening)
    for field in all_fields(opening):

        def u(x, y, field=field):
            return field.displacement(np.hypot(x, y), np.arctan2(y, x), E, NU)

        along, across = slopes(u, x, y)
        strain = np.array([along[0], across[1], along[1] + across[0]])
        xx, yy, xy = cartesian_stress(field, x, y)
        expected = np.array([xx - NU * yy, yy - NU * xx, 2 * (1 + NU) * xy]) / E
        assert np.abs(strain - expected).max() < 1e-7 * np.abs(np.array([along, across])).max()


@given(opening=OPENINGS, r=st.floats(1e-3, 1e3))
def test_singular_terms_carry_unit_stress_on_the_bisector(opening, r):
    first = williams_fields(opening, True, 1)[0]
    assert first.stress(np.array(r), np.array(0.0))[1] == pytest.approx(
        r ** (singular_exponent(opening) - 1), rel=1e-9
    )
    second = williams_fields(opening, False, 1)[0]
    shear = r ** (second.exponent.real - 1)
    assert second.stress(np.array(r), np.array(0.0))[2] == pytest.approx(shear, rel=1e-6)


def test_without_opening_it_is_the_field_of_a_crack():
    """Westergaard's K-field, k = K/sqrt(2 pi)."""
    r, theta = np.linspace(0.2, 3.0, 25), np.linspace(-3.1, 3.1, 25)
    kappa, mu = (3 - NU) / (1 + NU), E / (2 * (1 + NU))
    c, s = np.cos(theta / 2), np.sin(theta / 2)
    scale = np.sqrt(r) / (2 * mu)  # K sqrt(r/(2 pi))/(2 mu) with K = sqrt(2 pi)
    mode_1 = scale * np.array([c * (kappa - 1 + 2 * s**2), s * (kappa + 1 - 2 * c**2)])
    mode_2 = scale * np.array([s * (kappa + 1 + 2 * c**2), -c * (kappa - 1 - 2 * s**2)])
    assert williams_fields(0.0, True, 1)[0].displacement(r, theta, E, NU) == pytest.approx(mode_1, abs=1e-12)
    assert williams_fields(0.0, False, 1)[0].displacement(r, theta, E, NU) == pytest.approx(mode_2, abs=1e-12)
    T_stress = cartesian_stress(williams_fields(0.0, True, 2)[1], r * np.cos(theta), r * np.sin(theta))
    assert T_stress == pytest.approx(np.array([T_stress[0, 0], 0, 0])[:, None] * np.ones(25), abs=1e-12)


def test_straight_edge_is_in_uniform_tension_first():
    x, y = points(np.pi)
    expected = np.array([0.0, 1.0, 0.0])[:, None] * np.ones(len(x))
    assert cartesian_stress(williams_fields(np.pi, True, 1)[0], x, y) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("opening", ANGLES[:6])
def test_decaying_terms_do_work_on_the_term_of_their_own_exponent_only(opening, symmetric):
    """Betti's reciprocal integral over an arc does not depend on its radius, though each term has its power of r."""
    x, w = np.polynomial.legendre.leggauss(60)
    theta = half_angle(opening) * x
    c, s = np.cos(theta), np.sin(theta)

    def traction_and_displacement(field):
        rr, _, rt = field.stress(np.ones(60), theta)
        return np.array([rr * c - rt * s, rr * s + rt * c]), field.displacement(np.ones(60), theta, E, NU)

    series = [traction_and_displacement(field) for field in williams_fields(opening, symmetric, 3)]
    decaying = [traction_and_displacement(field) for field in decaying_fields(opening, symmetric, 3)]
    work = np.array([[np.sum(w * (t * v - q * u)) for q, v in decaying] for t, u in series])
    size = np.abs(np.diag(work))
    assert size.min() > 1e-3
    assert np.abs(work - np.diag(np.diag(work))).max() < 1e-9 * size.max()


def test_edge_crack_is_koiters():
    """K = 1.1215222 sigma sqrt(pi a) for a crack in a half plane (Koiter's solution, to eight digits)."""
    K_squared = 2 * release_coefficient(np.pi)  # lambda = 1
    assert np.sqrt(K_squared / np.pi) == pytest.approx(1.1215222, abs=1e-7)


@pytest.mark.parametrize("symmetric", [True, False])
def test_crack_at_a_crack_releases_griffiths_energy(symmetric):
    assert release_coefficient(0.0, symmetric) == pytest.approx(2 * np.pi, rel=1e-12)


@given(opening=OPENINGS, symmetric=st.booleans())
def test_factorisation_integral_is_resolved(opening, symmetric):
    gamma, lam, sign = half_angle(opening), singular_exponent(opening, symmetric), 1 if symmetric else -1

    def integrand(t):
        H = np.tanh(np.pi * t) * (np.sinh(2 * gamma * t) + sign * t * np.sin(2 * gamma))
        H /= 2 * (np.sinh(gamma * t) ** 2 - (t * np.sin(gamma)) ** 2)
        return lam * np.log(H) / (lam**2 + t**2)

    exponent = quad(integrand, 1e-9, 10.0, epsabs=1e-11, limit=200)[0] / np.pi
    K = np.sqrt(2) * gamma_function(lam) / gamma_function(lam + 0.5) * np.exp(exponent)
    assert release_coefficient(opening, symmetric) == pytest.approx(K**2 / (2 * lam), rel=1e-7)


@given(opening=st.floats(0.0, np.pi - 0.01), step=st.floats(0.001, 0.01))
def test_wider_notches_release_less(opening, step):
    assert release_coefficient(opening + step) < release_coefficient(opening)
    assert release_coefficient(opening + step, False) < release_coefficient(opening, False)


@pytest.mark.parametrize("opening", [-0.1, 3.2, np.nan, 180.0])
def test_impossible_opening_is_named(opening):
    with pytest.raises(ValueError, match=r"opening = .*from 0 \(crack\) to pi"):
        singular_exponent(opening)
