"""Problems whose designs take long: bounds, shared keys, failures, workers that do not wait for others, and kills."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import Future
from contextlib import closing
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from slmm.optimization import search
from slmm.optimization.ask import Ask, Flipped
from slmm.optimization.evaluation import Evaluation
from slmm.optimization.journal import FORMAT, open_journal
from slmm.optimization.memory import Memory
from slmm.optimization.problem import Bound, Value
from slmm.optimization.workers import Failure

ALL = {
    "tbfsl": {},
    "bfsl": {"depth": 2},
    "fs": {},
    "ga": {"population": 20, "recombinations": 5, "mutation": 0.02},
    "sa": {"iterations": 300, "temperature": 1.0},
    "rs": {"limit": 2.5},
    "bf": {},
    "tabu": {"steps": 60},
}


class Rows:
    """How far the rows of a design are from a hidden one; row after row is looked at, and a bad design given up.

    Some designs fail after the first rows, if they are not given up before. What is evaluated is written to a file.
    """

    objective: ClassVar = {"units": "mm", "long_name": "distance"}
    shape = (4, 4)
    start = np.zeros(shape, dtype=bool)
    fixed = np.arange(16).reshape(shape) >= 12
    hidden = np.random.default_rng(5).random(shape) < 0.5
    weight = np.random.default_rng(6).uniform(0.5, 1.5, shape)

    def __init__(self, log=None, seconds=0.0, fails=0.2):
        self.log, self.seconds, self.fails = log, seconds, fails

    def __repr__(self):
        return f"Rows(fails={self.fails})"

    def valid(self, designs):
        return designs.sum(axis=(1, 2)) % 7 != 6

    def repaired(self, design):
        return design ^ (np.arange(16).reshape(4, 4) == 0) if design.sum() % 7 == 6 else design

    def evaluate(self, design, below):
        time.sleep(self.seconds * np.random.default_rng().exponential())
        found = self.found(design, below)
        if self.log is not None:
            with open(self.log, "a") as file:
                file.write(json.dumps([self.name(design).hex(), below, str(found)]) + "\n")
        if isinstance(found, Exception):
            raise found
        return found

    def found(self, design, below):
        fails = np.random.default_rng(np.packbits(design)).random() < self.fails
        total = 0.0
        for row in range(4):
            total += float((self.weight[row] * (design[row] != self.hidden[row])).sum())
            if total >= below:
                return Bound(total)
            if fails and row == 1:
                return ArithmeticError("the mesh is tangled")
        return Value(total)

    def name(self, design):
        return np.packbits(design).tobytes()


class AtOnce(Rows):
    """The same by values of many designs."""

    def evaluate(self, designs):
        found = [self.found(design, np.inf) for design in designs]
        return np.array([each.value if isinstance(each, Value) else np.nan for each in found])


class Mirrored(Rows):
    """Where designs are equal to their mirror images."""

    def key(self, design):
        return min(np.packbits(design).tobytes(), np.packbits(design[:, ::-1]).tobytes())

    name = key

    def found(self, design, below):
        design = np.unpackbits(np.frombuffer(self.key(design), dtype=np.uint8)).reshape(4, 4).astype(bool)
        return super().found(design, below)


class WithModel(Rows):
    """With a quick model of neighbours, which is off by as much as it says, or knows nothing."""

    def neighbours(self, centre):
        return Around(self, centre)


class Around:
    def __init__(self, problem, centre):
        self.problem, self.centre = problem, centre

    def evaluate(self, flips):
        values = [self.problem.found(design, 1e9) for design in Flipped(self.centre, flips)[:]]
        values = np.array([each.value if isinstance(each, Value) else np.nan for each in values])
        dice = np.random.default_rng(flips.sum())
        error = dice.uniform(0, 0.5, len(flips))
        return np.where(dice.random(len(flips)) < 0.1, np.nan, values + error * dice.uniform(-1, 1)), error


def evaluated(log):
    """Keys, limits and what was found."""
    return [(key, below, found) for key, below, found in map(json.loads, Path(log).read_text().splitlines())]


def same(a, b):
    assert (a.value, a.simulations, a.stopped) == (b.value, b.simulations, b.stopped)
    np.testing.assert_array_equal(a.best_design, b.best_design)
    np.testing.assert_array_equal(a.history.value, b.history.value)
    np.testing.assert_array_equal(a.history.simulation, b.history.simulation)
    return True


@pytest.mark.parametrize("algorithm", ALL)
def test_bounds_change_no_search(algorithm):
    assert same(
        search(Rows(), algorithm, seed=3, **ALL[algorithm]),
        search(AtOnce(), algorithm, seed=3, **ALL[algorithm]),
    )


def test_a_design_is_given_up_as_soon_as_it_cannot_be_better(tmp_path):
    for algorithm in ("tbfsl", "bf", "sa"):
        log = tmp_path / algorithm
        search(Rows(log), algorithm, seed=3, **ALL[algorithm])
        kinds = Counter(found.partition("(")[0] for _, _, found in evaluated(log))
        assert kinds["Bound"] > kinds["Value"]


def test_a_quick_model_spares_evaluations_and_changes_nothing(tmp_path):
    for seed in range(3):
        logs = tmp_path / f"plain{seed}", tmp_path / f"model{seed}"
        plain, quick = (
            search(kind(log), "tbfsl", seed=seed) for kind, log in zip((Rows, WithModel), logs, strict=True)
        )
        assert same(plain, quick)
        few, many = len(evaluated(logs[1])), len(evaluated(logs[0]))
        assert few < 0.6 * many


@pytest.mark.parametrize("kind", [Rows, Mirrored])
@pytest.mark.parametrize("algorithm", ALL)
def test_nothing_is_evaluated_whose_answer_is_known(kind, algorithm, tmp_path):
    search(kind(tmp_path / "log"), algorithm, seed=2, **ALL[algorithm])
    least, failed = {}, {}
    for key, below, found in evaluated(tmp_path / "log"):
        assert least.get(key, -np.inf) < below < failed.get(key, np.inf) or key not in failed | least
        if found.startswith("Bound"):
            least[key] = float(found[len("Bound(least=") : -1])
        elif found.startswith("Value"):
            least[key] = np.inf
        else:
            failed[key] = below


def test_symmetric_designs_share_what_is_found(tmp_path):
    shared = search(Mirrored(tmp_path / "shared"), "bf")
    names = {key for key, *_ in evaluated(tmp_path / "shared")}
    assert shared.simulations > 1.8 * len(names)
    with pytest.raises(ValueError, match=r"key must return bytes, and returned 'left'"):
        problem = Mirrored()
        problem.key = lambda design: "left"
        search(problem)


class Scripted(Evaluation):
    """Two workers that come back in a given order; answers by keys are of a single cell."""

    def __init__(self, values, order):
        self.values_of, self.order, self.sent = values, list(order), []
        self.number = 2
        super().__init__(self, Memory())
        self.futures = {}

    def one(self, problem, design, below):
        cell = int(design.argmax())
        self.sent.append(cell)
        self.futures[cell] = Future()
        return self.futures[cell]

    def take_in(self):
        cell = self.order.pop(0)
        self.futures[cell].set_result(self.values_of[cell])
        super().take_in()


def single_cells(cells):
    designs = np.zeros((len(cells), 4, 4), dtype=bool)
    designs.reshape(-1, 16)[np.arange(len(cells)), cells] = True
    return designs


def test_the_next_design_goes_out_as_soon_as_a_worker_is_free():
    values = {0: Value(5.0), 1: Bound(4.0), 2: Failure("lost"), 3: Value(1.0), 4: Value(2.0), 5: Value(0.5)}
    at_work = Scripted(values, order=[1, 2, 3, 0, 4])
    parts = at_work.answer(Ask(Rows(), single_cells([0, 1, 2, 3, 4, 5]), below=3.0, needed=3.0))
    (first,) = parts
    # 0 takes longest; no other waits for it, and behind 3, which is good enough, none goes out
    assert at_work.sent == [0, 1, 2, 3]
    np.testing.assert_array_equal(first.values, [np.inf, np.inf, np.nan, 1.0])


def test_the_answer_ends_with_the_first_in_order_and_later_ones_are_remembered():
    values = {0: Value(2.5), 1: Value(1.0), 2: Value(4.0), 3: Value(2.0)}
    at_work = Scripted(values, order=[1, 0, 2, 3])
    (part,) = at_work.answer(Ask(Rows(), single_cells([0, 1, 2]), below=3.0, needed=3.0))
    assert part.values.tolist() == [2.5] and at_work.sent == [0, 1]
    # the next question knows it, but tells it as one worker would, who had found a bound
    parts = at_work.answer(Ask(Rows(), single_cells([2, 1, 3]), below=0.9, needed=0.9))
    assert [value for part in parts for value in part.values] == [np.inf] * 3
    assert at_work.sent == [0, 1, 2, 3]


def test_what_is_still_out_serves_the_next_question():
    values = {0: Value(2.0), 1: Value(1.0), 2: Value(5.0)}
    at_work = Scripted(values, order=[0, 2, 1])
    (part,) = at_work.answer(Ask(Rows(), single_cells([0, 1]), below=3.0, needed=3.0))
    assert part.values.tolist() == [2.0] and list(at_work.out) == [b"4x4:\x40\x00"]
    parts = list(at_work.answer(Ask(Rows(), single_cells([1, 2]), below=1.5, needed=1.5)))
    assert [part.values.tolist() for part in parts] == [[1.0]]
    assert at_work.sent == [0, 1, 2] and not at_work.out and not at_work.order


def test_a_bound_that_does_not_answer_is_asked_again():
    at_work = Scripted({0: Bound(2.0)}, order=[0, 0])
    list(at_work.answer(Ask(Rows(), single_cells([0]), below=1.5, needed=1.5)))
    list(at_work.answer(Ask(Rows(), single_cells([0]), below=2.0, needed=2.0)))
    assert at_work.sent == [0]
    at_work.values_of[0] = Value(2.25)
    (part,) = at_work.answer(Ask(Rows(), single_cells([0]), below=3.0, needed=3.0))
    assert part.values.tolist() == [2.25] and at_work.sent == [0, 0]


def test_a_question_needs_at_least_what_is_below_its_limit():
    with pytest.raises(ValueError, match=r"needed = 1.0: must not be less than below = 2.0"):
        Ask(Rows(), single_cells([0]), below=2.0, needed=1.0)


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ["tbfsl", "ga", "tabu", "bf"])
def test_several_workers_find_what_one_finds(algorithm, tmp_path):
    problem = Mirrored(seconds=1e-3)
    options = {**ALL[algorithm], "max_simulations": 400}
    alone = search(problem, algorithm, seed=6, **options)
    several = search(problem, algorithm, seed=6, workers=2, journal=tmp_path / "run.sqlite", **options)
    assert same(alone, several) and alone.failed == several.failed > 0
    # what was evaluated ahead is in the journal, and does not change what one worker finds with it
    again = search(problem, algorithm, seed=6, journal=tmp_path / "run.sqlite", resume=True, **options)
    assert same(alone, again) and alone.failed == again.failed


@pytest.mark.slow
def test_a_dask_cluster_finds_what_one_worker_finds():
    distributed = pytest.importorskip("distributed")
    problem = Rows(seconds=1e-3)
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        assert same(search(problem, "tbfsl", seed=1), search(problem, "tbfsl", seed=1, client=client))


def recorded(path):
    """Designs in each table of a journal."""
    with closing(sqlite3.connect(path)) as connection:
        return {
            table: {design for (design,) in connection.execute(f"SELECT design FROM {table}")}
            for table in ("evaluation", "bound", "failure")
        }


def test_a_journal_keeps_bounds_as_bounds_and_failures_with_their_reason(tmp_path):
    path, log = tmp_path / "run.sqlite", tmp_path / "log"
    first = search(Rows(log), "tbfsl", seed=3, journal=path)
    assert all(recorded(path).values())
    with closing(sqlite3.connect(path)) as connection:
        reasons = {reason for (reason,) in connection.execute("SELECT reason FROM failure")}
        (least,) = connection.execute("SELECT min(least) FROM bound").fetchone()
    assert reasons == {"ArithmeticError: the mesh is tangled"}
    assert least >= first.value
    log.unlink()
    assert same(first, search(Rows(log), "tbfsl", seed=3, journal=path, resume=True))
    assert not log.exists()


@pytest.mark.parametrize("table", ["bound", "failure"])
def test_a_journal_that_was_changed_is_damaged(table, tmp_path):
    path = tmp_path / "run.sqlite"
    search(Rows(), "tbfsl", seed=3, journal=path)
    column = {"bound": "least", "failure": "below"}[table]
    for change in (f"{column} + 1", "'x'"):
        with closing(sqlite3.connect(path)) as connection, connection:
            connection.execute(f"UPDATE {table} SET {column} = {change}")
        with pytest.raises(ValueError, match="is damaged: a value"):
            search(Rows(), "tbfsl", seed=3, journal=path, resume=True)


def test_a_journal_of_values_alone_is_read_and_one_of_the_future_is_not(tmp_path):
    path = tmp_path / "run.sqlite"
    run = {"of": "a test"}
    with open_journal(path, run) as journal:
        journal.add({b"a": 1.0, b"b": float("nan")})
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript("DROP TABLE bound; DROP TABLE failure; PRAGMA user_version = 0")
    with open_journal(path, run, resume=True) as journal:
        assert str(journal.memory().values) == "{b'a': 1.0, b'b': nan}"
        journal.write_one(b"c", 2.0, Bound(3.0))
    with open_journal(path, run, resume=True) as journal:
        assert journal.memory().bounds == {b"c": 3.0}
    with closing(sqlite3.connect(path)) as connection:
        connection.execute(f"PRAGMA user_version = {FORMAT + 1}")
    with (
        pytest.raises(
            ValueError, match=f"has the format {FORMAT + 1}; this version of slmm reads those up to"
        ),
        open_journal(path, run, resume=True),
    ):
        pass


SCRIPT = """
import sys
sys.path.insert(0, {folder!r})
from slmm.optimization import search
from test_expensive import Mirrored
if __name__ == "__main__":
    search(Mirrored({log!r}, seconds=5e-3), "tbfsl", seed=6, journal={path!r}, resume=True, workers={workers})
"""


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_killed_it_goes_on_with_every_value_bound_and_failure(workers, tmp_path):
    path, log = tmp_path / "run.sqlite", tmp_path / "log"
    names = {"folder": str(Path(__file__).parent), "log": str(log), "path": str(path), "workers": workers}
    count = 0
    for more in (10, 15, 20):
        process = subprocess.Popen([sys.executable, "-c", SCRIPT.format(**names)], env=os.environ)
        deadline = time.monotonic() + 60
        while count < more and time.monotonic() < deadline:
            time.sleep(0.005)
            count = len(log.read_text().splitlines()) if log.exists() else 0
        assert process.poll() is None
        process.send_signal(signal.SIGKILL)
        process.wait()
        time.sleep(0.2)  # workers end with it
    undisturbed = search(Mirrored(tmp_path / "undisturbed"), "tbfsl", seed=6)
    resumed = search(Mirrored(log), "tbfsl", seed=6, journal=path, resume=True)
    assert same(undisturbed, resumed) and undisturbed.failed == resumed.failed
    # all that a kill costs is what was under way
    twice = Counter((key, found) for key, _, found in evaluated(log))
    assert sum(twice.values()) - len(twice) <= 3 * workers


def test_a_problem_that_fails_at_every_design_says_why(tmp_path):
    class Hopeless(Rows):
        def found(self, design, below):
            return OSError("no licence for \udcff")

    with pytest.raises(
        RuntimeError, match=r"none of 23 simulated designs has a value, one of them as OSError: no licence"
    ):
        search(Hopeless(), "tbfsl", seed=1, depth=2, radius=1, journal=tmp_path / "run.sqlite")


def test_what_is_neither_a_value_nor_a_bound_is_named():
    for returned, words in (
        (3.0, "must return a Value, or a Bound that is not below inf, and returned 3.0"),
        (Bound(3.0), r"a Bound that is not below inf, and returned Bound\(least=3.0\)"),
        (Bound(np.inf), "a Bound that is not below inf"),
    ):
        problem = Rows()
        problem.found = lambda design, below, returned=returned: returned
        with pytest.raises(ValueError, match=words):
            search(problem)
    problem = Rows()
    problem.found = lambda design, below: Value(np.nan)
    with pytest.raises(RuntimeError, match="one of them as its value is nan"):
        search(problem)
