"""Figures and tables of Paper A are met, or missed as far as is known, in their scripts' quick form."""

import numpy as np
import pytest
from scripts import of, script


@pytest.mark.slow
def test_coupled_criterion_at_a_circular_hole_is_that_of_closed_solutions():
    checks = script("circular_hole").main(quick=True)
    for check in of(checks, "two cracks, R/l_ch"):
        assert abs(check.difference) < 0.01, check
    for check in of(checks, "R/l_ch = 1,", "sigma_f/sigma_c, one crack"):
        assert abs(check.difference) < 0.03, check
    assert of(checks, "small hole")[0].ours == pytest.approx(3.0, rel=0.01)


def test_one_crack_at_a_hole_goes_from_an_edge_crack_to_a_crack_beside_which_the_hole_is_small():
    circular_hole = script("circular_hole")
    assert circular_hole.one_crack(1e-6) == pytest.approx(3 * 1.1215, rel=1e-4)
    assert circular_hole.one_crack(1.0) == pytest.approx(1.3061, rel=1e-6)
    # full FEA in a plate of 800 radii
    assert circular_hole.one_crack(4.0) == pytest.approx(0.8777, rel=3e-3)
    # a crack as long as the hole and itself
    assert circular_hole.one_crack(1e3) == pytest.approx(np.sqrt(0.5 + 1e-3), rel=1e-3)


@pytest.mark.slow
def test_fig_12_both_cells_agree_under_auto_control_between_held_and_released():
    checks = script("fig12_two_cells").main(quick=True)
    assert of(checks, "a_n,1", "DC lies below")[0].ours == pytest.approx(0.877, abs=0.01)
    assert of(checks, "a_n,1", "FC lies above")[0].ours == pytest.approx(0.213, abs=0.01)
    assert of(checks, "a_n,1", "DC: cell (1) over cell (2)")[0].ours == pytest.approx(0.624, abs=0.01)
    assert of(checks, "a_n,1", "AC: cell (1) over cell (2)")[0].ours == pytest.approx(1.0, abs=1e-6)
    assert of(checks, "all lengths", "AC lies between")[0].ours < 1.0
    # the larger cell's boundary yields: from 12 % too little to 10 % too much
    held, mixed = of(checks, quantity="of DC, cell (2)")[0], of(checks, quantity="of AC, cell (2)")[0]
    assert held.difference == pytest.approx(-0.123, abs=0.01)
    assert mixed.difference == pytest.approx(0.104, abs=0.01)


@pytest.mark.slow
def test_fig_13_published_settings_overestimate_the_failure_index_as_the_paper_says():
    checks = script("fig13_circular_hole").main(quick=True)
    assert of(checks, "red, SLMM, published", "FI")[0].ours == pytest.approx(1.0796, abs=0.01)
    assert of(checks, "red, SLMM+AC, published", "FI")[0].ours == pytest.approx(1.0798, abs=0.01)
    assert of(checks, "red, SLMM+AC, default", "FI")[0].ours < 0.03
    assert of(checks, "red, dislocations", "FI")[0].ours < 0.002
    # sigma_I at the cyan position: 7.7 % too low, says the paper
    assert of(checks, "cyan, SLMM, published", "highest")[0].ours == pytest.approx(1 - 0.077, abs=0.01)
    assert of(checks, "red, dislocations", "G_inc")[0].difference == pytest.approx(0.0, abs=0.005)


@pytest.mark.slow
def test_fig_14_holes_in_pmma_fail_at_the_analytic_load_and_cells_say_where_they_are_too_small():
    checks = script("fig14_sapora").main(quick=True)
    for method in ("dislocations", "full FEA"):
        assert abs(of(checks, "R = 0.25 mm", f"{method}, sigma_f")[0].difference) < 0.012
    assert of(checks, "R = 0.25 mm", "SLMM+AC, default: says")[0].ours == 1.0
    assert of(checks, "R = 0.25 mm", "SLMM+AC, published: says")[0].ours == 1.0
    assert abs(of(checks, "R = 0.5 mm", "SLMM+AC, default, sigma_f")[0].difference) < 0.03


@pytest.mark.slow
def test_fig_15_every_method_finds_the_critical_positions_of_a_lobed_notch_in_their_order():
    checks = script("fig15_lobed_notch").main(quick=True)
    for load in ("e_xx", "e_yy", "g_xy"):
        for check in of(checks, load, "in another order"):
            assert check.ours == 0, check
        assert of(checks, f"{load}, SLMM+AC, default", "most critical")[0].ours < 0.01
        assert of(checks, f"{load}, dislocations", "most critical")[0].ours < 0.002
        assert abs(of(checks, f"{load}, SLMM+AC, published", "most critical")[0].ours - 1) < 0.108


@pytest.mark.slow
def test_fig_16_applicability_factors_are_those_of_the_paper_where_its_method_is_used():
    checks = script("fig16_applicability").main(quick=True)
    assert of(checks, "a) hole, tension", "slmm+ac")[0].ours == pytest.approx(2.53, rel=0.1)
    assert of(checks, "b) hole, shear", "slmm+ac")[0].ours == pytest.approx(4.68, rel=0.1)
    # and full FEA is well below the published 4.68
    assert of(checks, "b) hole, shear", "full FEA")[0].ours == pytest.approx(3.78, rel=0.02)


@pytest.mark.slow
def test_table_3_sampling_points_matter_little_and_crack_lengths_and_modes_matter():
    checks = script("table3_parameters").main(quick=True)
    # below 1 % as in the paper, with the cell held
    for parameter in ("n_fit,c", "n_fit,u"):
        for quantity in ("sigma_I", "G_inc"):
            assert of(checks, f"{parameter}: ", quantity)[1].ours < 0.01, (parameter, quantity)
    assert of(checks, "n_cracks", "sigma_I")[1].ours < 1e-3
    assert of(checks, "n_cracks", "G_inc")[1].ours == pytest.approx(0.30, abs=0.03)
    assert of(checks, "D: ", "sigma_I")[1].ours == pytest.approx(0.059, abs=0.01)
    assert of(checks, "l_el,full", "G_inc")[0].ours < 1e-3
