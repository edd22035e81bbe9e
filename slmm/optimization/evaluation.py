"""Answers to what an algorithm asks, from memory or by workers.

A value that is known is not computed again. Where a problem has a quick model of a design's neighbours, that finds the
candidates among them, which is not remembered, and a direct evaluation confirms these.

Designs of a problem of one by one go out as soon as a worker is free. The answer is that of a single worker all the
same: it ends with the first design, in order, that is below the limit. Once there is one no design behind it goes out;
what is out already is remembered when it comes back, and meanwhile the next question is worked on.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple

import numpy as np

from slmm.optimization.ask import Ask, Flipped
from slmm.optimization.memory import Memory, keys
from slmm.optimization.problem import Bound, Neighbours, Problem, Value, WithNeighbours, one_by_one
from slmm.optimization.workers import Failure, Workers

#: designs that are looked at first when one is enough, for each worker: a better one often comes early (chosen)
FIRST = 4
#: and so many of them when a quick model says how good they are (chosen)
FIRST_OF_MODEL = 64
#: then this share of those looked at already, so that little is done in vain (chosen)
GROWTH = 0.25
#: and not more than this (chosen)
MOST = 1 << 16


class Part(NamedTuple):
    """The next part of an answer (m,), the designs (m, rows, columns), and whether they are valid (m,)."""

    values: np.ndarray
    designs: np.ndarray
    valid: np.ndarray


class Piece(NamedTuple):
    """Designs (m, rows, columns) to look at next, which are valid (m,), and which candidates (m,).

    Of the other valid ones a quick model, if there is one, says that they are not below the limit.
    """

    designs: np.ndarray
    valid: np.ndarray
    candidate: np.ndarray
    by_model: bool


@dataclass
class Place:
    """One of the designs (rows, columns) asked for: whether it is valid, its key, and its value if that is known."""

    design: np.ndarray
    valid: bool
    name: bytes
    value: float | None


@dataclass
class Evaluation:
    """Answers what algorithms ask, and remembers what is found.

    Parameters
    ----------
    workers : Workers
    memory : Memory
        What was known before, and all that is found.
    """

    workers: Workers
    memory: Memory = field(default_factory=Memory)
    #: whether the last design below a limit was among the first of those asked for: then the next ones are not worth a
    #: quick model
    early: bool = True
    #: of the last problem asked about, whether it is one of one by one
    kind: tuple[Problem | None, bool] = (None, False)
    #: evaluations that are not done, by keys, and their limits
    out: dict[bytes, tuple[Future[Value | Bound | Failure], float]] = field(default_factory=dict)

    def answer(self, ask: Ask, most: float = np.inf) -> Iterator[Part]:
        """The answer part by part; it ends where so many of the designs were valid."""
        if self.kind[0] is not ask.problem:
            self.kind = ask.problem, one_by_one(ask.problem)
        return self.as_they_come(ask, most) if self.kind[1] else self.many_at_once(ask, most)

    def many_at_once(self, ask: Ask, most: float) -> Iterator[Part]:
        """The answer by evaluations of many designs."""
        done = 0
        for designs, valid, candidate, by_model in self.pieces(ask, most, by_model=not self.early):
            values = np.full(len(designs), np.nan)
            if by_model:
                values[valid] = np.inf
            for these in self.in_turns(np.flatnonzero(candidate)) if by_model else [candidate]:
                values[these] = self.values(ask.problem, designs[these])
                if (below := values < ask.below).any():
                    end = int(below.argmax()) + 1
                    self.early = done + end <= FIRST * self.workers.number
                    yield Part(values[:end], designs[:end], valid[:end])
                    return
            yield Part(values, designs, valid)
            done += len(designs)
        if ask.below > -np.inf:
            self.early = False

    def in_turns(self, candidates: np.ndarray) -> Iterator[np.ndarray]:
        """Places (n,) of candidates, a few first: most are what the model says; without a model more are needed."""
        done, number = 0, self.workers.number
        while done < len(candidates):
            yield candidates[done : done + number]
            done, number = done + number, 2 * number

    def pieces(self, ask: Ask, most: float, by_model: bool) -> Iterator[Piece]:
        """All designs in order, up to so many valid ones; the first piece by the quick model only if that is wished."""
        done, model = 0, model_around(ask) if by_model else None
        while done < len(ask.designs) and most > 0:
            if done and model is None:
                model = model_around(ask)
            designs = ask.designs[done : done + self.size(ask, done, model is not None)]
            valid = ask.problem.valid(designs)
            if most < len(designs):
                end = int(np.searchsorted(np.cumsum(valid), most)) + 1
                designs, valid = designs[:end], valid[:end]
            candidate = valid
            if model is not None and isinstance(ask.designs, Flipped):
                candidate = valid.copy()
                # a design without an approximate value is a candidate, too
                approximate, errors = model.evaluate(ask.designs.flips[done : done + len(designs)][valid])
                candidate[valid] = ~(approximate - errors > ask.below)
            yield Piece(designs, valid, candidate, model is not None)
            done += len(designs)
            most -= valid.sum()

    def size(self, ask: Ask, done: int, by_model: bool) -> int:
        """How many designs to look at next when so many are done."""
        if ask.below == -np.inf:
            return len(ask.designs)
        return max(FIRST_OF_MODEL if by_model else FIRST * self.workers.number, min(int(GROWTH * done), MOST))

    def values(self, problem: Problem, designs: np.ndarray) -> np.ndarray:
        """Values (n,) of valid designs of a problem of many at once."""
        names, known = keys(problem, designs), self.memory.values
        new: dict[bytes, int] = {}
        for i, name in enumerate(names):
            if name not in known:
                new.setdefault(name, i)
        if new:
            waiting = iter(new)
            for values in self.workers.many(problem, designs[list(new.values())]):
                self.memory.add_values(dict(zip(islice(waiting, len(values)), values.tolist(), strict=True)))
        return np.array([known[name] for name in names])

    def as_they_come(self, ask: Ask, most: float) -> Iterator[Part]:
        """The answer by evaluations of one design each."""
        coming = self.places(ask, most)
        open_places: deque[Place] = deque()
        ended = False
        while True:
            while not ended and not (open_places and self.is_waiting(open_places[-1])):
                place = next(coming, None)
                if place is None:
                    ended = True
                else:
                    open_places.append(place)
                    ended = self.is_below(place, ask)
            known = []
            while open_places and open_places[0].value is not None:
                known.append(open_places.popleft())
            if known:
                yield part_of(known)
            if not open_places:
                return
            self.take_in()
            for i, place in enumerate(open_places):
                if self.is_below(place, ask):
                    ended = True
                    for _ in range(len(open_places) - i - 1):
                        open_places.pop()
                    break

    def places(self, ask: Ask, most: float) -> Iterator[Place]:
        """The designs in order, with what is known without an evaluation."""
        # with evaluations that take seconds a quick model is always worth it
        for designs, valid, candidate, _ in self.pieces(ask, most, by_model=True):
            names = iter(keys(ask.problem, designs[candidate]))
            for design, ok, open_ in zip(designs, valid, candidate, strict=True):
                known = np.inf if ok else np.nan
                yield Place(design, bool(ok), next(names) if open_ else b"", None if open_ else known)

    def is_below(self, place: Place, ask: Ask) -> bool:
        """Whether a design is known to be below the limit by now; if it is not known, it goes out to a free worker."""
        if place.value is None:
            place.value = self.memory.answer(place.name, ask.needed)
        if place.value is not None:
            return place.value < ask.below
        if place.name not in self.out and len(self.out) < self.workers.number:
            self.out[place.name] = self.workers.one(ask.problem, place.design, ask.needed), ask.needed
        return False

    def is_waiting(self, place: Place) -> bool:
        """Whether a design could not go out yet, as no worker was free."""
        return place.value is None and place.name not in self.out

    def take_in(self) -> None:
        """Wait until an evaluation is done, and remember what it has found."""
        done, _ = wait([future for future, _ in self.out.values()], return_when=FIRST_COMPLETED)
        for name, (future, below) in list(self.out.items()):
            if future in done:
                del self.out[name]
                self.memory.add(name, below, future.result())

    def finish(self) -> None:
        """Wait for what is out: it is remembered, too."""
        while self.out:
            self.take_in()


def part_of(places: list[Place]) -> Part:
    """What is known of places, as a part of an answer."""
    return Part(
        np.array([place.value for place in places], dtype=float),
        np.array([place.design for place in places]),
        np.array([place.valid for place in places]),
    )


def model_around(ask: Ask) -> Neighbours | None:
    """The quick model of the designs asked for, if there is one."""
    if isinstance(ask.designs, Flipped) and isinstance(ask.problem, WithNeighbours):
        return ask.problem.neighbours(ask.designs.centre)
    return None
