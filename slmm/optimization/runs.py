"""Several runs of one search, with seeds that follow one another, as one dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import as_completed
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from slmm.optimization.checks import check_whole
from slmm.optimization.problem import Problem
from slmm.optimization.search import SearchResult, search
from slmm.running.processes import processes
from slmm.running.progress import Progress, silent


def search_runs(
    problem: Problem,
    algorithm: str = "tbfsl",
    *,
    runs: int = 1,
    seed: int = 0,
    workers: int = 1,
    journals: str | Path | None = None,
    resume: bool = False,
    progress: Progress = silent,
    **options: Any,
) -> xr.Dataset:
    """Search again and again, the k-th time with seed + k.

    Parameters
    ----------
    runs : int
    workers : int
        Number of processes on this machine. Several runs go side by side, one has its designs evaluated side by side;
        the results are the same. Scripts that ask for more than one need ``if __name__ == "__main__":``.
    journals : str or Path, optional
        A folder for the journal of each run, see `slmm.optimization.journal`; made where it is missing.
    resume : bool
        Go on with the journals that are there.
    progress : callable
        Is told the share of runs that is done, and their number of simulations and best value so far in words.
    problem, algorithm, seed, options
        As in `slmm.optimization.search`.

    Returns
    -------
    xarray.Dataset
        The variables of `SearchResult.to_dataset` over ``run``; histories are filled up with NaN.

    Raises
    ------
    ValueError
        When runs or workers is less than 1, and as in `search`.

    Examples
    --------
    >>> from slmm.optimization import Cantilever
    >>> found = search_runs(Cantilever(4, 3), "tbfsl", runs=3)
    >>> found.value.dims, found.value.round(5).values.tolist()
    (('run',), [0.00717, 0.00717, 0.00717])
    """
    check_whole("runs", runs, 1)
    check_whole("workers", workers, 1)
    if journals is not None:
        Path(journals).mkdir(parents=True, exist_ok=True)
    one = partial(_one, problem, algorithm, seed, journals, resume, options)
    told = _Told(progress, runs, problem.objective["units"])
    results: dict[int, SearchResult] = {}
    for k, result in (
        _beside(one, runs, workers) if min(runs, workers) > 1 else _in_turn(one, runs, workers, told)
    ):
        results[k] = result
        told.of_run(result)
    each = [results[k].to_dataset() for k in range(runs)]
    each = [one.assign_coords(improvement=np.arange(one.sizes["improvement"])) for one in each]
    joined = xr.concat(each, dim="run", join="outer", combine_attrs="drop_conflicts")
    joined.attrs.pop("stopped", None)
    joined["stopped"] = (
        "run",
        np.array([results[k].stopped for k in range(runs)], dtype=object),
        {"units": "1", "long_name": "why"},
    )
    joined["seed"] = (
        "run",
        [results[k].seed for k in range(runs)],
        {"units": "1", "long_name": "of the random numbers"},
    )
    return joined


def _one(
    problem: Problem,
    algorithm: str,
    seed: int,
    journals: str | Path | None,
    resume: bool,
    options: dict[str, Any],
    k: int,
    **more: Any,
) -> SearchResult:
    """The k-th run."""
    journal = None if journals is None else Path(journals) / f"run-{seed + k}.sqlite"
    return search(problem, algorithm, seed=seed + k, journal=journal, resume=resume, **options, **more)


def _in_turn(
    one: Callable[..., SearchResult], runs: int, workers: int, told: _Told
) -> Iterator[tuple[int, SearchResult]]:
    for k in range(runs):
        yield k, one(k, workers=workers, progress=told.on_the_way)


def _beside(one: Callable[..., SearchResult], runs: int, workers: int) -> Iterator[tuple[int, SearchResult]]:
    """Each run in a process, in the order in which they end."""
    with processes(min(runs, workers)) as pool:
        waiting = {pool.submit(one, k): k for k in range(runs)}
        for future in as_completed(waiting):
            yield waiting[future], future.result()


class _Told:
    """Sums up what is told."""

    def __init__(self, progress: Progress, of: int, units: str) -> None:
        self.progress, self.of, self.units = progress, of, units
        self.runs = self.simulations = 0
        self.best = np.inf

    def on_the_way(self, simulations: int, value: float) -> None:
        """By a run that goes on."""
        self.say(self.simulations + simulations, min(self.best, value))

    def of_run(self, result: SearchResult) -> None:
        """By one that is done."""
        self.runs, self.simulations = self.runs + 1, self.simulations + result.simulations
        self.best = min(self.best, result.value)
        self.say(self.simulations, self.best)

    def say(self, simulations: int, best: float) -> None:
        """All of it."""
        words = (
            f"{self.runs} of {self.of} runs done: {simulations:,} simulations, best {best:.6g} {self.units}"
        )
        self.progress(self.runs / self.of, words)
