"""Problems whose designs take long: bounds, shared keys, failures, workers that do not wait for others, and kills."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from expensive_problems import AtOnce, Mirrored, Rows, WithModel
from quick_problems import same

from slmm.optimization import search
from slmm.optimization.problem import Bound, Value

ALL = {
    "tbfsl": {},
    "bfsl": {"depth": 2},
    "fs": {},
    "ga": {"population": 20, "recombinations": 5, "mutation": 0.02},
    "sa": {"iterations": 300, "temperature": 1.0},
    "rs": {"limit": 2.5},
    "bf": {},
    "tabu": {"steps": 60},
    "ils": {"starts": 4, "kick": 2},
}


def evaluated(log):
    """Keys, limits and what was found."""
    return [(key, below, found) for key, below, found in map(json.loads, Path(log).read_text().splitlines())]


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


SCRIPT = """
import sys
sys.path.insert(0, {folder!r})
from slmm.optimization import search
from expensive_problems import Mirrored
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
    # each of three kills loses what workers are at, and what is done and on its way to the journal
    assert sum(twice.values()) - len(twice) <= 3 * 2 * workers


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
