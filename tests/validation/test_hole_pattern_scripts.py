"""Scripts on hole patterns: what they share, and a small part of each."""

import numpy as np
import pytest
from scripts import of, script

from slmm.optimization import HolePattern
from slmm.optimization.hole_patterns.patterns import DIRECTIONS


@pytest.mark.parametrize("pattern", DIRECTIONS)
@pytest.mark.parametrize("grid", [4, 5])
def test_a_whole_grid_is_a_design_again_whichever_way_it_is_turned(pattern, grid):
    spaces = script("hole_pattern_spaces")
    problem = HolePattern(grid, pattern)
    rng = np.random.default_rng(grid)
    design = (rng.random(problem.shape) < 0.5) & ~problem.fixed
    whole = problem.whole(design)
    assert (spaces.whole_of(spaces.text_of(whole)) == whole).all()
    for k in range(4):
        found = spaces.design_of(problem, np.rot90(whole, k)[::-1])
        assert problem.key(found) == problem.key(design)


def test_a_grid_without_a_patterns_symmetry_is_none_of_its_designs():
    with pytest.raises(ValueError, match="is no design of"):
        script("hole_pattern_spaces").design_of(HolePattern(4, "rotated"), np.arange(16).reshape(4, 4) < 3)


def test_table_1_has_all_runs_and_the_published_variables():
    spaces = script("hole_pattern_spaces")
    assert len(spaces.TABLE1) == 21 == len(spaces.by_size())
    assert sum(run.evaluations for run in spaces.TABLE1.values()) == 10_660
    published = {
        ("full", 7): 49,
        ("reflected", 10): 25,
        ("rotated", 9): 21,
        ("rotated", 7): 13,
        ("rotated", 3): 3,
    }
    assert {run: spaces.variables(*run) for run in published} == published


def test_simulations_are_counted_and_journals_hold_their_designs(tmp_path):
    table1 = script("table1_toughness")
    row = table1.run("rotated", 3, 1, tmp_path)
    assert (row["designs"], row["simulations"]) == (6, 6) and row["cpu"] > 0
    again = table1.run("rotated", 3, 1, tmp_path)
    assert again == row and row["rank"] == 1
    assert all(check.holds for check in table1.judged([{name: str(value) for name, value in row.items()}]))


@pytest.mark.slow
def test_a_small_part_of_each_script_meets_what_is_required():
    for name in ("hole_pattern_optima", "hole_pattern_refined", "hole_pattern_steady"):
        assert all(check.holds for check in script(name).main(quick=True)), name
    half = of(script("hole_pattern_robustness").main(quick=True), quantity="increment 1 mm")[0]
    assert abs(half.difference) < 0.02


@pytest.mark.slow
def test_random_sampling_finds_the_optimum_in_half_of_the_space():
    searches = script("hole_pattern_searches")
    space = next(searches.all_listed())
    row = next(row for row in searches.rows_of(space, 20) if row["search"] == "random sampling")
    assert row["finds"] == 1.0 and row["designs"] == len(space.values)
    assert 0.2 < row["designs_to_optimum"] / len(space.values) < 0.8


def test_an_optimum_is_proved_by_early_termination_as_by_all_values(tmp_path, monkeypatch):
    optima = script("hole_pattern_optima")
    known = optima.optimum("rotated", 3, 1)
    monkeypatch.setattr(optima, "listed", lambda *space: None)
    monkeypatch.setattr(optima, "JOURNALS", tmp_path)
    for start in (None, np.array([[True, True], [True, False]])):
        monkeypatch.setattr(optima, "begun_with", lambda *space, start=start: start)
        proved = optima.optimum("rotated", 3, 1)
        assert (proved["whole"] == known["whole"]).all() and proved["proof"] == "early termination"
        assert proved["designs"] == known["designs"] == 6
        (tmp_path / "optima_rotated_3.db").unlink()
