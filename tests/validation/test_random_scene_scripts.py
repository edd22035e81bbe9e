"""Random outlines and loads end with values whose errors and words hold, or with reasons."""

import contextlib

import numpy as np
import pytest
import shapely
import xarray as xr
from PIL import Image
from scripts import of, script

from slmm import SceneError


@pytest.mark.slow
def test_random_outlines_and_loads_end_with_values_or_reasons():
    checks = script("stability").main(quick=True)
    assert of(checks, quantity="crashes")[0].ours == 0
    assert of(checks, quantity="without value or reason")[0].ours == 0
    positions = of(checks, quantity="status: ok")[0]
    assert positions.ours > 0.5 * positions.wanted


@pytest.mark.slow
def test_estimated_errors_of_random_scenes_cover_the_true_ones():
    checks = script("estimates").main(quick=True)
    for method in ("slmm+ac", "dislocations", "auto"):
        # of some twenty positions one may be off
        assert of(checks, f"{method}, ", "above their estimate")[0].ours <= 0.15
        (median,) = (c for c in of(checks, f"{method}, ") if c.quantity == "error, median")
        assert median.ours < 0.01


@pytest.mark.slow
def test_words_of_random_scenes_hold_against_a_closer_look():
    checks = script("random_scenes").main(quick=True)
    for quantity in (
        "scenes that raise",
        "refuted: a crack starts",
        "refuted: no crack",
        "refuted: index is low",
    ):
        assert of(checks, "6 random scenes", quantity)[0].ours == 0, quantity
    assert of(checks, "positions", "share without value")[0].ours < 0.05


def test_a_picture_of_a_random_part_is_as_dark_as_its_holes_are_large(tmp_path):
    random_parts = script("random_parts")
    part = random_parts.drawn(np.random.default_rng(1))
    with contextlib.suppress(SceneError):  # the picture is written before it is read
        random_parts.picture(part, tmp_path / "holes.png")
    grey = np.asarray(Image.open(tmp_path / "holes.png"), dtype=float)
    plate = part.scene.plate
    holes = shapely.union_all([shapely.Polygon(outline.polygon(2000)) for outline in part.scene.outlines])
    covered = holes.intersection(shapely.box(0, 0, plate.width, plate.height)).area / (
        plate.width * plate.height
    )
    assert 1 - grey.mean() / 255 == pytest.approx(covered, rel=2e-3)


@pytest.mark.parametrize(
    ("index", "error", "true", "refuted"),
    [
        (0.95, 0.01, 0.955, ""),
        (0.95, 0.01, 1.01, "a crack starts"),
        (0.90, 0.01, 0.95, "index is low"),
        (1.05, 0.01, 1.02, ""),
        (1.05, 0.01, 0.97, "no crack starts"),
        (1.05, 0.10, 0.97, ""),
        (1.02, 0.01, 1.09, "index is low"),
    ],
)
def test_what_the_truth_refutes(monkeypatch, index, error, true, refuted):
    random_scenes = script("random_scenes")
    says = "No crack starts under this load." if index < 1 else "A crack starts there under this load."
    monkeypatch.setattr(random_scenes, "verdict", lambda result: says)
    result = xr.Dataset(
        {
            "failure_index": ("position", [0.1, index, np.nan]),
            "failure_index_error": ("position", [0.06, error, np.nan]),
            "status": ("position", ["ok", "ok", "no mesh"]),
        }
    )
    row = random_scenes.told(result, true, 0.001)
    assert row["refuted"] == refuted
    assert (row["without_value"], row["statuses"]) == (1, "1 no mesh")
    monkeypatch.setattr(random_scenes, "verdict", lambda result: "No verdict: ...")
    assert random_scenes.told(result, true, 0.001)["refuted"] == ""


def test_lines_of_random_scenes_that_are_there_are_not_computed_again(tmp_path, monkeypatch):
    random_scenes = script("random_scenes")
    file = tmp_path / "lines.csv"
    for number in range(3):
        random_scenes.add(file, {name: number for name in random_scenes.FIELDS})
    rows = random_scenes.gathered(range(1, 3), 5, 10, file)
    assert [row["scene"] for row in rows] == ["1", "2"]
