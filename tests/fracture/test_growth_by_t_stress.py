"""Simulated growth by the generalised criterion: T in the result, straight mode I, forks, and what is refused."""

import numpy as np
import pytest

from slmm.fracture import simulate
from slmm.fracture.directions import direction_of
from slmm.scene.gallery import tensile_plate
from slmm.scene.scene import Scene


def bar_under_tension_along_its_crack(share):
    """An inner crack across a tension of 1 MPa, and a tension along it that adds to T = -1 MPa (x is along it)."""
    sides = [("left", [-share, 0.0]), ("right", [share, 0.0]), ("top", [0.0, 1.0]), ("bottom", [0.0, -1.0])]
    return Scene.from_dict(
        {
            "plate": {"width": 400.0, "height": 400.0},
            "cracks": [{"points": [[190.0, 200.0], [210.0, 200.0]]}],
            "material": {"name": "PMMA"},
            "boundary": [{"on": side, "traction": traction} for side, traction in sides],
        }
    )


@pytest.mark.parametrize("share", [0.0, 2.0])
def test_T_of_a_crack_in_a_wide_plate_is_the_tension_along_it_less_that_across(share):
    result = simulate(
        bar_under_tension_along_its_crack(share),
        20.0,
        direction="GMTS",
        errors=False,
        largest_displacement=1e9,
    )
    K_I, T = float(result.K_I[0]), float(result["T"][0])
    # K_I = sigma sqrt(pi a), but for the plate's width
    assert pytest.approx((share - 1) * K_I / np.sqrt(10 * np.pi), rel=0.02) == T


def test_mode_I_runs_straight_and_beyond_the_bifurcation_it_forks_and_says_so():
    """T sqrt(2 pi r_c) = (share - 1) K_I sqrt(2 r_c/a): beyond 3/8 K_I with 2.5 times the tension along, r_c = a/10."""
    below, beyond = (
        simulate(
            bar_under_tension_along_its_crack(share),
            2.0,
            direction="GMTS",
            critical_distance=1.0,
            errors=False,
            largest_displacement=1e9,
        )
        for share in (1.5, 2.5)
    )
    inside = np.abs(below.crack_x.values[0] - 200.0) < 100.0  # the edges draw the tips later
    assert inside.sum() > 50 and np.ptp(below.crack_y.values[0, inside]) < 1e-3
    way = direction_of("GMTS", bar_under_tension_along_its_crack(1.0).material, 1.0)
    assert not any(
        way.forks(*values)
        for values in zip(below.K_I.values[:10], below.K_II.values[:10], below["T"].values[:10], strict=True)
    )
    assert beyond.attrs["forking_directions"] >= 1
    kink = np.degrees(np.arctan2(abs(float(beyond.y[0]) - 200.0), abs(float(beyond.x[0]) - 200.0) - 10.0))
    assert kink == pytest.approx(np.degrees(abs(way.angle(1.0, 0.0, 1.5 / np.sqrt(10 * np.pi)))), abs=2.0)


def test_the_result_says_with_which_distance():
    result = simulate(tensile_plate(), 20.0, direction="GMTS", critical_distance=0.2, errors=False)
    assert (result.attrs["direction"], result.attrs["critical_distance"]) == ("GMTS", 0.2)
    assert np.isfinite(result["T"].values[result.event.values == "growth"]).all()
    plain = simulate(tensile_plate(), 20.0, errors=False)
    assert np.isnan(plain["T"]).all() and "critical_distance" not in plain.attrs
    assert "forking_directions" not in plain.attrs


def test_a_simulation_by_T_goes_on_where_it_was(tmp_path):
    scene, file = tensile_plate([(40.0, 44.0, 8.0)]), tmp_path / "journal.jsonl"
    whole = simulate(scene, 8.0, direction="GMTS", journal=file, errors=False)
    again = simulate(scene, 8.0, direction="GMTS", journal=file, resume=True, from_step=2, errors=False)
    assert again.identical(whole)


def test_a_distance_without_its_criterion_is_refused():
    with pytest.raises(ValueError, match="belongs to direction"):
        simulate(tensile_plate(), 20.0, critical_distance=0.1)
