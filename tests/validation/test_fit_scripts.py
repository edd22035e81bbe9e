"""The scripts that find fitted numbers again, from their stored data (see validation/README.md)."""

import csv
import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "validation"

# The scripts import one another as they do when started by hand.
sys.path.insert(0, str(FOLDER))


def script(name):
    return importlib.import_module(name)


def test_factors_of_an_estimate_are_found_again_and_cover_nineteen_of_twenty():
    fitting, rng = script("fitting"), np.random.default_rng(0)
    features = np.exp(rng.normal(0, 1, (2000, 2)))
    # of such errors, nineteen of twenty lie below what the factors say
    errors = features @ [0.003, 1.25] * rng.uniform(0, 1 / 0.95, 2000)
    factors = fitting.covering_factors(features, errors, (1.0, 1.0))
    assert factors == pytest.approx([0.003, 1.25], rel=0.1, abs=0.03)
    assert np.mean(errors <= features @ factors) == pytest.approx(0.95, abs=0.002)


def test_the_least_tilted_deviation_is_that_of_the_quantile():
    fitting = script("fitting")
    errors = np.arange(1.0, 101.0)
    deviations = {
        k: fitting.tilted_deviation(np.full(100, float(k)), errors, np.ones(100)) for k in (90, 95, 99)
    }
    assert min(deviations, key=deviations.get) == 95


def test_scenes_that_the_data_have_are_not_computed_again(tmp_path, monkeypatch):
    fitting, asked = script("fitting"), []
    monkeypatch.setattr(fitting, "RESULTS", tmp_path)

    def examine(number):
        asked.append(number)
        return [] if number == 1 else [{"scene": number, "error": 0.5}]

    assert fitting.completed("data", 3, examine) == [{"scene": 0, "error": 0.5}, {"scene": 2, "error": 0.5}]
    assert len(fitting.completed("data", 4, examine)) == 3
    assert asked == [0, 1, 2, 3]
    assert [row["scene"] for row in fitting.stored("data")] == [0, 2, 3]


@pytest.mark.parametrize("name", ["fit_support", "fit_dislocation_errors", "fit_cell_errors"])
def test_constants_are_as_good_as_the_fit_to_their_data(name):
    checks = script(name).main(quick=True)
    assert [check for check in checks if check.rule != "told"]
    failed = [check for check in checks if not check.holds]
    assert not failed, failed


def test_numbers_of_traced_outlines_are_found_again():
    outline_errors = script("fit_outline_errors")
    with open(FOLDER / "results" / "fit_outline_errors.csv", newline="") as file:
        rows = [row | {"value": float(row["value"])} for row in csv.DictReader(file)]
    failed = [check for check in outline_errors.judged(rows) if not check.holds]
    assert not failed, failed


@pytest.mark.slow
def test_drawn_shapes_measure_as_they_did():
    outline_errors = script("fit_outline_errors")
    with open(FOLDER / "results" / "fit_outline_errors.csv", newline="") as file:
        before = {(row["what"], row["shape"]): float(row["value"]) for row in csv.DictReader(file)}
    rows = [
        *outline_errors.deviations((12.0,), (17.0,), True),
        *outline_errors.tips_missed((4.0, 11.0), (33.0,)),
    ]
    # of a shape that was drawn several times, the last one is kept
    now = {(row["what"], row["shape"]): row["value"] for row in rows}
    for key, value in now.items():
        assert value == pytest.approx(before[key], rel=1e-4, abs=1e-4), key


def test_the_radius_of_a_blurred_corner_is_that_of_a_filter_on_a_fine_grid():
    radii = [script("fit_outline_errors").blurred_radius(np.radians(turn)) for turn in (20.0, 90.0, 160.0)]
    assert radii[1] == pytest.approx(2.0074, abs=1e-3)
    assert radii[2] == pytest.approx(5.188, abs=1e-3)
    assert radii == sorted(radii)
