"""Simulated fracture: killed and random simulations end as they should, steady growth takes what the ligament takes."""

import pytest
from scripts import script


@pytest.mark.slow
def test_killed_simulations_end_as_undisturbed_ones():
    assert all(check.holds for check in script("killed_fractures").main(quick=True))


@pytest.mark.slow
def test_steady_growth_is_integrated():
    assert all(check.holds for check in script("steady_growth").main(quick=True))


@pytest.mark.slow
def test_random_patterns_end_with_an_outcome_and_their_energy_is_told():
    assert all(check.holds for check in script("fracture_patterns").main(quick=True))


@pytest.mark.slow
def test_simple_designs_are_as_tough_as_published():
    checks = script("fracture_designs").main(quick=True)
    assert all(check.holds for check in checks), [check for check in checks if not check.holds]
    assert sum(check.source == "published" for check in checks) == 6


@pytest.mark.slow
def test_increments_of_2_mm_are_short_enough():
    checks = script("fracture_increments").main(quick=True)
    assert all(check.holds for check in checks), [check for check in checks if not check.holds]
    assert len(checks) == 8


def test_a_simulation_that_raises_or_takes_too_long_is_counted(monkeypatch):
    patterns = script("fracture_patterns")
    sound = patterns.broken(0, 0)
    assert not sound["raised"] and all(check.holds for check in patterns.checks_of([sound]))

    def endless(*_, **__):
        while True:
            pass

    monkeypatch.setattr(patterns, "simulate", endless)
    monkeypatch.setattr(patterns, "LIMIT", 0.2)
    hung = patterns.broken(0, 1)
    assert hung["raised"] == "TimeoutError: more than 0.2 s of CPU time"
    (count,) = [
        c for c in patterns.checks_of([sound, hung]) if c.quantity == "simulations that raise or hang"
    ]
    assert (count.ours, count.holds) == (1, False)
    failed = sound | {"failed": True, "outcome": "failed", "steps": 0.0}
    (lost,) = [c for c in patterns.checks_of([sound, failed]) if "earlier steps" in c.quantity]
    assert lost.ours == 2
