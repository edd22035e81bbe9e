"""Values of the designs an algorithm asks for: computed in this process, in others, or on a Dask cluster.

A value that is known is not computed again. Where a problem has a quick model of a design's neighbours, that finds the
candidates among them, which is not remembered, and a direct evaluation confirms these.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache, partial
from itertools import islice
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np
import threadpoolctl

from slmm.optimization.ask import Ask, Flipped
from slmm.optimization.problem import Neighbours, Problem, WithNeighbours

if TYPE_CHECKING:
    from distributed import Client

#: designs that are looked at first when one is enough, for each worker: a better one often comes early
FIRST = 4
#: and so many of them when a quick model says how good they are
FIRST_OF_MODEL = 64
#: then this share of those looked at already, so that little is done in vain
GROWTH = 0.25
#: and not more than this
MOST = 1 << 16
#: values are recorded after each piece of work, which takes about so long, s
PIECE = 0.05
#: pieces of work for each worker, at least: some evaluations take longer than others
PIECES = 2

#: values of designs (n, rows, columns), in order, piece by piece
Evaluate = Callable[[Problem, np.ndarray], Iterator[np.ndarray]]
Record = Callable[[dict[bytes, float]], None]


class Part(NamedTuple):
    """The next part of an answer (m,), the designs (m, rows, columns), and whether they are valid (m,)."""

    values: np.ndarray
    designs: np.ndarray
    valid: np.ndarray


@dataclass
class Evaluation:
    """Answers what algorithms ask, and remembers the value of every design.

    Parameters
    ----------
    evaluate : callable
        Values of valid designs (n, rows, columns) of a problem, in order, piece by piece.
    workers : int
        How many designs are evaluated at the same time.
    known : dict of bytes to float
        Values by `keys`: those known before, and all that are found.
    record : callable, optional
        Is told each new value by its key.
    early : bool
        Whether the last design below a limit was among the first of those asked for: then the next ones are not worth a
        quick model.
    """

    evaluate: Evaluate
    workers: int = 1
    known: dict[bytes, float] = field(default_factory=dict)
    record: Record | None = None
    early: bool = True

    def answer(self, ask: Ask, most: float = np.inf) -> Iterator[Part]:
        """The answer part by part; it ends where so many of the designs were valid."""
        done, model = 0, None if self.early else model_around(ask)
        while done < len(ask.designs) and most > 0:
            if done and model is None:
                model = model_around(ask)
            designs = ask.designs[done : done + self.size(ask, done, model is not None)]
            valid = ask.problem.valid(designs)
            end = int(np.searchsorted(np.cumsum(valid), most)) + 1
            designs, valid = designs[:end], valid[:end]
            values = np.full(len(designs), np.nan)
            if model is not None and isinstance(ask.designs, Flipped):
                values[valid] = self.confirmed(
                    ask, designs[valid], model, ask.designs.flips[done : done + len(designs)][valid]
                )
            else:
                values[valid] = self.values(ask.problem, designs[valid])
            if (below := values < ask.below).any():
                end = int(below.argmax()) + 1
                self.early = done + end <= FIRST * self.workers
                yield Part(values[:end], designs[:end], valid[:end])
                return
            yield Part(values, designs, valid)
            done += len(designs)
            most -= valid.sum()
        if ask.below > -np.inf:
            self.early = False

    def size(self, ask: Ask, done: int, by_model: bool) -> int:
        """How many designs to look at next when so many are done."""
        if ask.below == -np.inf:
            return len(ask.designs)
        return max(FIRST_OF_MODEL if by_model else FIRST * self.workers, min(int(GROWTH * done), MOST))

    def values(self, problem: Problem, designs: np.ndarray) -> np.ndarray:
        """Values (n,) of valid designs."""
        names = keys(designs)
        new = [i for i, name in enumerate(names) if name not in self.known]
        if new:
            waiting = iter([names[i] for i in new])
            for values in self.evaluate(problem, designs[new]):
                found = dict(zip(islice(waiting, len(values)), values.tolist(), strict=True))
                self.known.update(found)
                if self.record is not None:
                    self.record(found)
        return np.array([self.known[name] for name in names])

    def confirmed(self, ask: Ask, designs: np.ndarray, model: Neighbours, flips: np.ndarray) -> np.ndarray:
        """Values of the candidates among valid designs, up to the first below the limit; infinity for the others."""
        values = np.full(len(designs), np.inf)
        # a design without an approximate value is a candidate, too
        approximate, errors = model.evaluate(flips)
        candidates = np.flatnonzero(~(approximate - errors > ask.below))
        done, number = 0, self.workers
        while done < len(candidates) and not (values < ask.below).any():
            these = candidates[done : done + number]
            values[these] = self.values(ask.problem, designs[these])
            # most candidates are what the model says; without a model more and more are needed
            done, number = done + number, 2 * number
        return values


def model_around(ask: Ask) -> Neighbours | None:
    """The quick model of the designs asked for, if there is one."""
    if isinstance(ask.designs, Flipped) and isinstance(ask.problem, WithNeighbours):
        return ask.problem.neighbours(ask.designs.centre)
    return None


def keys(designs: np.ndarray) -> list[bytes]:
    """A name for each design (n, rows, columns): its shape and its bits.

    Examples
    --------
    >>> keys(np.ones((1, 2, 4), dtype=bool))
    [b'2x4:\\xff']
    """
    n, rows, columns = designs.shape
    shape = f"{rows}x{columns}:".encode()
    return [shape + bits.tobytes() for bits in np.packbits(designs.reshape(n, rows * columns), axis=1)]


@contextmanager
def evaluating(workers: int = 1, client: Client | None = None) -> Iterator[tuple[Evaluate, int]]:
    """How values are computed, and how many at the same time: by a Dask client's workers, by processes, or here."""
    if client is not None:
        from distributed.protocol.pickle import dumps  # of problems that are defined in a script, too

        at_once = sum(client.nthreads().values())
        yield partial(_elsewhere, client.get_executor(pure=False), at_once, dumps, Pace()), at_once
    elif workers > 1:
        with processes(workers) as pool:
            yield partial(_elsewhere, pool, workers, pickle.dumps, Pace()), workers
    else:
        yield partial(_here, Pace()), 1


@contextmanager
def processes(number: int) -> Iterator[ProcessPoolExecutor]:
    """Processes of one thread each. They end at once when this one is killed or leaves with an exception."""
    # forked processes would share locks of threads that they do not have
    spawning = multiprocessing.get_context("spawn")
    theirs, ours = spawning.Pipe(duplex=False)
    pool = ProcessPoolExecutor(number, spawning, initializer=settle, initargs=(theirs,))
    try:
        yield pool
    except BaseException:
        ours.close()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        ours.close()


@dataclass
class Pace:
    """How many designs are evaluated in about `PIECE` seconds."""

    designs: float = 1.0

    def learn(self, designs: int, seconds: float) -> None:
        """From a piece of work; a slow one, in which a kernel was compiled, is made up for soon."""
        self.designs = max(1.0, min(4 * self.designs, PIECE * designs / max(seconds, 1e-9)))


def _here(pace: Pace, problem: Problem, designs: np.ndarray) -> Iterator[np.ndarray]:
    done = 0
    while done < len(designs):
        piece = designs[done : done + int(pace.designs)]
        values, seconds = _timed(problem, piece)
        pace.learn(len(piece), seconds)
        yield values
        done += len(piece)


def _elsewhere(
    executor: Executor,
    workers: int,
    dumps: Callable[[Problem], bytes],
    pace: Pace,
    problem: Problem,
    designs: np.ndarray,
) -> Iterator[np.ndarray]:
    size = max(1, min(int(pace.designs), len(designs) // (PIECES * workers)))
    pieces = [designs[first : first + size] for first in range(0, len(designs), size)]
    for values, seconds in executor.map(partial(_evaluated, dumps(problem)), pieces):
        pace.learn(len(values), seconds)
        yield values


def _evaluated(pickled: bytes, designs: np.ndarray) -> tuple[np.ndarray, float]:
    return _timed(_unpickled(pickled), designs)


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


@lru_cache(maxsize=1)
def _unpickled(problem: bytes) -> Problem:
    """Once for all pieces: a problem may have found something that it needs for all designs."""
    return pickle.loads(problem)


def settle(parent: Connection) -> None:
    """Make a process one of many: one thread, an end when its parent's end of a pipe is closed, and none before."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    numba.set_num_threads(1)
    threadpoolctl.threadpool_limits(1)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: Connection) -> None:
    # nothing is ever sent: it is closed, or its process is gone
    parent.poll(None)
    os._exit(1)
