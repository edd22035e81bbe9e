"""What one factorisation saves, and that speed is measured."""

import pytest
from scripts import of, script


@pytest.mark.slow
def test_run_times_one_factorisation_gives_the_energies_of_one_solve_per_length():
    checks = script("run_times").main(quick=True)
    assert of(checks, "25 lengths", "energies")[0].ours < 1e-9
    # how fast is for the full run to say: here only that something was saved
    assert of(checks, "25 lengths", "CPU time")[0].ours < 0.5
    assert of(checks, "50 positions", "CPU time of dislocations")[0].ours < 0.1


@pytest.mark.slow
def test_speed_is_measured():
    # how fast is for an idle machine to say, not for a test
    checks = script("speed").main(quick=True)
    assert of(checks, "50 positions", "CPU")[0].ours > 0
    assert of(checks, "second start", "CPU")[0].ours > 0


@pytest.mark.slow
def test_errors_of_simulated_fracture_are_charted():
    checks = script("fracture_chart").main(quick=True)
    assert of(checks, "6 and 5 points", "error")[0].ours < 3e-3
    assert of(checks, "6 and 5 points", "seconds")[0].ours > 0


@pytest.mark.slow
def test_a_thousand_variants_are_their_own_runs():
    checks = script("sweeps").main(quick=True)
    assert of(checks, "slmm+ac", "difference")[0].ours < 1e-9
    assert of(checks, "auto", "over what is told")[0].ours < 1
    # how fast is for the full run to say: here only that a thousand cost a few runs
    assert all(check.ours < 20 for check in of(checks, "hole", "CPU time of 1000"))
