"""Where a crack runs: closed and published values, and the kink solved by a singular integral equation."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.fracture.kinking import (
    energy_release_direction,
    kinked_stress_intensities,
    local_symmetry,
    maximum_energy_release_rate,
    maximum_tangential_stress,
    minimum_strain_energy_density,
)
from slmm.mechanics.elasticity import Elasticity

STEEL = Elasticity(210e3, 0.3)


def sih(K_I, K_II):
    return minimum_strain_energy_density(K_I, K_II, STEEL)


CRITERIA = (maximum_tangential_stress, sih, maximum_energy_release_rate, local_symmetry)

#: those that turn an open crack: from pure mode I to pure mode II
phase = st.floats(-math.pi / 2, math.pi / 2)


def kink_by_integral_equation(angle, n=40, grading=8):
    """Stress intensities k_I + i k_II for K_I = 1 and for K_II = 1 (2,) at the tip of a short kink.

    The kink is a row of dislocations from the tip of a semi-infinite crack, whose faces stay free by their images
    (Muskhelishvili's potentials of a cut); their densities take the traction off the kink. The square root at its tip
    is in the quadrature, the weak singularity at the knee is graded away: depth = s^grading.
    """
    j = np.arange(1, n + 1)
    x, weight = np.cos((2 * j - 1) * np.pi / (2 * n + 1)), 2 * np.pi / (2 * n + 1)
    weight = weight * (1 + x) / 2
    source = ((1 + x) / 2) ** grading
    depth = ((1 + np.cos(2 * j * np.pi / (2 * n + 1))) / 2) ** grading
    turn = np.exp(1j * angle)
    z0, z = source * turn, depth[:, None] * turn

    def traction(density):
        """Tangential and shear stress on the kink, as one complex number."""
        A, a, b = density * turn, np.sqrt(z0), np.sqrt(z0.conj())
        dipole = A.conjugate() * (z0 - z0.conj()) / (4 * b)

        def image(z):
            w = np.sqrt(z)
            return -A / 2 / (w * (w + a)) - A / 2 / (w * (w + b)) + dipole / (w * (w + b) ** 2)

        w = np.sqrt(z)
        derivative = A / 2 * (2 * w + a) / (w * (w + a)) ** 2 + A / 2 * (2 * w + b) / (w * (w + b)) ** 2
        derivative = (derivative - dipole * (3 * w + b) / (w**2 * (w + b) ** 3)) / (2 * w)
        here, mirrored = image(z), image(z.conj()).conj()
        direct = 2 * np.conj(density) / (depth[:, None] - source)
        return direct + 2 * here.real + turn**2 * ((z.conj() - z) * derivative + mirrored - here)

    opening, sliding = traction(1.0) * weight, traction(1j) * weight
    system = np.block([[opening.real, sliding.real], [opening.imag, sliding.imag]])
    c, s = math.cos(angle / 2), math.sin(angle / 2)
    found = []
    for along, across in ((c**3, s * c**2), (-3 * s * c**2, c * (1 - 3 * s**2))):
        load = np.outer([along, across], 1 / np.sqrt(2 * np.pi * depth)).ravel()
        density = np.linalg.solve(system, -load)
        at_tip = [np.polynomial.chebyshev.chebfit(x, part, n - 1).sum() for part in density.reshape(2, n)]
        found.append(complex(at_tip[0], -at_tip[1]) * (2 * np.pi) ** 1.5 / math.sqrt(grading))
    return np.array(found)


@pytest.mark.parametrize(
    ("degrees", "within"),
    [(0, 1e-12), (-15, 1e-10), (30, 1e-10), (-45, 1e-9), (-60, 1e-8), (75, 3e-7), (-80, 1e-6), (-90, 1e-5)],
)
def test_stress_intensities_of_a_kink_are_those_of_its_integral_equation(degrees, within):
    angle = math.radians(degrees)
    exact = kink_by_integral_equation(angle)
    series = [complex(*kinked_stress_intensities(*K, angle)) for K in ((1.0, 0.0), (0.0, 1.0))]
    np.testing.assert_allclose(series, exact, rtol=0, atol=within)


@pytest.mark.parametrize(
    ("K", "merr", "gain", "symmetric", "mts"),
    [
        ((1, 0.25), -25.86, 1.1109, -25.87, -25.33),
        ((1, 0.5), -42.03, 1.3343, -42.13, -40.21),
        ((1, 1), -56.57, 1.6680, -56.96, -53.13),
        ((0, 1), -75.76, 1.5172, -77.33, -70.53),
    ],
)
def test_directions_and_released_energy_are_the_published_ones(K, merr, gain, symmetric, mts):
    angle = maximum_energy_release_rate(*K)
    assert math.degrees(angle) == pytest.approx(merr, abs=0.01)
    k = kinked_stress_intensities(*K, angle)
    assert np.dot(k, k) / np.dot(K, K) == pytest.approx(gain, abs=1e-4)
    assert math.degrees(local_symmetry(*K)) == pytest.approx(symmetric, abs=0.01)
    assert math.degrees(maximum_tangential_stress(*K)) == pytest.approx(mts, abs=0.01)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_mode_I_runs_straight_on(criterion):
    assert criterion(3.0, 0.0) == 0.0


def test_pure_shear_has_its_closed_directions():
    assert maximum_tangential_stress(0, 1) == pytest.approx(-math.acos(1 / 3), abs=1e-14)
    # Sih: cos = (kappa - 1)/6, in plane strain (1 - 2 nu)/3
    assert sih(0, 1) == pytest.approx(-math.acos(0.4 / 3), abs=1e-12)
    plate = Elasticity(1.0, 0.25, "plane stress")
    assert minimum_strain_energy_density(0, -2, plate) == pytest.approx(math.acos(1.2 / 6), abs=1e-12)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_small_turns_are_twice_the_ratio_by_all_criteria(criterion):
    for ratio in (1e-4, 1e-8, 1e-13, 1e-16, 1e-100, 5e-324):
        assert criterion(1.0, ratio) == pytest.approx(-2 * ratio, rel=1e-6, abs=0.0)


@given(phase=phase, scale=st.floats(1e-6, 1e6))
@pytest.mark.parametrize("criterion", CRITERIA)
def test_directions_keep_with_scale_and_turn_with_the_sign_of_K_II(criterion, phase, scale):
    K_I, K_II = math.cos(phase), math.sin(phase)
    angle = criterion(K_I, K_II)
    assert angle * K_II <= 0
    assert criterion(scale * K_I, scale * K_II) == pytest.approx(angle, abs=1e-11)
    assert criterion(K_I, -K_II) == pytest.approx(-angle, abs=1e-11)


@given(phase=phase)
def test_no_kink_releases_more_than_the_one_found(phase):
    K = math.cos(phase), math.sin(phase)
    angles = np.linspace(-math.pi / 2, math.pi / 2, 181)
    k = np.array([kinked_stress_intensities(*K, angle) for angle in angles])
    best = kinked_stress_intensities(*K, maximum_energy_release_rate(*K))
    assert (k**2).sum(axis=1)[k[:, 0] > 0].max() <= np.dot(best, best) + 1e-12
    assert best[0] > 0


@given(phase=phase)
def test_kink_of_local_symmetry_is_open_and_without_mode_II(phase):
    K = math.cos(phase), math.sin(phase)
    k_I, k_II = kinked_stress_intensities(*K, local_symmetry(*K))
    assert k_I > 0
    assert abs(k_II) < 1e-12


@given(phase=phase, nu=st.floats(0.05, 0.49))
def test_least_strain_energy_density_is_a_minimum_under_tension(phase, nu):
    K_I, K_II = math.cos(phase), math.sin(phase)
    material = Elasticity(1.0, nu)
    kappa = material.kappa

    def density(t):
        """Sih's factor, times 16 pi mu."""
        c, s = math.cos(t), math.sin(t)
        return (
            (1 + c) * (kappa - c) * K_I**2
            + 2 * s * (2 * c - kappa + 1) * K_I * K_II
            + ((kappa + 1) * (1 - c) + (1 + c) * (3 * c - 1)) * K_II**2
        )

    angle = minimum_strain_energy_density(K_I, K_II, material)
    assert K_I * math.cos(angle / 2) - 3 * K_II * math.sin(angle / 2) > 0
    assert density(angle) <= min(density(angle - 0.02), density(angle + 0.02))


def test_least_of_all_strain_energy_densities_lies_at_the_faces_and_is_not_taken():
    """In mode I the density vanishes at the faces; straight ahead it has a local minimum only."""
    assert sih(1.0, 1e-3) == pytest.approx(-2e-3, rel=1e-3)


@pytest.mark.parametrize("nu", [-0.3, 0.0])
def test_without_lateral_contraction_the_strain_energy_density_tells_no_direction(nu):
    with pytest.raises(ValueError, match=rf"K_I = 2, K_II = 0, nu = {nu:g}: .* no minimum"):
        minimum_strain_energy_density(2.0, 0.0, Elasticity(1.0, nu))


def test_J_points_where_the_tip_would_shift_and_errs_with_mode_II():
    def J(ratio):
        return [1 + ratio**2, -2 * ratio]

    assert energy_release_direction([1.0, 0.0]) == 0.0
    # K_I = 20, K_II = 10 MPa sqrt(m)
    assert math.degrees(energy_release_direction(J(0.5))) == pytest.approx(-38.66, abs=0.005)
    error = [energy_release_direction(J(r)) - maximum_energy_release_rate(1, r) for r in (0.1, 0.5, 1.0)]
    np.testing.assert_allclose(np.degrees(error), [0.05, 3.37, 11.57], atol=0.01)


@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize(
    ("K", "message"),
    [
        ((-1.0, 0.1), r"K_I = -1, K_II = 0.1: the crack is closed"),
        ((-2.0, 0.0), r"K_I = -2, K_II = 0: the crack is closed"),
        ((0.0, 0.0), "the crack has no load"),
        ((math.nan, 1.0), "K_I = nan, K_II = 1.0: must be finite"),
        ((1.0, math.inf), "K_I = 1.0, K_II = inf: must be finite"),
    ],
)
def test_cracks_without_a_direction_are_refused(criterion, K, message):
    with pytest.raises(ValueError, match=message):
        criterion(*K)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_a_little_overlap_is_scatter_of_the_stress_intensities(criterion):
    assert 0 > criterion(0.0, 1.0) > criterion(-1e-3, 1.0) > criterion(0.0, 1.0) - 2e-3


def test_kinks_out_of_reach_and_wrong_vectors_are_refused():
    with pytest.raises(ValueError, match=r"angle = 1.6: must lie within 1.5708 radians"):
        kinked_stress_intensities(1.0, 0.0, 1.6)
    with pytest.raises(ValueError, match="angle = nan"):
        kinked_stress_intensities(1.0, 0.0, math.nan)
    with pytest.raises(ValueError, match=r"J = \[1.0\]: must be two finite numbers"):
        energy_release_direction([1.0])
    with pytest.raises(ValueError, match=r"J = \[1.0, nan\]"):
        energy_release_direction([1.0, math.nan])
    with pytest.raises(ValueError, match=r"J = \[-1.0, 0.0\]: must point ahead"):
        energy_release_direction([-1.0, 0.0])
