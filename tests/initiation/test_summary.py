"""Summaries of made-up results, in words and as JSON."""

import json

import numpy as np
import pytest
from made_up_result import REASON, made_up

from slmm.initiation.summary import as_json, by_criticality, index_with_error, method_used, verdict
from slmm.scene import gallery


def test_json_is_strict_and_complete():
    scene = gallery.circular_hole()
    result = made_up(scene, missing=(1,))
    result["load_factor"][2] = np.inf
    content = json.loads(as_json(result), parse_constant=pytest.fail)
    assert content["settings"] == {"absolute": None}
    assert len(content["positions"]) == 24
    assert content["positions"][1]["failure_index"] is None
    assert content["positions"][1]["status"] == REASON
    assert content["positions"][2]["load_factor"] is None
    assert content["most_critical"]["position"] == by_criticality(result)[0]
    assert content["status_counts"] == {"ok": 23, REASON: 1}


def test_verdicts():
    scene = gallery.circular_hole()
    starts = made_up(scene)
    assert "A crack starts there under this load" in verdict(starts)
    holds = starts.assign(failure_index=starts["failure_index"] / 2, load_factor=starts["load_factor"] * 2)
    assert "No crack starts under this load" in verdict(holds)
    nothing = verdict(made_up(scene, missing=tuple(range(24))))
    assert nothing.startswith("No position has a failure index. No verdict: 24 positions of 24 have no value")
    closed = starts.assign(
        failure_index=starts["failure_index"] * 0, load_factor=starts["load_factor"] * np.inf
    )
    assert "however high the load" in verdict(closed)


def test_the_verdict_of_a_crack_tip_and_of_an_estimated_error():
    scene = gallery.edge_crack()
    result = made_up(scene)
    result["failure_index"][0], result["load_factor"][0], result["crack_length"][0] = 1.25, 0.8, 0.0
    result["failure_index_error"][0] = 0.0123
    says = verdict(result)
    assert "position 0, a crack tip, at (10.00, 60.00) mm, failure index 1.250 ± 0.012, load" in says
    assert "The crack goes on there" in says
    assert "critical crack length" not in says  # Griffith's criterion knows none
    content = json.loads(as_json(result), parse_constant=pytest.fail)
    assert content["most_critical"]["arc_length"] is None
    assert content["most_critical"]["reason"] == ""


@pytest.mark.parametrize(
    ("error", "text"), [(np.nan, "0.818"), (0.2, "0.818 ± 0.200"), (0.0002, "0.8182 ± 0.0002")]
)
def test_an_index_has_the_digits_that_its_error_leaves(error, text):
    result = made_up(gallery.circular_hole()).isel(position=[1])
    result["failure_index"][0], result["failure_index_error"][0] = 0.81818, error
    assert index_with_error(result, 0) == text


def test_the_method_that_was_used_is_named_where_it_is_another_one():
    result = made_up(gallery.circular_hole())
    assert method_used(result, 0) == "slmm+ac"
    result.attrs["method"] = "auto"
    assert method_used(result, 0) == "auto: slmm+ac"
