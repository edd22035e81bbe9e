"""Half and quarter models have the loading of the whole part, which is found from their line of symmetry."""

from pathlib import Path

import numpy as np
import pytest
from cracked_square import STEEL, half_loaded, loaded, tension, upper_half

from slmm.fracture.loading import OK, crack_tip_loading
from slmm.fracture.symmetry import half_model_side, whole_part
from slmm.mechanics.element_results import linear_elastic
from slmm.results.read_results import read_element_results

CASES = Path(__file__).parents[3] / "shared" / "cases" / "05-half-model"
SAME = ("G", "K_I", "radius", "spread")


def of_case(name):
    return read_element_results(CASES / name, elasticity=STEEL)


def test_the_half_model_of_the_case_has_the_loading_of_the_whole():
    half, whole = of_case("half.vtu"), of_case("whole.vtu")
    tip = crack_tip_loading(half, symmetry=["y"]).isel(tip=0)
    assert float(tip.G) == pytest.approx(23.68, abs=0.005)
    assert float(tip.K_I) == pytest.approx(2320, abs=0.5)
    assert tip.status.item() == OK
    # no shear, and the crack runs straight on
    assert abs(float(tip.K_II)) < 1e-9 * float(tip.K_I)
    assert np.abs(tip.kink).max() < 1e-6
    reference = crack_tip_loading(whole).isel(tip=0)
    for name in SAME[:3]:
        np.testing.assert_allclose(tip[name], reference[name], rtol=1e-9)


@pytest.mark.parametrize("line", ["y", "y=20", " y = 20.0 "])
def test_a_line_is_named_by_its_direction_and_its_place_may_be_given(line):
    assert crack_tip_loading(of_case("half.vtu"), symmetry=[line]).sizes["tip"] == 1


def test_the_lower_half_is_as_good_as_the_upper_and_a_turned_half_is_symmetric_in_x():
    half = of_case("half.vtu")
    reference = crack_tip_loading(half, symmetry=["y"]).isel(tip=0)
    for R, line in ((np.diag([1.0, -1.0]), "y"), (np.array([[0.0, -1.0], [1.0, 0.0]]), "x")):
        order = [0, 3, 2, 1, 7, 6, 5, 4] if np.linalg.det(R) < 0 else range(8)
        cells = {"CPE8": half.cells["CPE8"][:, order]}
        moved = linear_elastic(half.points @ R.T, cells, half.u @ R.T, STEEL)
        tip = crack_tip_loading(moved, symmetry=[line]).isel(tip=0)
        for name in SAME[:3]:
            np.testing.assert_allclose(tip[name], reference[name], rtol=1e-9)


@pytest.mark.parametrize("kind", ["CPE3", "CPE4", "CPE6", "CPE8", "CPE8R"])
def test_half_of_a_whole_has_its_loading_in_all_elements(kind):
    """The mesh of the whole is the half and its image."""
    points, cells, ligament = upper_half(kind)
    held = np.zeros(points.shape, dtype=bool)
    held[ligament, 1] = True
    held[np.argmax(points[:, 0] - points[:, 1]), 0] = True
    half = half_loaded(points, cells, held)
    model = whole_part(half, ["y"])
    whole = loaded(model.points, model.cells, tension())
    one = crack_tip_loading(whole).isel(tip=0)
    other = crack_tip_loading(half, symmetry=["y"]).isel(tip=0)
    for name in SAME[:3]:
        np.testing.assert_allclose(other[name], one[name], rtol=1e-6)
    assert abs(float(other.K_II)) < 1e-6 * float(other.K_I)


def test_a_quarter_has_the_loading_of_the_whole():
    """A crack in the middle of 80 x 40 mm: the square with its crack is the right half, the quarter a half of that."""
    quarter = of_quarter()
    both = crack_tip_loading(quarter, symmetry=["x=0", "y"])
    other_order = crack_tip_loading(quarter, symmetry=["y", "x=0"])
    whole = whole_part(quarter, ["x=0", "y"])
    reference = crack_tip_loading(whole)
    # the whole has two tips, the quarter one of them
    assert (both.sizes["tip"], reference.sizes["tip"]) == (1, 2)
    assert float(both.x[0]) == 20.0
    for name in SAME[:3]:
        for k in range(2):
            np.testing.assert_allclose(both[name][0], reference[name][k], rtol=1e-9)
        np.testing.assert_allclose(both[name], other_order[name], rtol=1e-9)
    # Isida, 2a/W = 0.5 in a long strip; here it is as high as half its width
    assert 1.187 < float(both.K_I[0]) / (100 * np.sqrt(np.pi * 20)) < 2.0


def of_quarter():
    points, cells, ligament = upper_half()
    held = np.column_stack([points[:, 0] < 1e-9, ligament])
    return half_loaded(points, cells, held)


def test_a_half_model_is_recognised_and_a_whole_one_is_not():
    half, whole = of_case("half.vtu"), of_case("whole.vtu")
    assert half_model_side(half) == "y"
    assert half_model_side(whole) is None
    assert half_model_side(of_quarter()) == "y"
    remark = crack_tip_loading(half).attrs["remark"]
    assert remark.startswith("No crack tip")
    assert "looks like a half model: --symmetry y" in remark
    assert crack_tip_loading(whole).attrs["remark"] == ""


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["x"], "no edge of the model on x = 0 or x = 40 has u_x = 0"),
        (["z"], "must be x, y, x=PLACE or y=PLACE"),
        (["y", "y=20"], "there is a line y = ... already"),
        (["y=40"], "no edge of the model on y = 40 has u_y = 0"),
        (["y=30"], "must be a side of the model"),
        (["y=a"], "'a' is no number"),
    ],
)
def test_lines_of_no_symmetry_are_refused_by_name(lines, words):
    with pytest.raises(ValueError, match="symmetry = ") as refusal:
        whole_part(of_case("half.vtu"), lines)
    assert words in str(refusal.value)


def test_a_clamped_edge_is_no_line_of_symmetry():
    points, cells, ligament = upper_half()
    clamped = half_loaded(points, cells, np.column_stack([ligament, ligament]))
    assert half_model_side(clamped) is None
    with pytest.raises(ValueError, match="y = 20 carries shear"):
        whole_part(clamped, ["y"])
