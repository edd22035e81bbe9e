"""The searches: what they find, that they find it again, and that a kill costs nothing."""

import sqlite3
from contextlib import closing
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quick_problems import BEAM, Pattern, Returns, same

from slmm.optimization import Cantilever, search
from slmm.optimization.algorithms.annealing import accepts
from slmm.optimization.algorithms.breadth_first import flips_within
from slmm.optimization.algorithms.free_shape import outer_edge
from slmm.optimization.algorithms.multi_grid import scaled
from slmm.optimization.cantilever.brute_force import brute_force


@given(st.integers(2, 5), st.integers(2, 5), st.integers(1, 3), st.integers(0, 4))
@settings(max_examples=40, deadline=None)
def test_the_neighbourhood_is_all_sets_of_cells_in_a_small_box(rows, columns, k, radius):
    found = {tuple(f) for f in flips_within(np.ones((rows, columns), dtype=bool), k, radius).tolist()}
    expected = set()
    for cells in combinations(range(rows * columns), k):
        r, c = np.divmod(cells, columns)
        if np.ptp(r) + np.ptp(c) <= radius:
            expected.add(cells)
    assert found == expected


@pytest.mark.parametrize("algorithm", ["tbfsl", "bfsl", "ga", "sa", "fs"])
def test_same_seed_same_result_and_another_seed_another_way(algorithm):
    options = {"sa": {"iterations": 300}, "bfsl": {"depth": 2}}.get(algorithm, {})
    first = search(BEAM, algorithm, seed=3, **options)
    assert same(first, search(BEAM, algorithm, seed=3, **options))
    assert not np.array_equal(first.history.value, search(BEAM, algorithm, seed=4, **options).history.value)
    # what it says is true
    assert BEAM.solved_directly(first.best_design) == pytest.approx(first.value, rel=1e-9)
    assert (np.diff(first.history.value) < 0).all()
    assert first.history.simulation[-1] <= first.simulations


def test_a_tbfsl_ends_where_no_neighbour_is_better():
    found = search(BEAM, "tbfsl", depth=2, radius=1, seed=5)
    assert found.stopped == "no better neighbour"
    for k in (1, 2):
        flips = flips_within(~BEAM.fixed, k, 1)
        designs = np.repeat(found.best_design.reshape(1, -1), len(flips), axis=0)
        designs[np.arange(len(flips))[:, None], flips] ^= True
        values = BEAM.endpoint_displacement(designs.reshape(-1, 4, 6))
        assert not (values < found.value * (1 - 1e-9)).any()


def test_a_search_as_deep_as_there_are_cells_finds_the_global_optimum():
    beam = Cantilever(4, 3)
    best = brute_force(beam)
    for seed in range(3):
        found = search(beam, "bfsl", depth=6, seed=seed)
        assert found.value == pytest.approx(float(best.endpoint_displacement[0]), rel=1e-9)
    everything = search(beam, "bf")
    assert everything.simulations == int(best.n_valid)
    assert everything.value == pytest.approx(found.value, rel=1e-9)


def test_random_sampling_stops_at_the_limit_and_never_repeats_itself():
    beam = Cantilever(4, 3)
    best = float(brute_force(beam).endpoint_displacement[0])
    found = search(beam, "rs", limit=best * (1 + 1e-9), seed=0)
    assert found.stopped == "limit reached"
    assert found.simulations <= int(brute_force(beam).n_valid)


def test_problems_without_traps_are_solved_by_all():
    problem = Pattern()
    for algorithm, options in {"bfsl": {"depth": 1}, "tbfsl": {}, "sa": {"iterations": 4000}}.items():
        assert search(problem, algorithm, seed=1, **options).value == 0.0
    assert search(problem, "ga", seed=1, patience=30, mutation=0.02).value <= 2.0


def test_failed_evaluations_are_counted_and_never_the_best():
    problem = Pattern()
    problem.fails = True
    found = search(problem, "tbfsl", seed=2)
    assert found.failed > 0
    assert np.isfinite(found.value)


def test_at_zero_temperature_nothing_worse_is_kept():
    assert not accepts(1e-12, 0.0, 0.0)
    assert accepts(-1.0, 0.0, 1.0)
    assert accepts(0.1, 0.1, np.exp(-1) * 0.999) and not accepts(0.1, 0.1, np.exp(-1) * 1.001)
    assert not accepts(np.nan, 1.0, 0.0)


def test_cavities_have_no_outer_edge():
    design = np.ones((5, 5), dtype=bool)
    design[2, 2] = False
    assert not outer_edge(design).any()
    design[2, 3:] = False  # opens it
    assert outer_edge(design)[1, 2] and outer_edge(design)[2, 2]


def test_each_cell_of_another_grid_is_as_the_nearest_one():
    """6 x 2 onto 8 x 3, as in Fig. 6."""
    coarse = np.array([[1, 1, 0, 1, 1, 1], [1, 0, 1, 0, 1, 0]], dtype=bool)
    fine = scaled(coarse, 8, 3)
    for i, j in np.ndindex(3, 8):
        x, y = (j + 0.5) / 8 * 6, (i + 0.5) / 3 * 2
        near = np.abs(np.arange(6) + 0.5 - x), np.abs(np.arange(2) + 0.5 - y)
        allowed = {coarse[r, c] for r in np.flatnonzero(near[1] < near[1].min() + 1e-9)
                   for c in np.flatnonzero(near[0] < near[0].min() + 1e-9)}  # fmt: skip
        assert fine[i, j] in allowed


def test_several_grids_end_on_the_last_one_with_a_value_of_its_own():
    stages = [(4, 3, "tbfsl", {"depth": 2, "radius": 2}), (6, 4, "tbfsl", {"depth": 1, "radius": 0})]
    found = search(BEAM, "mg", stages=stages, seed=0)
    assert found.best_design.shape == (4, 6)
    assert set(found.history.stage) == {0, 1}
    assert BEAM.solved_directly(found.best_design) == pytest.approx(found.value, rel=1e-9)
    with pytest.raises(ValueError, match="the last one must have the problem's 6 columns and 4 rows"):
        search(BEAM, "mg", stages=stages[:1])


def test_simulations_can_be_limited():
    found = search(BEAM, "sa", seed=0, max_simulations=25)
    assert (found.simulations, found.stopped) == (25, "simulations used up")


def test_several_grids_stopped_on_the_way_say_which_one_they_have_reached():
    stages = [(4, 3, "tbfsl", {}), (6, 4, "tbfsl", {})]
    found = search(BEAM, "mg", stages=stages, seed=0, max_simulations=5)
    assert found.best_design.shape == (3, 4)
    assert found.problem == repr(Cantilever(4, 3))


@pytest.mark.parametrize("algorithm", ["tbfsl", "ga", "sa", "tabu", "ils"])
def test_what_is_not_finite_has_failed(algorithm):
    problem = Returns(
        lambda values: np.where(values == 3, -np.inf, np.where(values == 4, np.inf, values)).tolist()
    )
    found = search(problem, algorithm, seed=1, **({"iterations": 500} if algorithm == "sa" else {}))
    assert np.isfinite(found.value) and found.failed > 0


@pytest.mark.parametrize("algorithm", ["tbfsl", "bfsl", "fs", "ga", "sa", "tabu", "ils", "bf"])
@pytest.mark.parametrize("grid", [(1, 1), (1, 4), (6, 1)])
def test_where_nothing_can_change_the_only_design_is_the_best(algorithm, grid):
    beam = Cantilever(*grid)
    found = search(beam, algorithm)
    assert found.value == beam.endpoint_displacement(beam.fixed[None])[0]


@pytest.mark.slow
def test_workers_find_what_one_process_finds():
    alone = search(BEAM, "tbfsl", depth=3, radius=2, seed=6)
    assert same(alone, search(BEAM, "tbfsl", depth=3, radius=2, seed=6, workers=2))


@pytest.mark.slow
def test_a_dask_cluster_finds_what_one_process_finds():
    distributed = pytest.importorskip("distributed")
    alone = search(BEAM, "ga", seed=6)

    # as one that is defined in a script: no module of the workers has it
    class Own(Pattern):
        pass

    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        assert same(alone, search(BEAM, "ga", seed=6, client=client))
        assert same(search(Own(), "tbfsl", seed=1), search(Own(), "tbfsl", seed=1, client=client))


def test_a_journal_is_a_memory_of_values_and_only_of_its_own_run(tmp_path):
    path = tmp_path / "run.sqlite"
    first = search(BEAM, "tbfsl", seed=1, journal=path)
    with closing(sqlite3.connect(path)) as connection:
        (count,) = connection.execute("SELECT count(*) FROM evaluation").fetchone()
    assert count > 0
    assert same(first, search(BEAM, "tbfsl", seed=1, journal=path, resume=True))
    with pytest.raises(ValueError, match="is there already"):
        search(BEAM, "tbfsl", seed=1, journal=path)
    with pytest.raises(ValueError, match=r"another run, with seed = 1; this one has seed = 2"):
        search(BEAM, "tbfsl", seed=2, journal=path, resume=True)
    other = tmp_path / "other.sqlite"
    other.write_bytes(b"no database at all, but long enough to be taken for one" * 30)
    before = other.read_bytes()
    with pytest.raises(ValueError, match="journal"):
        search(BEAM, "tbfsl", seed=1, journal=other, resume=True)
    assert other.read_bytes() == before
