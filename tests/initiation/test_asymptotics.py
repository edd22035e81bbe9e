"""Matched asymptotics: intensities from a displacement field, curves of sharp notches and their criterion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm import Material, coupled_criterion
from slmm.initiation.asymptotics import critical_intensity, generalised_intensity, sharp_curves
from slmm.initiation.blunted import blunted_curves
from slmm.mechanics.williams import (
    decaying_fields,
    singular_exponent,
    williams_fields,
)

E, NU = 3000.0, 0.35
TIP, DIRECTION = np.array([3.0, -2.0]), np.array([1.0, 2.0])
#: at 102.55 degrees the second term is all but a rotation
ANGLES = np.radians([0.0, 20.0, 60.0, 90.0, 102.55, 135.0])
PMMA = Material.from_name("PMMA")


def notch_displacement(opening, k_1, k_2, regular=0.0, decaying=0.0, tip=TIP, direction=DIRECTION):
    """Displacements around a notch: singular, regular and decaying terms, and a rigid motion."""
    axes = np.array([direction, [-direction[1], direction[0]]]) / np.linalg.norm(direction)
    terms = []
    for symmetric, k in ((True, k_1), (False, k_2)):
        first, *others = williams_fields(opening, symmetric, 4)
        terms += [(k, first), *((regular * (1 + 0.5j) / (1 + n), field) for n, field in enumerate(others))]
        terms += [(decaying * (1 - 0.3j), field) for field in decaying_fields(opening, symmetric, 2)]

    def displacement(points):
        local = (points - tip) @ axes.T
        r, theta = np.hypot(*local.T), np.arctan2(local[:, 1], local[:, 0])
        u = sum(np.real(amplitude * field.displacement(r, theta, E, NU)) for amplitude, field in terms)
        return u.T @ axes + [0.2, -0.1] + 0.03 * np.stack([-points[:, 1], points[:, 0]], axis=1)

    return displacement


def fitted(opening, displacement, inner=0.5, outer=2.0, **options):
    return generalised_intensity(displacement, TIP, DIRECTION, opening, E, NU, inner, outer, **options)


@pytest.mark.parametrize("opening", ANGLES)
def test_intensities_are_found_exactly_among_regular_terms(opening):
    k = fitted(opening, notch_displacement(opening, 12.0, -5.0, regular=20.0))
    assert (k.k_1, k.k_2) == pytest.approx((12.0, -5.0), rel=1e-7)
    assert k.misfit < 1e-9


@pytest.mark.parametrize("opening", ANGLES)
def test_disturbance_at_the_tip_is_told_from_the_load(opening):
    field = notch_displacement(opening, 12.0, -5.0, regular=20.0, decaying=1.0)
    k = fitted(opening, field)
    assert (k.k_1, k.k_2) == pytest.approx((12.0, -5.0), rel=1e-7)
    blind = fitted(opening, field, decaying=0)
    assert abs(blind.k_1 - 12.0) > 0.05
    assert blind.misfit > 1e-3


def test_intensities_of_a_crack_are_those_of_fracture_mechanics():
    """K = sigma sqrt(pi a), tau sqrt(pi a) in Muskhelishvili's field of a crack in a sheet under tension and shear."""
    a, sigma, tau, mu, kappa = 1.0, 7.0, 4.0, E / (2 * (1 + NU)), (3 - NU) / (1 + NU)

    def displacement(points):
        z = points[:, 0] + 1j * points[:, 1]
        root, p = np.sqrt(z - a) * np.sqrt(z + a), 0.5 * (sigma - 1j * tau)
        phi, mirrored, slope = p * (root - z), p * np.conj(root - z), p * (z / root - 1)
        w = (kappa * phi - mirrored - (z - np.conj(z)) * np.conj(slope)) / (2 * mu)  # loads on the faces
        w += tau * z.imag / mu + sigma / E * (1j * z.imag - NU * z.real)  # the uniform stress that frees them
        return np.stack([w.real, w.imag], axis=1)

    k = generalised_intensity(displacement, (a, 0.0), (1.0, 0.0), 0.0, E, NU, 0.05, 0.3, terms=8)
    K = np.sqrt(2 * np.pi) * np.array([k.k_1, k.k_2])
    assert pytest.approx(np.array([sigma, tau]) * np.sqrt(np.pi * a), rel=1e-5) == K


@given(
    degrees=st.floats(0.0, 150.0),
    turn=st.floats(-np.pi, np.pi),
    x=st.floats(-50.0, 50.0),
    k_1=st.floats(-20.0, 20.0),
)
def test_place_and_direction_of_the_notch_do_not_matter(degrees, turn, x, k_1):
    opening, tip, direction = (
        np.radians(degrees),
        np.array([x, 1.0]),
        0.1 * np.array([np.cos(turn), np.sin(turn)]),
    )
    field = notch_displacement(opening, k_1, 2.0, regular=5.0, tip=tip, direction=direction)
    k = generalised_intensity(field, tip, direction, opening, E, NU, 0.5, 2.0)
    assert k.k_1 == pytest.approx(k_1, abs=1e-6)


def test_error_estimate_covers_noise_and_terms_left_out():
    random = np.random.default_rng(0)
    for opening in ANGLES[:4]:
        clean = notch_displacement(opening, 12.0, -5.0)

        def noisy(points, clean=clean):
            return clean(points) + random.normal(scale=2e-5, size=points.shape)

        cut_off = fitted(opening, notch_displacement(opening, 12.0, -5.0, regular=1.0), terms=3)
        for k, largest in ((fitted(opening, noisy), 0.2), (cut_off, 2.0)):
            assert k.misfit > 1e-5
            assert abs(k.k_1 - 12.0) < 2 * k.error_1 < largest
            assert abs(k.k_2 + 5.0) < 2 * k.error_2 < largest


def test_points_stay_in_the_material():
    opening = np.radians(90)
    field = notch_displacement(opening, 1.0, 0.0)

    def material_only(points):
        local = (points - TIP) @ np.array([[1, 2], [-2, 1]]).T / np.sqrt(5)
        theta = np.arctan2(local[:, 1], local[:, 0])
        assert np.abs(theta).max() < np.pi - opening / 2
        assert np.hypot(*local.T).min() > 0.5 - 1e-9 and np.hypot(*local.T).max() < 2.0 + 1e-9
        return field(points)

    assert fitted(opening, material_only).k_1 == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"inner": 2.0}, "0 < inner < outer"),
        ({"inner": 0.0}, "0 < inner < outer"),
        ({"terms": 1}, "terms = 1"),
        ({"rings": 2, "rays": 3}, "more rings or rays"),
        ({"direction": (0.0, 0.0)}, "direction"),
        ({"opening": -1.0}, "opening = -1.0"),
        ({"displacement": lambda points: np.full_like(points, np.nan)}, "not finite 0.5 mm from the tip"),
        ({"displacement": lambda points: points[:, 0]}, "shape"),
    ],
)
def test_impossible_fits_are_named(change, named):
    given_ = {
        "displacement": notch_displacement(1.0, 1.0, 0.0),
        "tip": TIP,
        "direction": DIRECTION,
        "opening": 1.0,
        "E": E,
        "nu": NU,
        "inner": 0.5,
        "outer": 2.0,
    }
    with pytest.raises(ValueError, match=named):
        generalised_intensity(**(given_ | change))


def test_mixed_loads_at_a_crack_add_their_energies():
    K_I, K_II = 30.0, 40.0
    G, stress = sharp_curves([0.1, 3.0], K_I / np.sqrt(2 * np.pi), K_II / np.sqrt(2 * np.pi), 0.0, E)
    assert pytest.approx(np.full(2, (K_I**2 + K_II**2) / E), rel=1e-12) == G
    # equal normal stresses K_I/sqrt(2 pi r) and the shear K_II/sqrt(2 pi r)
    assert stress == pytest.approx((K_I + K_II) / np.sqrt(2 * np.pi * np.array([0.1, 3.0])), rel=1e-12)


@pytest.mark.parametrize("opening", ANGLES)
def test_closed_crack_releases_shear_energy_only(opening):
    a = np.array([0.1, 1.0])
    pressed, shear = sharp_curves(a, -5.0, 2.0, opening, E)[0], sharp_curves(a, 0.0, 2.0, opening, E)[0]
    assert np.array_equal(pressed, shear)
    assert np.all(blunted_curves(a, -5.0, 0.3, opening, E)[0] == 0)


def test_stress_is_infinite_at_a_sharp_tip():
    with pytest.raises(ValueError, match=r"a = .*0\.0.*: must be positive"):
        sharp_curves([0.0, 1.0], 1.0, 0.0, 1.0, E)


@pytest.mark.parametrize("opening", ANGLES)
def test_closed_form_is_what_the_coupled_criterion_finds(opening):
    critical = critical_intensity(opening, PMMA)
    a = np.geomspace(1e-3, 6.0, 2000) * critical.crack_length
    result = coupled_criterion(a, *sharp_curves(a, 1.0, 0.0, opening, PMMA.E), PMMA)
    assert result.load_factor == pytest.approx(critical.k_1, rel=1e-4)
    if opening > 0.5:
        assert result.governed_by == "stress and energy"
        assert result.crack_length == pytest.approx(critical.crack_length, rel=1e-2)


@pytest.mark.parametrize("state", ["plane stress", "plane strain"])
def test_criterion_reaches_from_toughness_to_strength(state):
    material = Material.from_name("PMMA", state)
    crack, edge = critical_intensity(0.0, material), critical_intensity(np.pi, material)
    assert crack.k_1 == pytest.approx(material.K_Ic / np.sqrt(2 * np.pi), rel=1e-12)
    assert edge.k_1 == pytest.approx(material.sigma_c, rel=1e-12)
    # 1.12152^2 pi/2 sigma_c^2 a/E' = G_c
    assert edge.crack_length == pytest.approx(material.irwin_length / (1.12152**2 * np.pi / 2), rel=1e-4)


@given(opening=st.floats(0.0, np.pi), scale=st.floats(0.1, 10.0))
def test_critical_intensity_follows_from_dimensions(opening, scale):
    """A tougher material, l_ch times scale, cracks at k_1c times scale^(1 - lambda): the k_1 of larger lengths."""
    tougher = Material(PMMA.E, PMMA.nu, PMMA.sigma_c, scale * PMMA.G_c)
    ratio = critical_intensity(opening, tougher).k_1 / critical_intensity(opening, PMMA).k_1
    assert ratio == pytest.approx(scale ** (1 - singular_exponent(opening)), rel=1e-9)
