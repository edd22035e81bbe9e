"""Curves of rounded V-notches, between the sharp notch and the straight edge."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from slmm import Material, coupled_criterion
from slmm.initiation.asymptotics import critical_intensity, sharp_curves
from slmm.initiation.blunted import blunted_curves, intensity_from_root_stress
from slmm.mechanics.williams import (
    release_coefficient,
    singular_exponent,
)

E = 3000.0
#: at 102.55 degrees the second term is all but a rotation
ANGLES = np.radians([0.0, 20.0, 60.0, 90.0, 102.55, 135.0])
PMMA = Material.from_name("PMMA")


@given(opening=st.floats(0.0, np.pi - 0.01), scale=st.floats(1e-3, 1e3))
def test_size_scales_the_crack(opening, scale):
    """The same notch, larger: the same stress at scaled distances, energy in proportion."""
    a, lam = np.array([0.0, 0.03, 0.5, 40.0, 900.0]), singular_exponent(opening)
    G, stress = blunted_curves(a, 10.0, 0.7, opening, E)
    k_1 = 10.0 * scale ** (1 - lam)
    G_large, stress_large = blunted_curves(scale * a, k_1, scale * 0.7, opening, E)
    assert stress_large == pytest.approx(stress, rel=1e-9)
    assert G_large == pytest.approx(scale * G, rel=1e-9, abs=1e-300)


@pytest.mark.parametrize("opening", [*ANGLES, np.radians(165.0)])
def test_rounding_is_forgotten_far_away(opening):
    """In proportion to 1/a, within the table and beyond it."""
    a = np.array([25.0, 50.0, 100.0, 200.0, 400.0, 4000.0])
    rounded, sharp = blunted_curves(a, 1.0, 1.0, opening, E), sharp_curves(a, 1.0, 0.0, opening, E)
    for near, far in zip(rounded, sharp, strict=True):
        excess = near / far - 1
        assert abs(excess[-1]) < 3e-4
        assert np.abs(excess * a).max() < 1.3 * np.abs(excess * a).min() + 0.02


@pytest.mark.parametrize("opening", [*ANGLES, np.radians(165.0), np.pi])
def test_short_crack_sees_a_straight_edge(opening):
    """G_inc/a tends to 1.12152^2 pi/2 sigma_max^2/E, and less where the stress falls."""
    G, stress = blunted_curves(np.array([0.0, 1e-4, 0.1, 0.2]), 10.0, 1.0, opening, E)
    edge = release_coefficient(np.pi) * stress[0] ** 2 / E
    assert G[1] / 1e-4 == pytest.approx(edge, rel=1e-3)
    assert edge * (1 + 1e-9) >= G[2] / 0.1 >= G[3] / 0.2


def test_stress_intensity_of_a_short_crack_at_a_u_notch_follows_lukas_and_klesnil():
    """K = 1.1215 sigma_max sqrt(pi a/(1 + 4.5 a/rho)), Mater. Sci. Eng. 34 (1978) 61-66, good to a few per cent."""
    a = np.linspace(0.0, 0.5, 401)
    G_inc, stress = blunted_curves(a, 1.0, 1.0, 0.0, 1.0)
    K = np.sqrt(CubicSpline(a, a * G_inc)(a[10:], 1))
    published = 1.1215 * stress[0] * np.sqrt(np.pi * a[10:] / (1 + 4.5 * a[10:]))
    assert np.abs(K / published - 1).max() < 0.025


def test_root_of_a_u_notch_carries_more_than_that_of_a_parabola():
    """Creager and Paris (1967) have 2 K/sqrt(pi rho) at a slender parabola; the constant radius adds 5 to 6 %."""
    root = blunted_curves(np.array([0.0]), 1.0, 1.0, 0.0, E)[1][0]
    assert 1.05 < root / (2 * np.sqrt(2)) < 1.06


@given(degrees=st.floats(0.0, 180.0), radius=st.floats(1e-3, 1e3), sigma=st.floats(0.1, 1e3))
def test_root_stress_and_intensity_convert_into_each_other(degrees, radius, sigma):
    opening = np.radians(degrees)
    k_1 = intensity_from_root_stress(sigma, radius, opening)
    assert blunted_curves([0.0, 1.0], k_1, radius, opening, E)[1][0] == pytest.approx(sigma, rel=1e-9)


@given(opening=st.floats(0.0, np.pi))
def test_energy_grows_and_stress_falls_along_the_path(opening):
    a = np.concatenate([[0.0], np.geomspace(1e-3, 1e4, 400)])
    energy_rate, stress = blunted_curves(a, 1.0, 1.0, opening, E)
    assert np.all(np.diff(a * energy_rate) > 0)
    assert np.all(np.diff(stress) <= 1e-12)


@pytest.mark.parametrize("degrees", [0.0, 45.0, 90.0, 135.0])
def test_criterion_passes_from_the_sharp_notch_to_the_strength_as_the_root_grows(degrees):
    opening = np.radians(degrees)

    def critical(radius):
        a = np.concatenate([[0.0], np.geomspace(1e-4, 20.0, 1500) * PMMA.irwin_length])
        return coupled_criterion(a, *blunted_curves(a, 1.0, radius, opening, PMMA.E), PMMA).load_factor

    l_ch = PMMA.irwin_length
    sharp = critical_intensity(opening, PMMA).k_1
    assert critical(1e-4 * l_ch) == pytest.approx(sharp, rel=2e-3)
    large = 1000 * l_ch
    assert critical(large) == pytest.approx(
        intensity_from_root_stress(PMMA.sigma_c, large, opening), rel=5e-3
    )
    growing = [critical(radius * l_ch) for radius in (0.01, 0.1, 1.0, 10.0)]
    assert np.all(np.diff([sharp, *growing]) > 0)


def test_principal_stress_under_pressure_is_the_one_along_the_path():
    stress = blunted_curves(np.array([0.0, 0.5]), -3.0, 1.0, 1.0, E)[1]
    assert stress[0] == pytest.approx(0.0, abs=1e-4)
    assert stress[1] < 0


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"radius": 0.0}, "radius = 0.0"),
        ({"a": [-1.0, 1.0]}, "a = .*-1.0"),
        ({"opening": 4.0}, "opening = 4.0"),
    ],
)
def test_impossible_notches_are_named(change, named):
    with pytest.raises(ValueError, match=named):
        blunted_curves(**({"a": [0.0, 1.0], "k_1": 1.0, "radius": 1.0, "opening": 1.0, "E": E} | change))
