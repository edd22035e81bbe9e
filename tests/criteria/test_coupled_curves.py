"""Curves along trial paths: the criterion applied to them, and how their errors become one of the index."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm import Material, coupled_criterion
from slmm.criteria.coupled import BOTH, ENERGY, NONE, STRESS, stress_over_crack
from slmm.criteria.coupled_curves import criticals, index_bounds
from slmm.criteria.path_curves import CURVE_POINTS, PathCurves, path_points

#: l_ch = 1 mm
MATERIAL = Material(E=1000.0, nu=0.3, sigma_c=10.0, G_c=0.1)


def curves(a_max, G_inc, sigma_I, G_error=0.0, sigma_error=0.0):
    """Curves (1, CURVE_POINTS) of functions of the length."""
    a = path_points(np.array([a_max]))
    with np.errstate(divide="ignore"):
        values = [
            np.broadcast_to(f(a) if callable(f) else f, a.shape)
            for f in (G_inc, sigma_I, G_error, sigma_error)
        ]
    return PathCurves(a, *(v.astype(float) for v in values))


def straight_edge(a):
    """Energy under a constant stress of 20 MPa, 1.1215^2 pi sigma^2 a/(2 E)."""
    return 1.976 * 400.0 * a / 1000.0


def kirsch(radius, stress=10.0):
    def sigma(a):
        q = radius / (radius + a)
        return stress * (1 + q**2 / 2 + 1.5 * q**4)

    return sigma


def scaled(found, G_by=1.0, sigma_by=1.0):
    return PathCurves(found.a, found.G_inc * G_by, found.sigma_I * sigma_by, found.G_error, found.sigma_error)


def load_factor(found, average=False):
    return float(criticals(found, MATERIAL, average).load_factor[0])


@pytest.mark.parametrize("average", [False, True])
@pytest.mark.parametrize("radius", [0.2, 1.0, 5.0, 100.0])
@pytest.mark.parametrize(("e_G", "e_s"), [(0.01, 0.0), (0.0, 0.01), (0.01, 0.01)])
def test_error_of_the_index_is_its_change_when_the_curves_err_so_much(radius, e_G, e_s, average):
    """Both curves meet at a length that moves as either errs; the formula's slopes against the criterion itself."""
    found = curves(2.0, lambda a: 3.5 * a / (1 + a / radius), kirsch(radius), e_G, e_s)
    critical = criticals(found, MATERIAL, average)
    assert critical.governed_by[0] == BOTH
    up, down = (load_factor(scaled(found, 1 - k * e_G, 1 - k * e_s), average) for k in (1, -1))
    change = 0.5 * np.log(up / down)
    assert change > 0
    # the slopes are taken over the curves around the critical length
    assert float(critical.error[0]) == pytest.approx(change, rel=0.1, abs=1e-5)


def test_where_the_energy_alone_decides_the_index_errs_half_as_much():
    found = curves(3.0, lambda a: 2.0 * a * np.exp(1 - a), 100.0, 0.02, 0.5)
    critical = criticals(found, MATERIAL, False, complete=np.array([True]))
    assert critical.governed_by[0] == ENERGY
    assert critical.error[0] == pytest.approx(0.01)


def test_where_the_stress_alone_decides_the_index_errs_with_the_stress():
    # at a crack tip the energy is there at any length
    found = curves(2.0, 50.0, lambda a: 20.0 - a, 0.5, 0.02)
    critical = criticals(found, MATERIAL, False, complete=np.array([True]))
    assert critical.governed_by[0] == STRESS and critical.crack_length[0] == 0.0
    assert critical.error[0] == pytest.approx(0.02)


def test_errors_where_the_critical_crack_ends_count_and_those_far_away_do_not():
    near = curves(2.0, straight_edge, kirsch(1.0, 20.0), lambda a: np.where(a < 1.3, 0.01, 0.5), 0.01)
    everywhere = curves(2.0, straight_edge, kirsch(1.0, 20.0), 0.01, 0.01)
    found = criticals(near, MATERIAL, False)
    assert found.crack_length[0] < 1.0
    assert found.error[0] == criticals(everywhere, MATERIAL, False).error[0]


def test_no_load_of_this_kind_starts_a_crack_in_compression():
    found = criticals(curves(1.0, straight_edge, -5.0, 0.1, 0.1), MATERIAL, False)
    assert np.isinf(found.load_factor[0]) and np.isnan(found.crack_length[0])
    assert found.governed_by[0] == NONE and found.error[0] == 0.0


def test_without_an_estimate_there_is_no_error():
    found = criticals(curves(2.0, straight_edge, kirsch(1.0), np.nan, np.nan), MATERIAL, False)
    assert np.isfinite(found.load_factor[0]) and np.isnan(found.error[0])


def test_without_curves_there_is_no_value():
    found = criticals(PathCurves.empty(3), MATERIAL, False)
    assert np.isnan(found.load_factor).all() and np.isnan(found.error).all()
    assert np.all(found.governed_by == NONE)


@pytest.mark.parametrize("average", [False, True])
def test_an_open_end_gives_no_value_unless_the_path_is_complete(average):
    """The load found would let the strength be exceeded up to the end: a longer crack could do with less."""
    # a release that falls from its maximum at a = 1, as towards a far edge, under a stress that does not fall
    found = curves(1.6, lambda a: 0.4 * a * (2 - a), 40.0)
    assert np.isnan(criticals(found, MATERIAL, average).load_factor[0])
    complete = criticals(found, MATERIAL, average, complete=np.array([True]))
    assert complete.load_factor[0] == pytest.approx(0.5, rel=1e-3)
    assert complete.crack_length[0] == pytest.approx(1.0, abs=0.02)
    # where the energy still rises at the end, a complete path is severed
    found = curves(0.9, lambda a: 0.4 * a * (2 - a), 40.0)
    severed = criticals(found, MATERIAL, average, complete=np.array([True]))
    assert severed.crack_length[0] == 0.9 and severed.governed_by[0] == ENERGY
    assert severed.load_factor[0] == pytest.approx(np.sqrt(0.1 / (0.4 * 0.9 * 1.1)), rel=1e-6)


@given(radius=st.floats(0.05, 50.0), share=st.floats(0.3, 1.5))
def test_a_value_never_lies_beyond_where_the_strength_is_exceeded_all_along(radius, share):
    found = curves(share, lambda a: 3.5 * a / (1 + a / radius), kirsch(radius))
    critical = criticals(found, MATERIAL, False)
    if np.isfinite(critical.load_factor[0]):
        assert critical.load_factor[0] * found.sigma_I[0, -1] <= MATERIAL.sigma_c * (1 + 1e-8)
        assert critical.crack_length[0] <= found.a[0, -1]


@given(radius=st.floats(0.1, 50.0))
def test_dense_curves_give_what_the_users_own_curves_give(radius):
    found = curves(2.0, straight_edge, kirsch(radius, 20.0))
    ours = criticals(found, MATERIAL, False, complete=np.array([True]))
    a = np.linspace(0, 2.0, 400)
    theirs = coupled_criterion(a, straight_edge(a), kirsch(radius, 20.0)(a), MATERIAL)
    if np.isnan(theirs.load_factor):  # a longer crack might do with less; but a whole path has none
        assert ours.crack_length[0] == 2.0
    else:
        assert ours.load_factor[0] == pytest.approx(theirs.load_factor, rel=1e-4)


@given(exponent=st.floats(0.5, 0.99), missing=st.integers(1, 6), scale=st.floats(0.1, 100.0))
def test_mean_stress_over_a_crack_from_a_singular_mouth(exponent, missing, scale):
    """sigma = k a^(lambda - 1) has the mean sigma(a)/lambda, however many points at the mouth have no value."""
    a = path_points(np.array([scale]))
    with np.errstate(divide="ignore"):
        sigma = 7.0 * a ** (exponent - 1)
    sigma[:, :missing] = np.inf
    mean = stress_over_crack(a, sigma, average=True)
    assert mean.shape == sigma.shape
    assert mean[0, missing:] == pytest.approx(sigma[0, missing:] / exponent, rel=1e-9)


def test_mean_and_least_stress_of_a_smooth_mouth():
    a = path_points(np.array([2.0]))
    mean = stress_over_crack(a, 10 - 2 * a, average=True)
    assert mean == pytest.approx(10 - a)
    rising = stress_over_crack(a, 5 + a, average=False)
    assert np.all(rising == 5.0)


def test_singular_and_smooth_rows_go_together():
    a = path_points(np.array([1.0, 1.0]))
    sigma = np.stack([10 - a[0], np.append(np.inf, 3.0 / np.sqrt(a[1, 1:]))])
    mean = stress_over_crack(a, sigma, average=True)
    assert mean[0] == pytest.approx(10 - a[0] / 2)
    assert mean[1, 1:] == pytest.approx(6.0 / np.sqrt(a[1, 1:]))


def test_path_points_begin_at_the_mouth_and_are_dense_there():
    a = path_points(np.array([2.0, 5.0]))
    assert a.shape == (2, CURVE_POINTS)
    assert np.all(a[:, 0] == 0) and a[:, -1] == pytest.approx([2.0, 5.0])
    assert np.all(np.diff(a, n=2, axis=1) > 0)


def test_curves_of_another_method_take_the_place_of_some_rows():
    found, other = PathCurves.empty(3), curves(1.0, straight_edge, 5.0, 0.1, 0.2)
    found.put(np.array([1]), other)
    assert np.isnan(found.a[[0, 2]]).all()
    for name in ("a", "G_inc", "sigma_I", "G_error", "sigma_error"):
        assert np.array_equal(getattr(found.rows(np.array([1])), name), getattr(other, name))


@given(
    radius=st.floats(0.05, 50.0), share=st.floats(0.05, 0.9), e_G=st.floats(0.0, 0.3), e_s=st.floats(0.0, 0.3)
)
def test_the_index_of_a_whole_path_lies_between_the_bounds_of_its_beginning(radius, share, e_G, e_s):
    """The truth has another energy and stress than the curves, by less than they tell."""

    def energy(a):
        return 3.5 * a / (1 + a / radius)

    whole = scaled(curves(2.0, energy, kirsch(radius)), 1 + e_G / 2, 1 - e_s / 2)
    truth = 1 / criticals(whole, MATERIAL, False, complete=np.array([True])).load_factor[0]
    low, high = index_bounds(curves(2.0 * share, energy, kirsch(radius), e_G, e_s), MATERIAL)
    if np.isfinite(truth):  # else the energy still rises at the end
        # where the stress falls within a few of the points, the two have their own round-off of sampling
        assert low[0] <= truth * (1 + 1e-3) and truth <= high[0] * (1 + 1e-5)


def test_bounds_close_in_as_the_curves_get_longer():
    low, high = zip(
        *(
            index_bounds(curves(end, straight_edge, kirsch(1.0, 20.0), 0, 0), MATERIAL)
            for end in (0.1, 0.3, 0.9)
        ),
        strict=True,
    )
    assert np.all(np.diff(np.ravel(low)) > 0) and np.all(np.diff(np.ravel(high)) < 0)
    assert low[-1] == pytest.approx(high[-1], rel=0.02)


def test_bounds_in_compression_vanish_but_for_the_error_of_the_stress():
    low, high = index_bounds(curves(1.0, straight_edge, -5.0, 0.1, 0.1), MATERIAL)
    assert low[0] == high[0] == 0.0
    low, high = index_bounds(curves(1.0, straight_edge, -0.5, 0.1, 2.0), MATERIAL)
    assert low[0] == 0.0 and high[0] == pytest.approx(0.05)


def test_without_errors_or_curves_there_are_no_bounds():
    for found in (curves(2.0, straight_edge, kirsch(1.0), np.nan, 0.0), PathCurves.empty(1)):
        assert np.isnan(index_bounds(found, MATERIAL)).all()


def test_bounds_at_a_corner_with_infinite_stress():
    a = path_points(np.array([2.0]))
    with np.errstate(divide="ignore"):
        found = PathCurves(a, 0.2 * a**0.1, 10.0 * a**-0.45, 0.01 + 0 * a, 0.01 + 0 * a)
    truth = 1 / criticals(found, MATERIAL, False).load_factor[0]
    low, high = index_bounds(found, MATERIAL)
    assert low[0] < truth < high[0] < 1.1 * low[0]
