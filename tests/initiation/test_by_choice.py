"""Method auto: the cheapest method that is good enough, position by position, and it says why."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.initiation import by_choice
from slmm.initiation.by_choice import BOUNDS, ELSEWHERE, GIVEN, MATTERS, NEGLIGIBLE, NO_FEA
from slmm.scene import gallery

pytest.importorskip("netgen")


def with_irwin_length(scene, l_ch):
    """The scene with a toughness that makes Irwin's length this long."""
    E, sigma_c = 2960.0, 70.5
    return scene.with_(material={"E": E, "nu": 0.35, "sigma_c": sigma_c, "G_c": l_ch * sigma_c**2 / E})


def auto(scene, *points, **options):
    return failure_indices(
        scene.with_(analysis={"points": [list(point) for point in points]}), "auto", **options
    )


HOLE, SIDE = gallery.circular_hole(), (70.0, 50.0)


def many_points(monkeypatch):
    """As of a part with so many outlines that boundary integrals are dear."""
    monkeypatch.setattr(by_choice, "POINTS_AFFORDED", 0)


def test_a_tiny_critical_crack_needs_the_strength_alone(monkeypatch):
    many_points(monkeypatch)
    brittle = with_irwin_length(HOLE, 0.02)
    result = auto(brittle, SIDE).isel(position=0)
    assert result.used_method == "strength" and result.governed_by == "stress"
    stress = failure_indices(brittle.with_(analysis={"points": [SIDE]}), "rankine").failure_index[0]
    assert float(result.failure_index) <= float(stress) * 1.001
    assert "within 2 %" in str(result.reason.values)


def test_a_tighter_tolerance_takes_a_more_costly_method_and_keeps_it(monkeypatch):
    many_points(monkeypatch)
    used = {}
    for tolerance in (0.05, 0.02, 0.001):
        result = auto(with_irwin_length(HOLE, 4.0), SIDE, tolerance=tolerance).isel(position=0)
        used[tolerance] = str(result.used_method.values)
        assert float(result.failure_index_error) <= tolerance * float(result.failure_index)
    assert used[0.05] == "slmm+ac" and used[0.001] == "dislocations"
    assert "passed over: crack cell: error" in str(result.reason.values)


def test_of_many_outlines_a_corner_goes_to_the_asymptotics(monkeypatch):
    many_points(monkeypatch)
    result = auto(gallery.square_hole(), (65.0, 65.0)).isel(position=0)
    assert result.used_method == "asymptotics" and result.status == "ok"
    assert "crack cell: no cell: sharp corner" in str(result.reason.values)


def test_a_corner_and_its_neighbour_have_slits_where_a_trial_crack_costs_more():
    result = auto(gallery.square_hole(), (65.0, 65.0), (65.0, 64.9))
    assert result.used_method.values.tolist() == ["full-fea", "full-fea"]
    assert result.status.values.tolist() == ["ok", "ok"]
    assert "trial cracks at once: no trial cracks" in str(result.reason.values[0])


def test_a_crack_tip_has_a_trial_crack():
    """The part needs few points: a trial crack costs less than a mesh."""
    result = failure_indices(gallery.edge_crack(), "auto").isel(position=0)
    assert result.used_method == "boundary" and result.status == "ok"


@pytest.mark.parametrize("afforded", [0, 10_000])
def test_the_largest_index_is_an_exact_method_s(monkeypatch, afforded):
    """The asymptotics meet the tolerance at the corner, and are asked again where nothing is larger."""
    monkeypatch.setattr(by_choice, "BORDERS_AFFORDED", afforded)
    at_root = {"points": [[10.0, 60.0], [10.0, 60.0]]}
    result = failure_indices(gallery.v_notch(analysis=at_root), "auto").isel(position=0)
    assert result.used_method == ("boundary" if afforded else "full-fea")
    # what the other one says
    other = failure_indices(
        gallery.v_notch(analysis={"points": [[10.0, 60.0]]}), "full-fea" if afforded else "boundary"
    )
    assert float(result.failure_index) == pytest.approx(float(other.failure_index[0]), rel=1e-3)


def test_a_sharp_root_has_trial_cracks():
    """The critical crack is 27 times as long as the radius."""
    result = auto(gallery.v_notch(60.0, 0.005), (10.0, 60.0)).isel(position=0)
    assert result.used_method == "boundary" and result.status == "ok"
    assert float(result.failure_index_error) < 0.02 * float(result.failure_index)


@pytest.mark.parametrize(("nu", "state"), [(0.4999, "plane strain"), (-0.95, "plane stress")])
def test_a_poissons_ratio_that_the_database_lacks_is_left_to_other_methods(monkeypatch, nu, state):
    many_points(monkeypatch)
    material = {"E": 2960.0, "nu": nu, "sigma_c": 70.5, "K_Ic": 1.96, "state": state}
    result = auto(gallery.circular_hole(5.0, material=material), (55.0, 50.0)).isel(position=0)
    assert result.used_method == "dislocations" and result.status == "ok"
    assert "holds the effective Poisson's ratios" in str(result.reason.values)


def test_indices_far_below_the_largest_need_only_its_accuracy():
    result = failure_indices(HOLE, "auto", positions=24)
    FI, error = result.failure_index.values, result.failure_index_error.values
    ok = result.status.values == "ok"
    assert np.all(error[ok] <= 0.02 * np.maximum(FI[ok], MATTERS * np.nanmax(FI)))
    small = ok & (MATTERS * np.nanmax(FI) > FI) & (error > 0.02 * FI)
    assert all("of the quarter of the largest index" in reason for reason in result.reason.values[small])


def test_long_cracks_from_surfaces_with_little_tension_have_bounds(monkeypatch):
    """A notch's flanks near the plate's edge: the stress grows with the depth, full FEA would look for long cracks."""
    many_points(monkeypatch)
    scene = gallery.rounded_square()
    result = failure_indices(scene, "auto", positions=20)
    assert np.all(result.status == "ok")
    out = result.used_method.values == BOUNDS
    FI, error = result.failure_index.values, result.failure_index_error.values
    assert out.any() and np.all(error[out] <= FI[out])
    assert np.all((FI + error)[out] < NEGLIGIBLE * FI.max())
    points = np.column_stack([result.x, result.y])[out].tolist()
    truth = failure_indices(scene.with_(analysis={"points": points}), "full-fea")
    known = (truth.status == "ok").values
    assert known.any()
    assert np.all(np.abs(truth.failure_index.values - FI[out])[known] <= 1.001 * error[out][known])


def test_bounds_that_are_enough_stay_when_others_are_looked_at_closer(monkeypatch):
    many_points(monkeypatch)
    result = auto(gallery.rounded_square(), (51.97, 65.0), (65.0, 59.0), tolerance=0.0005)
    assert result.reason.values[0].startswith(ELSEWHERE[:40]) and result.used_method.values[0] == BOUNDS
    assert result.used_method.values[1] == "full-fea"
    assert "full FEA" not in str(result.reason.values[0])


def test_sharp_notches_are_not_rastered(monkeypatch):
    many_points(monkeypatch)
    result = auto(gallery.v_notch(60.0, 0.5), (10.0, 60.0)).isel(position=0)
    assert result.used_method == "dislocations"
    assert "voxels, which cost more than a body-fitted model" in str(result.reason.values)


def test_without_the_finite_element_extra_trial_cracks_have_the_last_word(monkeypatch):
    monkeypatch.setattr(by_choice, "find_spec", lambda name: None)
    result = auto(HOLE, SIDE, tolerance=0.001).isel(position=0)
    assert result.used_method == "boundary" and result.status == "ok"
    assert "within 0.1 %" in str(result.reason.values)
    unreachable = auto(HOLE, SIDE, tolerance=1e-7).isel(position=0)
    assert NO_FEA in str(unreachable.reason.values)


def test_given_displacements_serve_cells_alone():
    from slmm.initiation.body_fitted import solve_body_fitted

    scene = HOLE.with_(analysis={"points": [SIDE]})
    model = solve_body_fitted(scene).fine
    result = failure_indices(
        scene, "auto", displacements=(model.points, {"triangle6": model.triangles}, model.u), tolerance=0.001
    ).isel(position=0)
    assert result.used_method == "slmm+ac"
    assert GIVEN in str(result.reason.values)


def test_every_position_says_what_was_used_and_why():
    result = failure_indices(gallery.lobed_notch(), "auto", positions=12)
    assert set(result.used_method.values) <= {
        "strength",
        "slmm+ac",
        "dislocations",
        "asymptotics",
        "full-fea",
        "boundary",
        BOUNDS,
    }
    assert all(result.reason.values) and result.attrs["tolerance"] == 0.02


@pytest.mark.parametrize("stress", [-10.0, -1000.0])
def test_where_nothing_is_under_tension_few_positions_need_full_fea(stress):
    """Errors relative to indices that are all 0 would have no meaning, whatever the load."""
    scene = gallery.circular_hole(
        holes=[{"shape": "rectangle", "center": [50.0, 50.0], "size": [8.0, 60.0], "corner_radius": 0.1}],
        load={"strain": [stress / 2960.0, stress / 2960.0, 0.0]},
    )
    result = failure_indices(scene, "auto", positions=12)
    assert np.all(result.failure_index == 0)
    reference = 3.0 * abs(stress) / 70.5
    assert np.all(result.failure_index_error <= 0.02 * MATTERS * reference)
    assert np.sum(result.used_method == "full-fea") <= 3
