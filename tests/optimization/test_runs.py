"""Runs are searches with seeds that follow, side by side or one after the other."""

import pytest
import xarray as xr
from quick_problems import BEAM

from slmm.optimization import search
from slmm.optimization.runs import search_runs


def test_runs_are_searches_with_seeds_that_follow():
    runs = search_runs(BEAM, "tbfsl", runs=3, seed=4)
    for k in range(3):
        assert float(runs.value[k]) == search(BEAM, "tbfsl", seed=4 + k).value
    assert runs.seed.values.tolist() == [4, 5, 6]
    with pytest.raises(ValueError, match="runs = 0"):
        search_runs(BEAM, runs=0)


def test_runs_side_by_side_are_those_one_after_the_other(tmp_path):
    told = []
    options = {"runs": 3, "seed": 4, "depth": 2}
    beside = search_runs(
        BEAM, "tbfsl", workers=2, journals=tmp_path, progress=lambda *news: told.append(news), **options
    )
    in_turn = search_runs(BEAM, "tbfsl", **options)
    xr.testing.assert_identical(beside, in_turn)
    simulations, best = int(in_turn.simulations.sum()), float(in_turn.value.min())
    assert [share for share, _ in told] == [1 / 3, 2 / 3, 1]
    assert told[-1][1] == f"3 of 3 runs done: {simulations:,} simulations, best {best:.6g} mm"
    assert sorted(path.name for path in tmp_path.glob("*.sqlite")) == [f"run-{k}.sqlite" for k in (4, 5, 6)]
    with pytest.raises(ValueError, match="depth"):
        search_runs(BEAM, "tbfsl", runs=2, workers=2, depth=0)
