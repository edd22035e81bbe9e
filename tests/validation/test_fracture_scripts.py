"""Simulations of fracture: killed ones end as they should, and steady growth takes what the ligament takes."""

import pytest
from scripts import script


@pytest.mark.slow
def test_killed_simulations_end_as_undisturbed_ones():
    assert all(check.holds for check in script("killed_fractures").main(quick=True))


@pytest.mark.slow
def test_steady_growth_is_integrated():
    assert all(check.holds for check in script("steady_growth").main(quick=True))
