"""Crack faces that meet: what a crack has released once it has grown into compression stays as it is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.polynomial import legendre

from slmm import failure_indices
from slmm.initiation.contact import NEAR_TIP, tip_opening, until_closed
from slmm.initiation.settings import DEFAULT
from slmm.scene import gallery

pytest.importorskip("netgen")

VALUES = arrays(float, 12, elements=st.floats(-10.0, 10.0, width=32))


def compressed(e_xx, **changes):
    """A hole in a compressed plate: above it the stress across the path is tensile, farther up compressive."""
    changes = {"load": {"strain": [e_xx, -0.1, 0.0]}, **changes}
    return gallery.circular_hole(10.0, 100.0, **changes)


@given(coefficients=arrays(float, 8, elements=st.floats(-1.0, 1.0, width=32)))
def test_opening_is_that_of_the_polynomial_with_these_moments(coefficients):
    x, w = legendre.leggauss(10)
    opening = legendre.legval(x, coefficients)
    moments = legendre.legvander(x, 7).T @ (w * opening)
    expected = legendre.legval(2 * NEAR_TIP - 1, coefficients)
    assert tip_opening(moments) == pytest.approx(2 * expected, abs=1e-9)


@given(energy=VALUES, opening=VALUES)
def test_energy_neither_falls_nor_rises_once_the_tip_has_closed(energy, opening):
    found = until_closed(energy, opening)
    assert np.all(np.diff(found) >= 0) and found[0] >= 0
    closed = np.flatnonzero(opening <= 0)
    if len(closed):
        before = found[closed[0] - 1] if closed[0] else 0.0
        assert np.all(found[closed[0] :] == before)


@given(energy=VALUES, opening=VALUES)
def test_faces_that_touch_never_release_more_than_faces_that_pass_through_each_other(energy, opening):
    assert np.all(until_closed(energy, opening) <= np.maximum.accumulate(np.maximum(energy, 0.0)))


@given(energy=VALUES, opening=VALUES)
def test_each_row_is_judged_alone(energy, opening):
    both = until_closed(np.stack([energy, energy]), np.stack([opening, np.ones(12)]))
    assert np.array_equal(both[0], until_closed(energy, opening))
    assert np.array_equal(both[1], np.maximum.accumulate(np.maximum(energy, 0.0)))


@pytest.fixture(scope="module")
def closing():
    """Curves by full FEA and by dislocations of a crack that grows from tension into compression."""
    from slmm.initiation.body_fitted import solve_body_fitted
    from slmm.initiation.dislocations import DislocationModel
    from slmm.initiation.full_fea import full_fea_curves

    scene = compressed(0.025)
    outline = scene.outlines[0]
    s = float(outline.project(np.array([[50.0, 60.0]]))[0])
    model = DislocationModel(scene, solve_body_fitted(scene))
    dislocations = model.curves([model.trial(outline, s, 12.0)])[0]
    full = full_fea_curves(scene, 0, s, 12.0, n_lengths=24, a_min=0.6)
    return full, dislocations


def test_stress_changes_sign_within_the_path(closing):
    full, _ = closing
    assert full.sigma_I[0] > 100 and full.sigma_I[-1] < -30


def test_the_crack_stays_where_its_tip_closes(closing):
    """Beyond the zero of the stress it opens on, with the tension behind it, but not far."""
    zero = float(np.interp(0.0, -closing[0].sigma_I, closing[0].eta))
    for curves in closing:
        W = curves.a * curves.G_inc
        still = np.flatnonzero(np.diff(W) < 1e-9 * W[-1])[0]
        assert zero < curves.a[still] < 3 * zero
        assert np.ptp(W[still:]) < 1e-9 * W[-1]
        assert np.all(np.diff(W[: still + 1]) > 0)


def test_dislocations_close_as_in_full_fea(closing):
    full, dislocations = closing
    W = full.a * full.G_inc
    ours = np.exp(
        np.interp(np.log(full.a), np.log(dislocations.a), np.log(dislocations.a * dislocations.G_inc))
    )
    assert ours[-1] == pytest.approx(W[-1], rel=5e-3)
    assert ours == pytest.approx(W, rel=0.01)


def test_trial_cracks_close_as_in_full_fea(closing):
    """Beyond the length where mode I vanishes the energy stays; where that is, 24 lengths of full FEA leave open."""
    full, _ = closing
    tough = {"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "K_Ic": 9.5}
    scene = compressed(0.025, material=tough, analysis={"points": [[50.0, 60.0]]})
    ours = failure_indices(scene, "boundary", curves=True).isel(position=0)
    assert ours.status == "ok"
    a = ours.a.values
    W = np.interp(full.a, a, a * ours.G_inc.values)
    assert full.a[-1] < a[-1]
    assert pytest.approx(full.a * full.G_inc, rel=5e-3) == W


def test_a_corner_under_compression_opens_no_crack():
    scene = gallery.square_hole(-0.1, analysis={"points": [[65.0, 65.0]]})
    for method in ("boundary", "full-fea"):
        result = failure_indices(scene, method).isel(position=0)
        assert result.status == "ok" and result.failure_index == 0 == result.failure_index_error


def test_a_tip_that_only_shears_opens_no_crack():
    """An inclined crack under compression has mode II, and a negative mode I, whose faces would overlap."""
    cracks = [{"points": [[15.0, 55.0], [25.0, 65.0]]}]
    scene = gallery.edge_crack(10.0, cracks=cracks, load={"stress": -10.0})
    for result in (failure_indices(scene, method) for method in ("boundary", "auto")):
        assert (result.status == "ok").all() and (result.failure_index == 0).all()


@pytest.mark.parametrize("method", ["slmm", "slmm+ac"])
def test_crack_cells_close_too_unless_the_papers_way_is_asked_for(method):
    scene = compressed(0.015, analysis={"points": [[50.0, 60.0]], "voxels": 90_000})
    touching, passing = (
        failure_indices(scene, method, curves=True, settings=replace(DEFAULT, contact=contact)).isel(
            position=0
        )
        for contact in (True, False)
    )
    a = touching.a.values
    W, without = a * touching.G_inc.values, a * passing.G_inc.values
    assert np.all(np.diff(W) >= -1e-9 * W[-1])
    assert np.all(np.maximum.accumulate(without) * (1 + 1e-9) >= W)
    closed = np.flatnonzero(np.abs(W - without) > 1e-9 * W[-1])[0]
    assert touching.sigma_I[0] > 80 and touching.sigma_I[closed] < 0
    assert np.ptp(W[a > 1.2 * a[closed]]) < 1e-9 * W[-1]
    assert W[closed] > 0.98 * W[-1]
    assert W[-1] < 0.5 * without[-1]
