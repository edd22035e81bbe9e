"""The equilibrium path, energies along it, and a controlled force."""

import numpy as np
import pytest
from made_history import G_C, cantilevers, step

from slmm.fracture import simulate
from slmm.fracture.equilibrium import equilibrium_path, force_control, released_in_equilibrium
from slmm.fracture.events import Kind
from slmm.fracture.history import History, Outcome
from slmm.scene.gallery import tensile_plate


@pytest.fixture(scope="module")
def one_hole():
    return simulate(tensile_plate([(40.0, 40.0, 8.0)]), increment=2.0)


def test_a_path_snaps_back_where_the_critical_load_falls():
    history = History([step(1.0, 10.0), step(0.8, 9.0), step(1.2, 8.0)], Outcome.SEVERED)
    path = equilibrium_path(history)
    assert path.u.tolist() == [0.0, 1.0, 0.8, 1.2]
    assert path.F.tolist() == pytest.approx([0.0, 10.0, 7.2, 9.6])
    assert path.step.tolist() == [-1, 0, 1, 2] and not path.jump.any()


def test_it_comes_back_to_the_origin_at_a_surface_and_jumps_where_a_crack_starts(one_hole):
    u, F = one_hole.equilibrium_u.values, one_hole.equilibrium_F.values
    step_of, jump = one_hole.equilibrium_step.values, one_hole.equilibrium_jump.values
    k = one_hole.arrested_by.values.tolist().index("hole 0")
    (origin,) = np.flatnonzero(u[1:] == 0) + 1
    assert F[origin] == 0.0
    assert step_of[[origin - 1, origin, origin + 1]].tolist() == [k, -1, k + 1]
    assert step_of[jump].tolist() == [k + 2]
    at = step_of >= 0
    assert u[at] == pytest.approx(one_hole.u_c.values)
    assert F[at] / u[at] == pytest.approx(one_hole.stiffness.values)


def test_where_the_displacement_rises_the_path_meets_the_published_curve(one_hole):
    for u, F in zip(one_hole.u.values, one_hole.F.values, strict=True):
        on_path = np.isclose(one_hole.equilibrium_u, u) & np.isclose(one_hole.equilibrium_F, F)
        dropped = F in one_hole.F.values[[2, 4]]
        assert on_path.any() or dropped


def test_growth_along_the_path_takes_G_c_times_the_new_area_up_to_the_second_order():
    """An independent check of K against the stiffness: the area between path and rays."""
    wrong = []
    for increment in (8.0, 4.0, 2.0):
        result = simulate(tensile_plate(), increment, errors=False)
        here = result.x.values < 66.1  # all of them have a tip at 66 mm
        taken = result.released_in_equilibrium.values[here].sum() / result.dissipated.values[here].sum()
        wrong.append(taken - 1)
    assert wrong[-1] < 1e-3
    assert np.log2(np.divide(wrong[:-1], wrong[1:])) == pytest.approx(2.0, abs=0.1)


def test_no_such_energy_is_told_where_a_crack_does_not_go_on(one_hole):
    known = np.isfinite(one_hole.released_in_equilibrium.values)
    goes_on = (one_hole.event == "growth") & (one_hole.arrested_by == "")
    assert known.tolist() == goes_on.values.tolist()


def test_energies_of_a_double_cantilever():
    for h in (1.0, 0.5):
        history = cantilevers(h)
        share = released_in_equilibrium(history)[:-1] / (G_C * h)
        # the trapezoid's error in (h/a)^2
        assert share == pytest.approx(1.0, abs=(h / 10) ** 2)


def test_work_is_dissipated_in_excess_or_stored(one_hole):
    total = float(one_hole.dissipated.sum() + one_hole.excess.sum() + one_hole.stored)
    assert total == pytest.approx(float(one_hole.work), rel=1e-12)
    assert float(one_hole.work) == pytest.approx(float(one_hole.U_T), rel=1e-12)
    assert abs(float(one_hole.imbalance)) < 1e-9 * float(one_hole.work)


def test_a_controlled_force_never_falls_and_breaks_the_part_at_its_peak(one_hole):
    u, F = one_hole.force_controlled_u.values, one_hole.force_controlled_F.values
    assert (np.diff(F) >= 0).all() and (np.diff(u) > 0).all()
    peak = int(one_hole.peak_step)
    assert one_hole.event.values[peak] == "start"
    assert F[-1] == float(one_hole.F_peak) == float(one_hole.F.max())
    assert F[-1] / u[-1] == pytest.approx(float(one_hole.stiffness[peak]))


def test_the_first_step_of_a_full_plate_breaks_it_under_either_control():
    result = simulate(tensile_plate(), increment=8.0, errors=False)
    assert int(result.peak_step) == 0
    assert result.force_controlled_u.values.tolist() == result.u.values[:2].tolist()


def test_jumps_at_a_constant_force_go_over_all_events_below_it():
    history = History(
        [step(1.0, 10.0), step(0.8, 8.0), step(1.0, 5.0, Kind.START, 1), step(4.0, 4.0)], Outcome.SEVERED
    )
    controlled = force_control(history)
    assert controlled.u.tolist() == pytest.approx([0.0, 1.0, 10.0 / 4.0, 4.0])
    assert controlled.F.tolist() == [0.0, 10.0, 10.0, 16.0]
    assert (controlled.peak, controlled.step) == (16.0, 3)


def test_what_was_not_severed_has_no_breaking_step():
    history = History([step(1.0, 10.0)], Outcome.LARGEST, last_stiffness=9.0, last_u=2.0)
    assert force_control(history)[2:] == (18.0, -1)
    assert force_control(History(outcome=Outcome.NO_EVENT))[2:] == (0.0, -1)


def test_all_that_was_in_question_is_told():
    cracks = [{"points": [[0.0, 40.0], [10.0, 40.0]]}, {"points": [[80.0, 30.0], [70.0, 30.0]]}]
    result = simulate(tensile_plate(cracks=cracks), increment=8.0, errors=False)
    first = result.candidate_step == 0
    assert sorted(result.candidate_tip.values[first].tolist()) == [0, 1]
    assert sorted(result.candidate_x.values[first].tolist()) == [10.0, 70.0]
    lowest = [
        float(result.candidate_u_c[result.candidate_step == k].min()) for k in range(result.sizes["step"])
    ]
    assert result.u_c.values == pytest.approx(lowest, rel=1e-5)
    for k in range(result.sizes["step"]):
        u_c = np.sort(result.candidate_u_c.values[result.candidate_step == k])
        gap = u_c[1] / u_c[0] - 1 if len(u_c) > 1 else np.nan
        assert float(result.gap[k]) == pytest.approx(gap, abs=2e-5, nan_ok=True)
