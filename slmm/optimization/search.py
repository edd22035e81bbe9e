"""A search for the best design of a problem, by the algorithms of Paper C, by tabu or by iterated local search."""

from __future__ import annotations

import json
from collections import ChainMap
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from slmm import __version__
from slmm.optimization.algorithms.multi_grid import mg
from slmm.optimization.algorithms.registry import ON_ONE_GRID, Algorithm, chosen, completed
from slmm.optimization.ask import Ask, Asking, improvements
from slmm.optimization.checks import check_whole
from slmm.optimization.evaluation import Evaluation, Part
from slmm.optimization.journal import open_journal
from slmm.optimization.memory import Memory
from slmm.optimization.problem import NEEDED, Problem, check_has
from slmm.optimization.workers import evaluating

if TYPE_CHECKING:
    from distributed import Client

ALGORITHMS: Mapping[str, Algorithm] = ChainMap({"mg": mg}, ON_ONE_GRID)

#: is told the number of simulations, and the best value so far: results on the way, where nobody knows how far it is
Found = Callable[[int, float], None]
#: is told each better design and its value
Improved = Callable[[np.ndarray, float], None]


@dataclass(frozen=True)
class History:
    """How the best value came down.

    Parameters
    ----------
    simulation : ndarray of int (n,)
        Number of the simulation, from 1, that found a better design.
    value : ndarray (n,)
        Its value.
    stage : ndarray of int (n,)
        On which of several grids, from 0; the best value of the grid before does not count any more.
    """

    simulation: np.ndarray
    value: np.ndarray
    stage: np.ndarray


@dataclass(frozen=True)
class SearchResult:
    """What a search has found.

    Parameters
    ----------
    problem : str
        What was searched. Of several grids it is the one that was reached.
    algorithm : str
    settings : mapping
        All settings of the algorithm.
    seed : int
    best_design : ndarray of bool (rows, columns)
    value : float
        Its value.
    simulations : int
        Valid designs whose values the algorithm has used; one that it asks for again counts again.
    failed : int
        How many of them had no value.
    history : History
    stopped : str
        Why the search ended.
    objective : mapping
        ``units`` and ``long_name`` of the values.
    """

    problem: str
    algorithm: str
    settings: Mapping[str, Any]
    seed: int
    best_design: np.ndarray
    value: float
    simulations: int
    failed: int
    history: History
    stopped: str
    objective: Mapping[str, str]

    def to_dataset(self) -> xr.Dataset:
        """Everything as a labelled dataset, over ``row``, ``column`` and ``improvement``."""

        def count(long_name: str) -> dict[str, str]:
            return {"units": "1", "long_name": long_name}

        return xr.Dataset(
            {
                "best_design": (
                    ("row", "column"),
                    self.best_design,
                    count("cells of the best design that are on; row 0 is the top"),
                ),
                "value": ((), self.value, dict(self.objective)),
                "simulations": ((), self.simulations, count("number of simulations")),
                "failed": ((), self.failed, count("number of simulations without a value")),
                "history_simulation": (
                    "improvement",
                    self.history.simulation,
                    count("number of the simulation that found a better design"),
                ),
                "history_value": ("improvement", self.history.value, dict(self.objective)),
                "history_stage": ("improvement", self.history.stage, count("number of the grid")),
            },
            attrs={
                "version": __version__,
                "problem": self.problem,
                "algorithm": self.algorithm,
                "settings": json.dumps(self.settings),
                "seed": self.seed,
                "stopped": self.stopped,
            },
        )


def search(
    problem: Problem,
    algorithm: str = "tbfsl",
    *,
    seed: int = 0,
    start: ArrayLike | None = None,
    workers: int = 1,
    client: Client | None = None,
    journal: str | Path | None = None,
    resume: bool = False,
    progress: Found | None = None,
    improved: Improved | None = None,
    max_simulations: int | None = None,
    **settings: Any,
) -> SearchResult:
    """Look for the design with the least value.

    The same seed finds the same result, to the bit, however many workers there are: designs have an order, and an
    answer ends with the first one in it that is good enough, even if a later one has come back before.

    Parameters
    ----------
    problem : Problem
        Cheap (`slmm.optimization.problem.ManyAtOnce`) or expensive (`slmm.optimization.problem.OneByOne`). Designs of
        an expensive one go out as soon as a worker is free, and those whose evaluation fails are recorded as failed.
    algorithm : str
        ``tbfsl`` (settings ``depth``, ``radius``), ``bfsl`` (``depth``), ``fs``, ``ga`` (``population``,
        ``recombinations``, ``mutation``, ``patience``), ``sa`` (``temperature``, ``cooling``, ``iterations``), ``rs``
        (``limit``), ``bf``, or ``mg`` (``stages``), see Paper C; ``tabu`` (``steps``, ``tenure``, ``focus``,
        ``focused_tenure``, ``patience``); or ``ils``, several descents (``starts``, ``depth``, ``radius``, ``kick``).
    seed : int
        Of all random numbers.
    start : array_like of bool (rows, columns), optional
        A valid design to start from; a random one otherwise. ``ga`` takes a whole population (n, rows, columns), too,
        and ``mg`` a design on any grid.
    workers : int
        Number of processes on this machine that evaluate designs; with 1 it is this one. Scripts that ask for more
        need ``if __name__ == "__main__":``. ``sa`` is a chain, in which they have nothing to do at the same time, and
        where the problem has a quick model of neighbours, that is evaluated in this process.
    client : distributed.Client, optional
        Its workers evaluate designs. Needs the extra ``dask``.
    journal : str or Path, optional
        An SQLite file for all values, see `slmm.optimization.journal`.
    resume : bool
        Continue the journal of the same search if there is one: the result is that of an undisturbed run.
    progress : callable, optional
        Is told the number of simulations and the best value, again and again.
    improved : callable, optional
        Is told the best design and its value whenever there is a better one.
    max_simulations : int, optional
        Stop after so many simulations.
    **settings
        Of the algorithm.

    Raises
    ------
    ValueError
        For an unknown algorithm or setting, one out of range, a problem that lacks what the algorithm needs, a start
        that is no valid design, or a journal that cannot be continued.
    RuntimeError
        When no design that was simulated has a value; with the reason of one of them, if evaluations told any.

    Examples
    --------
    >>> from slmm.optimization import Cantilever
    >>> result = search(Cantilever(4, 3), "tbfsl", depth=4, radius=2, seed=1)
    >>> round(result.value, 5), result.stopped
    (0.00717, 'no better neighbour')
    >>> result.best_design.astype(int)
    array([[1, 1, 1, 1],
           [1, 1, 1, 0],
           [1, 1, 0, 0]])
    """
    check_whole("seed", seed, 0, 2**63 - 1)
    check_whole("workers", workers, 1)
    if max_simulations is not None:
        check_whole("max_simulations", max_simulations, 1)
    if client is not None and workers != 1:
        raise ValueError(f"workers = {workers}: the client has its own")
    if resume and journal is None:
        raise ValueError("resume: needs a journal")
    if journal is not None and type(problem).__repr__ is object.__repr__:
        raise ValueError(f"journal: {problem!r} needs a __repr__ of its own, which tells it from others")
    settings = check_settings(algorithm, settings)
    check_has(problem, *NEEDED)
    try:
        asking = ALGORITHMS[algorithm](problem, start, np.random.default_rng(seed), **settings)
        # what is wrong with settings or start comes out before anything is opened
        first = next(asking)
    except ValueError as error:
        raise ValueError(f"{algorithm}: {error}") from error
    run = {
        "problem": repr(problem),
        "algorithm": algorithm,
        "settings": settings,
        "seed": seed,
        "start": None if start is None else np.asarray(start, dtype=int).tolist(),
        "version": __version__,
    }
    record = _Record(progress, improved, np.inf if max_simulations is None else max_simulations)
    with (
        nullcontext() if journal is None else open_journal(journal, run, resume) as opened,
        evaluating(workers, client) as crew,
    ):
        memory = Memory() if opened is None else opened.memory()
        evaluation = Evaluation(crew, memory)
        stopped = _run(asking, first, evaluation, record)
        evaluation.finish()
    if record.best_design is None:
        reason = next((f", one of them as {said}" for _, said in memory.failures.values()), "")
        raise RuntimeError(f"{algorithm}: none of {record.simulations} simulated designs has a value{reason}")
    return SearchResult(
        repr(record.problem),
        algorithm,
        settings,
        seed,
        record.best_design,
        record.value,
        record.simulations,
        record.failed,
        record.history(),
        stopped,
        problem.objective,
    )


def check_settings(algorithm: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """All settings of an algorithm: the given ones, and its own for the others.

    Raises
    ------
    ValueError
        When there is no such algorithm, or it has no setting of a name, or needs one that is not given.
    """
    try:
        return completed(chosen(ALGORITHMS, algorithm), settings)
    except ValueError as error:
        raise ValueError(f"{algorithm}: {error}") from error


def _run(asking: Asking, ask: Ask, evaluation: Evaluation, record: _Record) -> str:
    """Answer an algorithm until it stops, and why it does."""
    while True:
        record.on(ask.problem)
        values = [np.empty(0)]
        for part in evaluation.answer(ask, record.left):
            record.add(part)
            values.append(part.values)
        if not record.left:
            return "simulations used up"
        try:
            ask = asking.send(np.concatenate(values))
        except StopIteration as end:
            return end.value


class _Record:
    """Counts simulations, and keeps the best design on the present grid."""

    def __init__(self, progress: Found | None, improved: Improved | None, most: float) -> None:
        self.progress, self.improved = progress, improved
        self.most = most
        self.simulations = self.failed = 0
        self.problem: Problem | None = None
        self.stage = -1
        self.steps: list[tuple[int, float, int]] = []
        self.best_design: np.ndarray | None = None
        self.value = np.inf

    @property
    def left(self) -> float:
        """How many more simulations there may be."""
        return self.most - self.simulations

    def on(self, problem: Problem) -> None:
        """Begin anew when it is another problem."""
        if problem is not self.problem:
            self.problem, self.stage = problem, self.stage + 1
            self.best_design, self.value = None, np.inf

    def add(self, part: Part) -> None:
        """Take in a part of an answer."""
        number, before = self.simulations + np.cumsum(part.valid), self.value
        for i in improvements(part.values, self.value):
            self.value, self.best_design = float(part.values[i]), part.designs[i]
            self.steps.append((int(number[i]), self.value, self.stage))
        self.simulations += int(part.valid.sum())
        self.failed += int(np.isnan(part.values[part.valid]).sum())
        if self.progress is not None:
            self.progress(self.simulations, self.value)
        if self.improved is not None and self.best_design is not None and self.value < before:
            self.improved(self.best_design, self.value)

    def history(self) -> History:
        """All improvements."""
        simulation, value, stage = zip(*self.steps, strict=True)
        return History(np.array(simulation), np.array(value), np.array(stage))
