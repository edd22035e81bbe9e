"""U_T where cracks grow steadily: the second order in the increment, and errors that are told."""

import numpy as np
import pytest
from made_history import G_C, cantilevers, steady_work, step

from slmm.fracture import simulate
from slmm.fracture.events import Kind
from slmm.fracture.history import History, Outcome
from slmm.fracture.stable_growth import left_out
from slmm.scene.scene import read_scene


def integrated(history):
    dissipated = np.array([step.length for step in history.steps]) * G_C
    lacks = left_out(history, dissipated)
    return history.toughness + lacks.by_growth, lacks.error


def test_published_sums_are_of_the_first_order_and_lines_of_the_second():
    increments = [2.0, 1.0, 0.5, 0.25]
    exact = steady_work()
    published = np.array([cantilevers(h).toughness for h in increments]) - exact
    lines = np.array([integrated(cantilevers(h))[0] for h in increments]) - exact
    assert np.log2(np.abs(published[:-1] / published[1:])) == pytest.approx(1.0, abs=0.15)
    assert np.log2(np.abs(lines[:-1] / lines[1:])) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("increment", [2.0, 1.0, 0.5])
def test_the_error_of_lines_is_told_by_energies(increment):
    value, error = integrated(cantilevers(increment))
    true = abs(value - steady_work())
    assert true < error < 4 * true


def test_unstable_growth_lacks_nothing():
    history = History([step(1.0, 10.0), step(0.8, 9.0), step(0.6, 8.0)], last_stiffness=0.0)
    assert left_out(history, np.full(3, 0.5))[:2] == (0.0, 0.0)


def test_behind_a_snap_back_the_path_counts_from_the_largest_displacement_so_far():
    """From (1, 8) to (2, 12) by a line, and 1.5 has been reached before: at (1.5, 10) in place of 1.5 x 6 N."""
    history = History([step(1.5, 10.0), step(1.0, 8.0), step(2.0, 6.0)], Outcome.SEVERED, last_stiffness=0.0)
    lacks = left_out(history, np.full(3, 0.1))
    assert lacks.by_growth == pytest.approx(0.5 * (10.0 - 9.0) * 0.5)


def test_what_a_start_leaves_out_is_told_apart():
    history = History([step(1.0, 10.0, Kind.START), step(1.2, 9.0)], last_stiffness=8.0)
    lacks = left_out(history, np.full(2, 0.5))
    assert (lacks.by_growth, lacks.error) == (0.0, 0.0)
    assert lacks.by_starts == pytest.approx(0.5 * (10.0 - 9.0) * 0.2)


def test_a_crack_that_severs_steadily_takes_what_it_needs_behind_the_last_state():
    """All that is not stored at the last state, 1/2 x 4 N/mm x (1 mm)^2, comes from outside."""
    history = History([step(1.0, 4.0, arrested_by="edge", length=3.0)], Outcome.SEVERED)
    assert left_out(history, np.array([5.0])).by_growth == pytest.approx(5.0 - 2.0)
    assert left_out(history, np.array([1.5])).by_growth == 0.0


def test_a_compact_tension_specimen_takes_what_its_ligament_takes():
    """Its crack grows steadily to the end: G_c times the ligament, 20 x 10 mm, is all of the work."""
    scene = read_scene("examples/parts/compact_tension.toml")
    exact = scene.material.G_c * 20.0 * 10.0
    result = simulate(scene, 4.0)
    assert float(result.dissipated.sum()) == pytest.approx(exact, rel=1e-9)
    assert float(result.U_T) < 0.75 * exact
    assert abs(float(result.U_T_integrated) - exact) < float(result.U_T_integrated_error) < 0.1 * exact
    assert abs(float(result.U_T) - exact) < 1.5 * float(result.U_T_error)


def test_half_the_increment_has_a_quarter_of_the_error():
    scene = read_scene("examples/parts/compact_tension.toml")
    coarse, middle, fine = (
        float(simulate(scene, h, largest_displacement=1.0, errors=False).U_T_integrated) for h in (4, 2, 1)
    )
    assert (coarse - middle) / (middle - fine) == pytest.approx(4.0, abs=0.5)
