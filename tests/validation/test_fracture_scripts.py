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


@pytest.mark.slow
def test_where_fracture_is_hard_no_engine_is_quietly_wrong():
    pytest.importorskip("netgen")
    assert all(check.holds for check in script("fracture_limits").main(quick=True))


def test_engines_that_differ_without_a_word_are_quietly_wrong(monkeypatch):
    limits = script("fracture_limits")
    said = {"error": 0.1, "steps": 3, "says": "", "cpu": 0.0}
    for U_T, warned, wrong in (
        (101.0, False, 1),
        (101.0, True, 0),
        (100.1, False, 0),
        (float("nan"), False, 1),
    ):
        answers = iter([{**said, "U_T": 100.0, "warned": False}, {**said, "U_T": U_T, "warned": warned}])
        monkeypatch.setattr(limits, "simulated", lambda *_, answers=answers: next(answers))
        row = limits.compared("kind", "scene", None, {})
        assert row["quietly_wrong"] == wrong
        assert all(check.holds for check in limits.checks_of(row)) == (not wrong)
