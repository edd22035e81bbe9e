"""Matched asymptotics: intensities from a displacement field, curves of sharp and rounded notches."""

import math

import netCDF4
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from slmm import Material, coupled_criterion
from slmm.initiation.asymptotics import critical_intensity, generalised_intensity, sharp_curves
from slmm.initiation.blunted import blunted_curves, intensity_from_root_stress
from slmm.initiation.v_notch_table import SCHEMA, load_v_notches, read_v_notches
from slmm.mechanics.williams import (
    decaying_fields,
    release_coefficient,
    singular_exponent,
    williams_fields,
)
from slmm.running.model_file import DatabaseError, shipped

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


@given(degrees=st.floats(0.0, 180.0))
def test_curves_are_smooth_over_the_opening(degrees):
    """Between stored angles nothing swings: curvature as seen by three angles half a degree apart stays small."""
    a = np.array([0.01, 0.3, 5.0, 90.0])
    angles = np.radians(np.clip(degrees, 0.5, 179.5) + np.array([-0.5, 0.0, 0.5]))
    table = load_v_notches()
    values = [np.log([table.release(o, a), table.bisector_stress(o, a)[0]]) for o in angles]
    assert np.abs(values[0] - 2 * values[1] + values[2]).max() < 2e-3


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


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "v_notches.nc"
    path.write_bytes(shipped("v_notches.nc").read_bytes())
    return path


def test_table_is_read_once_and_anew_when_it_changes(table):
    assert load_v_notches(table) is load_v_notches(table)
    with netCDF4.Dataset(table, "a") as file:
        file["stress"][0, 0, 0] = 2.0
    with pytest.raises(DatabaseError, match="altered"):
        load_v_notches(table)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_truncated_table_is_refused(table, share):
    whole = table.read_bytes()
    table.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(DatabaseError, match="truncated or not a netCDF file"):
        read_v_notches(table)


@pytest.mark.parametrize("name", ["release", "stress", "opening", "length", "sharp_release"])
def test_altered_table_is_refused(table, name):
    with netCDF4.Dataset(table, "a") as file:
        file[name][(0,) * file[name].ndim] += 1e-6
    with pytest.raises(DatabaseError, match="altered"):
        read_v_notches(table)


def test_table_of_another_schema_or_none_is_refused(table, tmp_path):
    with netCDF4.Dataset(table, "a") as file:
        file.schema = SCHEMA + 1
    with pytest.raises(DatabaseError, match="this version reads schema"):
        load_v_notches(table)
    with pytest.raises(DatabaseError, match=r"no such file; `python -m precompute\.v_notch"):
        load_v_notches(tmp_path / "none.nc")


def test_table_without_a_variable_is_refused(table):
    with netCDF4.Dataset(table, "a") as file:
        file.renameVariable("release", "energy")
    with pytest.raises(DatabaseError, match="variable release with dimensions"):
        read_v_notches(table)


def test_shipped_table_reaches_from_crack_to_straight_edge():
    table = load_v_notches()
    assert table.opening[0] == 0 and table.opening[-1] == math.pi
    assert table.length[0] == 0 and table.length[1] <= 0.0103 and table.length[-1] == pytest.approx(100.0)
    assert shipped("v_notches.nc").stat().st_size < 300_000
