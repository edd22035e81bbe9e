"""The searches: what they find, that they find it again, and that a kill costs nothing."""

import sqlite3
from contextlib import closing
from itertools import combinations
from typing import ClassVar

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.optimization import Cantilever, search
from slmm.optimization.algorithms.annealing import accepts
from slmm.optimization.algorithms.breadth_first import flips_within
from slmm.optimization.algorithms.free_shape import outer_edge
from slmm.optimization.algorithms.multi_grid import scaled
from slmm.optimization.ask import Flipped
from slmm.optimization.cantilever.brute_force import brute_force
from slmm.optimization.runs import search_runs

BEAM = Cantilever(6, 4)


class Pattern:
    """How many cells differ from a hidden pattern: one optimum, no traps; some designs fail."""

    objective: ClassVar = {"units": "1", "long_name": "cells that are wrong"}
    fails = False

    def __init__(self, rows=4, columns=5):
        self.shape = rows, columns
        self.fixed = np.zeros(self.shape, dtype=bool)
        self.fixed[0, 0] = True
        self.start = self.fixed
        self.hidden = np.random.default_rng(0).random(self.shape) < 0.5
        self.hidden[0, 0] = True

    def __repr__(self):
        return f"Pattern{self.shape}"

    def valid(self, designs):
        return designs[:, 0, 0]

    def evaluate(self, designs):
        wrong = (designs != self.hidden).sum(axis=(1, 2)).astype(float)
        return np.where(wrong == 3, np.nan, wrong) if self.fails else wrong

    def repaired(self, design):
        return design | self.fixed

    def resized(self, columns, rows):
        return Pattern(rows, columns)


class Plain:
    """A cantilever without a quick model of neighbours."""

    def __init__(self, beam):
        self.beam = beam

    def __getattr__(self, name):
        if name in ("neighbours", "beam") or name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.beam, name)


class Rough(Plain):
    """A cantilever with a model of neighbours that is off by as much as it says, or knows nothing."""

    error = 2e-3

    def neighbours(self, centre):
        self.centre = centre
        return self

    def evaluate(self, asked):
        # flips come two-dimensional
        if asked.ndim == 3:
            return self.beam.evaluate(asked)
        rng = np.random.default_rng(asked.sum())
        error = self.error * rng.uniform(0, 2, len(asked))
        values = self.beam.evaluate(Flipped(self.centre, asked)[:]) + error * rng.uniform(-1, 1, len(asked))
        return np.where(rng.random(len(asked)) < 0.1, np.nan, values), error


def same(a, b):
    assert a.value == b.value and a.simulations == b.simulations and a.stopped == b.stopped
    np.testing.assert_array_equal(a.best_design, b.best_design)
    np.testing.assert_array_equal(a.history.value, b.history.value)
    np.testing.assert_array_equal(a.history.simulation, b.history.simulation)
    return True


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


def test_quick_neighbours_lead_to_what_direct_values_confirm():
    quick = search(Cantilever(12, 6), "tbfsl", depth=2, radius=2, seed=1)
    plain = search(Plain(Cantilever(12, 6)), "tbfsl", depth=2, radius=2, seed=1)
    assert quick.value == pytest.approx(plain.value, rel=1e-9)
    np.testing.assert_array_equal(quick.best_design, plain.best_design)
    assert quick.simulations == plain.simulations


@pytest.mark.parametrize("seed", range(3))
def test_a_rough_model_that_knows_its_error_changes_nothing(seed):
    assert same(search(Rough(BEAM), "tbfsl", seed=seed), search(Plain(BEAM), "tbfsl", seed=seed))


def test_what_a_model_says_is_worse_is_not_evaluated():
    def direct_evaluations(error):
        evaluated = []

        class Counting(Rough):
            def evaluate(self, designs):
                if designs.ndim == 3:
                    evaluated.append(len(designs))
                return super().evaluate(designs)

        Counting.error = error
        search(Counting(BEAM), "tbfsl", seed=0)
        return sum(evaluated)

    assert direct_evaluations(1e-9) < direct_evaluations(1e-3) < direct_evaluations(1.0)


def test_simulations_can_be_limited():
    found = search(BEAM, "sa", seed=0, max_simulations=25)
    assert (found.simulations, found.stopped) == (25, "simulations used up")


def test_several_grids_stopped_on_the_way_say_which_one_they_have_reached():
    stages = [(4, 3, "tbfsl", {}), (6, 4, "tbfsl", {})]
    found = search(BEAM, "mg", stages=stages, seed=0, max_simulations=5)
    assert found.best_design.shape == (3, 4)
    assert found.problem == repr(Cantilever(4, 3))


class Returns(Pattern):
    """Whose evaluation returns something else."""

    def __init__(self, what):
        super().__init__()
        self.what = what

    def evaluate(self, designs):
        return self.what(super().evaluate(designs))


@pytest.mark.parametrize(
    ("what", "words"),
    [
        (
            lambda values: values[:-1],
            r"must return 1 real numbers for as many designs, and returned float64 of shape \(0,\)",
        ),
        (lambda values: values[:, None], r"returned float64 of shape \(1, 1\)"),
        (lambda values: 1.0, r"returned float64 of shape \(\)"),
        (lambda values: values + 1j, "returned complex128"),
    ],
)
def test_values_of_a_wrong_shape_or_kind_are_named(what, words):
    with pytest.raises(ValueError, match=words):
        search(Returns(what), "tbfsl", seed=1)


@pytest.mark.parametrize("algorithm", ["tbfsl", "ga", "sa", "tabu"])
def test_what_is_not_finite_has_failed(algorithm):
    problem = Returns(
        lambda values: np.where(values == 3, -np.inf, np.where(values == 4, np.inf, values)).tolist()
    )
    found = search(problem, algorithm, seed=1, **({"iterations": 500} if algorithm == "sa" else {}))
    assert np.isfinite(found.value) and found.failed > 0


@pytest.mark.parametrize("algorithm", ["tbfsl", "bfsl", "fs", "ga", "sa", "tabu", "bf"])
@pytest.mark.parametrize("grid", [(1, 1), (1, 4), (6, 1)])
def test_where_nothing_can_change_the_only_design_is_the_best(algorithm, grid):
    beam = Cantilever(*grid)
    found = search(beam, algorithm)
    assert found.value == beam.endpoint_displacement(beam.fixed[None])[0]


def test_a_journal_needs_a_problem_that_has_a_name(tmp_path):
    class Nameless(Pattern):
        __repr__ = object.__repr__

    with pytest.raises(ValueError, match="needs a __repr__ of its own"):
        search(Nameless(), journal=tmp_path / "run.sqlite")
    assert not any(tmp_path.iterdir())
    assert repr(Cantilever(np.int64(6), 4)) == repr(BEAM)


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


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"algorithm": "newton"}, "algorithm = 'newton': must be one of"),
        ({"speed": 3}, "speed: is no setting; must be one of depth, radius"),
        ({"depth": 0}, "depth = 0: must be a whole number"),
        ({"workers": 0}, "workers = 0: must be a whole number"),
        ({"resume": True}, "resume: needs a journal"),
        ({"algorithm": "rs"}, "limit: must be given"),
        ({"seed": 2**63}, "seed = 9223372036854775808: must be a whole number from 0 to"),
        ({"algorithm": "ga", "scale": "x"}, "scale = 'x': must be a number"),
        ({"algorithm": "ga", "scale": 0}, "scale = 0: must be positive"),
        ({"algorithm": "mg", "stages": 5}, "stages = 5: must be a sequence"),
        (
            {"algorithm": "mg", "stages": [(6, 4, "tbfsl")]},
            "must be columns, rows, an algorithm and its settings",
        ),
        (
            {"algorithm": "mg", "stages": [(4, 3, "tbfsl", {}), (6, 4, "tbfsl", {"depth": 0})]},
            "mg: stage 6 x 4: tbfsl: depth = 0: must be",
        ),
        (
            {"algorithm": "mg", "stages": [(6, 4, "tbfsl", {})], "start": np.ones(4)},
            "start: must be one design",
        ),
        ({"start": np.zeros((4, 6))}, "start: must have the fixed cells"),
        ({"start": np.ones((3, 6))}, "start: must have 4 rows and 6 columns"),
    ],
)
def test_bad_requests_are_refused_by_name(options, words):
    with pytest.raises(ValueError, match=words):
        search(BEAM, **options)


def test_too_many_neighbours_are_refused_before_the_work():
    evaluated = []

    class Watched(Pattern):
        def evaluate(self, designs):
            evaluated.append(len(designs))
            return super().evaluate(designs)

    with pytest.raises(ValueError, match="120,691,649 combinations of 899 cells"):
        search(Watched(30, 30), "bfsl", depth=4)
    assert not evaluated


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
