"""A check holds only where a value is known."""

import pytest
from scripts import script


@pytest.mark.slow
def test_a_check_of_a_value_that_is_not_a_number_never_holds():
    Check = script("checks").Check
    assert not Check("", "", 1.0, float("nan"), 0.1).holds
    assert not Check("", "", 1.0, float("nan"), rule="at most").holds
    assert Check("", "", 1.0, 1.05, 0.1).holds and not Check("", "", 1.0, 1.2, 0.1).holds
