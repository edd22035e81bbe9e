"""The verdict says no more than what is known of every position."""

import numpy as np
import pytest
import xarray as xr

from slmm.initiation.verdict import ASK_AUTO, INSTALL, OWN_MODEL, conclude, remedy


def result(FI, error=None, bound=None, method="slmm+ac", **attrs) -> xr.Dataset:
    """A result with these indices; NaN is a position without a value."""
    FI = np.array(FI, dtype=float)
    error = np.zeros(len(FI)) if error is None else np.array(error, dtype=float)
    bound = FI + error if bound is None else np.array(bound, dtype=float)
    n = np.arange(len(FI))
    values = {
        "failure_index": FI,
        "failure_index_error": np.where(np.isnan(FI), np.nan, error),
        "failure_index_bound": bound,
        "status": np.where(np.isnan(FI), "no cell: undercut", "ok"),
        "reason": np.full(len(FI), ""),
        "hole": 0 * n,
        "x": 1.0 * n,
        "y": 0.0 * n,
    }
    return xr.Dataset({name: ("position", v) for name, v in values.items()}, attrs={"method": method} | attrs)


def test_no_crack_is_promised_only_where_every_bound_lies_below_one():
    safe = conclude(result([0.3, 0.9], error=[0.01, 0.02]))
    assert "No crack starts under this load (FI < 1); one does at 1.111 times the load." in safe.says
    assert not safe.is_open
    for bound in (1.0, 2.5, np.inf, np.nan):
        open_ = conclude(result([0.3, np.nan, 0.9], bound=[0.3, bound, 0.9]))
        assert "No verdict: 1 position of 3" in open_.says and "No crack starts" not in open_.says
        assert "at (1.00, 0.00) mm" in open_.says and "(no cell: undercut)" in open_.says
        assert open_.is_open


def test_a_bound_below_one_gives_both_ends_of_the_load():
    says, is_open = conclude(result([0.5, np.nan], bound=[0.5, 0.8]))
    assert "No crack starts under this load (FI < 1): at the 1 position without a value" in says
    assert "at 2.000 times the load at the latest, and none below 1.250 times" in says
    assert not is_open


def test_an_index_with_a_wide_error_is_told_by_its_bounds():
    says = conclude(result([0.5, 0.1], error=[0.1, 0.01])).says
    assert says.endswith("(FI < 1); none does below 1.667 times the load, and one does at 2.500 times it.")
    # bounds that leave open whether there is any tension
    says = conclude(result([0.239, 0.0], error=[0.239, 0.0])).says
    assert says.endswith("(FI < 1); none does below 2.092 times the load.")
    # the error of another position
    says = conclude(result([0.5, 0.4], error=[0.001, 0.2])).says
    assert says.endswith("(FI < 1); none does below 1.667 times the load, and one does at 2.004 times it.")


def test_positions_without_a_value_may_lie_below_the_largest_index():
    says, is_open = conclude(result([0.9, np.nan], bound=[0.9, 0.2]))
    assert says.endswith("No crack starts under this load (FI < 1); one does at 1.111 times the load.")
    assert not is_open


def test_a_crack_that_starts_is_sure_whatever_is_missing():
    says, is_open = conclude(result([1.2, np.nan], bound=[1.2, 3.0]))
    assert "A crack starts there under this load (FI >= 1)" in says
    assert "At 1 position without a value the index may be higher: 3.000 at most." in says
    assert not is_open


@pytest.mark.parametrize(("FI", "error"), [(0.99, 0.02), (0.5, 0.6)])
def test_what_lies_within_the_error_is_not_promised(FI, error):
    says, is_open = conclude(result([FI, 0.1], error=[error, 0.0]))
    assert "lies within the estimated errors" in says and "No crack starts" not in says
    assert not is_open


def test_the_error_of_a_position_that_is_not_the_most_critical_counts():
    assert "may be as high as 1.300" in conclude(result([0.9, 0.8], error=[0.01, 0.5])).says
    assert "by less than the estimated error" in conclude(result([1.005], error=[0.02])).says


def test_without_tension_or_without_values():
    assert "however high the load" in conclude(result([0.0, 0.0])).says
    held = conclude(result([0.0, np.nan], bound=[0.0, 0.4]))
    assert "No crack starts under this load: at the 1 position" in held.says and not held.is_open
    assert "no tension" in held.says
    nothing = conclude(result([np.nan, np.nan], bound=[0.4, np.inf]))
    assert nothing.says.startswith("No position has a failure index. No verdict") and nothing.is_open
    bounded = conclude(result([np.nan, np.nan], bound=[0.4, 0.7]))
    assert "an index of 0.700 at most" in bounded.says and not bounded.is_open


def test_a_result_without_bounds_knows_nothing_of_what_is_missing():
    old = result([0.5, np.nan]).drop_vars("failure_index_bound")
    assert conclude(old).is_open
    assert not conclude(result([0.5, 0.4]).drop_vars("failure_index_bound")).is_open


def test_what_would_help_depends_on_what_was_asked():
    assert remedy(result([0.5, 0.4])) == ""
    missing = [0.5, np.nan]
    assert remedy(result(missing)) == ASK_AUTO
    assert remedy(result(missing, method="auto", displacements="model.frd")) == OWN_MODEL
    without_fea = result(missing, method="auto")
    without_fea["reason"] = (
        "position",
        ["", "the other methods need the extra 'fea', which is not installed"],
    )
    assert remedy(without_fea) == INSTALL
    assert remedy(result(missing, method="auto")) == ""
