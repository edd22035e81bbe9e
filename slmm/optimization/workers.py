"""Who evaluates designs: this process, others on this machine, or the workers of a Dask cluster."""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Protocol

import numpy as np

from slmm.optimization.problem import Bound, Problem, Value
from slmm.running.processes import processes

if TYPE_CHECKING:
    from distributed import Client

#: values are recorded after each piece of work, which takes about so long, s (chosen)
PIECE = 0.05
#: pieces of work for each worker, at least: some evaluations take longer than others (chosen)
PIECES = 2


@dataclass(frozen=True)
class Failure:
    """That a design has no value.

    Parameters
    ----------
    reason : str
    """

    reason: str


class Workers(Protocol):
    """Who evaluates designs.

    Parameters
    ----------
    number : int
        How many designs are evaluated at the same time.
    """

    number: int

    def many(self, problem: Problem, designs: np.ndarray) -> Iterator[np.ndarray]:
        """Values of valid designs (n, rows, columns) of a problem of many at once, in order, piece by piece."""
        ...

    def one(self, problem: Problem, design: np.ndarray, below: float) -> Future[Value | Bound | Failure]:
        """What becomes of a valid design (rows, columns) of a problem of one by one."""
        ...


@contextmanager
def evaluating(workers: int = 1, client: Client | None = None) -> Iterator[Workers]:
    """So many workers: those of a Dask client, processes, or this one alone."""
    if client is not None:
        from distributed.protocol.pickle import dumps  # of problems that are defined in a script, too

        yield Elsewhere(client.get_executor(pure=False), sum(client.nthreads().values()), dumps)
    elif workers > 1:
        with processes(workers) as pool:
            yield Elsewhere(pool, workers, pickle.dumps)
    else:
        yield Here()


@dataclass
class Pace:
    """How many designs are evaluated in about `PIECE` seconds."""

    designs: float = 1.0

    def learn(self, designs: int, seconds: float) -> None:
        """From a piece of work; a slow one, in which a kernel was compiled, is made up for soon."""
        self.designs = max(1.0, min(4 * self.designs, PIECE * designs / max(seconds, 1e-9)))


@dataclass
class Here:
    """This process: what it is asked is done before it answers."""

    number: int = 1
    pace: Pace = field(default_factory=Pace)

    def many(self, problem: Problem, designs: np.ndarray) -> Iterator[np.ndarray]:
        """See `Workers`."""
        done = 0
        while done < len(designs):
            piece = designs[done : done + int(self.pace.designs)]
            values, seconds = _timed(problem, piece)
            self.pace.learn(len(piece), seconds)
            yield values
            done += len(piece)

    def one(self, problem: Problem, design: np.ndarray, below: float) -> Future[Value | Bound | Failure]:
        """See `Workers`."""
        done: Future[Value | Bound | Failure] = Future()
        done.set_result(_outcome(problem, design, below))
        return done


@dataclass
class Elsewhere:
    """Other processes."""

    executor: Executor
    number: int
    dumps: Callable[[Problem], bytes]
    pace: Pace = field(default_factory=Pace)
    #: the last problem, and what it was sent as: a problem that has found something meanwhile is the same one there
    sent: tuple[Problem, bytes] | None = None

    def many(self, problem: Problem, designs: np.ndarray) -> Iterator[np.ndarray]:
        """See `Workers`."""
        size = max(1, min(int(self.pace.designs), len(designs) // (PIECES * self.number)))
        pieces = [designs[first : first + size] for first in range(0, len(designs), size)]
        pickled = self.pickled(problem)
        for values, seconds in self.executor.map(_timed_there, [pickled] * len(pieces), pieces):
            self.pace.learn(len(values), seconds)
            yield values

    def one(self, problem: Problem, design: np.ndarray, below: float) -> Future[Value | Bound | Failure]:
        """See `Workers`."""
        return self.executor.submit(_outcome_there, self.pickled(problem), design, below)

    def pickled(self, problem: Problem) -> bytes:
        """A problem as it is sent."""
        if self.sent is None or self.sent[0] is not problem:
            self.sent = problem, self.dumps(problem)
        return self.sent[1]


def _timed_there(pickled: bytes, designs: np.ndarray) -> tuple[np.ndarray, float]:
    return _timed(_unpickled(pickled), designs)


def _outcome_there(pickled: bytes, design: np.ndarray, below: float) -> Value | Bound | Failure:
    return _outcome(_unpickled(pickled), design, below)


@lru_cache(maxsize=1)
def _unpickled(problem: bytes) -> Problem:
    """Once for all designs: a problem may have found something that it needs for all of them."""
    return pickle.loads(problem)


def _timed(problem: Problem, designs: np.ndarray) -> tuple[np.ndarray, float]:
    """Values (n,), and how many seconds they took."""
    begin = time.perf_counter()
    values = np.asarray(problem.evaluate(designs))
    seconds = time.perf_counter() - begin
    if values.shape != (len(designs),) or values.dtype.kind not in "fiu":
        raise ValueError(
            f"{problem!r}: evaluate must return {len(designs)} real numbers for as many designs, "
            f"and returned {values.dtype} of shape {values.shape}"
        )
    return np.where(np.isfinite(values), values, np.nan), seconds


def _outcome(problem: Problem, design: np.ndarray, below: float) -> Value | Bound | Failure:
    """What becomes of a design."""
    try:
        found = problem.evaluate(design, below)
    except Exception as error:  # whatever it is, the next design may go well
        # a file that has no name in UTF-8 may be named in it
        return Failure(f"{type(error).__name__}: {error}".encode(errors="backslashreplace").decode())
    if isinstance(found, Value):
        return found if np.isfinite(found.value) else Failure(f"its value is {found.value}")
    if isinstance(found, Bound) and below <= found.least < np.inf:
        return found
    raise ValueError(
        f"{problem!r}: evaluate must return a Value, or a Bound that is not below {below}, and returned {found!r}"
    )
