"""What the steps of a simulation say of its end: how tough a part can still become."""

import math

import numpy as np
import pytest
import xarray as xr

from slmm.fracture.history import STIFFNESS_COVERS, History, Outcome
from slmm.fracture.simulation import simulate
from slmm.scene.gallery import tensile_plate

INCREMENT, LARGEST = 4.0, 2.0


@pytest.fixture(scope="module")
def scene():
    """The crack runs into a hole, and starts anew behind it at twice the displacement."""
    return tensile_plate([(40.0, 40.0, 8.0)])


@pytest.fixture(scope="module")
def whole(scene):
    return simulate(scene, INCREMENT, largest_displacement=LARGEST, errors=False)


def bounds(result):
    """Before each step, mJ, from F(u) alone."""
    u = np.concatenate([[0.0], result.u_load.values[:-1]])
    S = result.stiffness.values
    so_far = np.concatenate([[0.0], np.cumsum(S * (result.u_load.values**2 - u**2) / 2)[:-1]])
    return so_far + S * (LARGEST**2 - u**2) / 2


def test_a_part_without_steps_is_at_most_as_tough_as_if_it_never_broke():
    history = History(last_stiffness=3000.0)
    assert history.toughness_at_most(2.0) == pytest.approx((1 + STIFFNESS_COVERS) * 6000.0)
    assert history.toughness_at_most(0.0) == 0.0


def test_no_step_makes_the_part_stiffer_and_the_bound_comes_down_to_the_toughness(whole):
    """From 2 mm of a line to nothing that is left; the stiffness is good to 1e-4 at worst."""
    assert (np.diff(whole.stiffness.values) < 1e-4 * float(whole.stiffness[0])).all()
    at_most = bounds(whole)
    assert (np.diff(at_most) < 1e-4 * at_most[0]).all()
    assert (at_most * (1 + STIFFNESS_COVERS) > float(whole.U_T)).all()


def test_a_toughness_that_is_reached_changes_nothing(scene, whole):
    reached = simulate(
        scene, INCREMENT, largest_displacement=LARGEST, at_least=float(whole.U_T), errors=False
    )
    xr.testing.assert_identical(reached, whole)


def test_a_toughness_that_is_out_of_reach_ends_it_early_with_the_same_steps(scene, whole):
    at_most = bounds(whole)
    asked = math.sqrt(at_most[-2] * at_most[-1])
    short = simulate(scene, INCREMENT, largest_displacement=LARGEST, at_least=asked, errors=False)
    assert asked > float(whole.U_T)
    assert short.attrs["outcome"] == Outcome.SHORT
    assert short.sizes["step"] == whole.sizes["step"] - 1
    assert float(short.U_T) <= float(whole.U_T)
    np.testing.assert_array_equal(short.u_c, whole.u_c[:-1])


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"at_least": -1.0}, "at_least = -1.0: must be a toughness"),
        ({"at_least": math.inf, "largest_displacement": 1.0}, "at_least = inf: must be a toughness"),
        ({"at_least": 100.0}, "at_least = 100.0: needs a largest displacement"),
    ],
)
def test_what_cannot_be_asked_for_is_refused(scene, asked, words):
    with pytest.raises(ValueError, match=words):
        simulate(scene, **asked)


def test_it_is_resumed_as_it_was_asked(scene, whole, tmp_path):
    asked = math.sqrt(np.prod(bounds(whole)[-2:]))
    options = {"largest_displacement": LARGEST, "at_least": asked, "errors": False}
    journal = tmp_path / "run.jsonl"
    short = simulate(scene, INCREMENT, journal=journal, **options)
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-2]))
    xr.testing.assert_identical(simulate(scene, INCREMENT, journal=journal, resume=True, **options), short)
    with pytest.raises(ValueError, match="another"):
        simulate(scene, INCREMENT, journal=journal, resume=True, largest_displacement=LARGEST, errors=False)
