"""How an algorithm asks for the values of designs.

Algorithms are generators. They yield what they ask, are sent the values, and return why they stopped; who evaluates the
designs, where, and how many at once is none of their business, and they keep no record of the best.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from slmm.optimization.problem import Problem


@dataclass(frozen=True)
class Flipped:
    """Designs (n, rows, columns) that differ from one in a few cells, each made when a slice is taken.

    Parameters
    ----------
    centre : ndarray of bool (rows, columns)
    flips : ndarray of int (n, k)
        Different cells in which each of them differs: ``row * columns + column``.

    Examples
    --------
    >>> Flipped(np.zeros((2, 2), dtype=bool), np.array([[0], [3]]))[1:].astype(int).tolist()
    [[[0, 0], [0, 1]]]
    """

    centre: np.ndarray
    flips: np.ndarray

    def __len__(self) -> int:
        return len(self.flips)

    def __getitem__(self, which: slice) -> np.ndarray:
        flips = self.flips[which]
        designs = np.repeat(self.centre.reshape(1, -1), len(flips), axis=0)
        designs[np.arange(len(flips))[:, None], flips] ^= True
        return designs.reshape(-1, *self.centre.shape)


@dataclass(frozen=True)
class Ask:
    """The values of these designs, in order, up to and including the first below a limit.

    The answer is an array (m,) with m <= n: NaN where a design is not valid or its evaluation failed, and infinity
    where it is known only not to be below what is needed. If one is below the limit, it is the last.

    Parameters
    ----------
    problem : Problem
    designs : ndarray of bool (n, rows, columns) or Flipped
    below : float
        By default no value is below it, and the answer has all values.
    needed : float
        Values that are not below this need not be known, which saves an expensive problem work. Not less than the
        limit; by default all are needed.

    Raises
    ------
    ValueError
        When values below the limit would not be known.
    """

    problem: Problem
    designs: np.ndarray | Flipped
    below: float = -np.inf
    needed: float = np.inf

    def __post_init__(self) -> None:
        if self.needed < self.below:
            raise ValueError(f"needed = {self.needed}: must not be less than below = {self.below}")


#: what algorithms are
Asking = Generator[Ask, np.ndarray, str]


def improvements(values: np.ndarray, best: float) -> np.ndarray:
    """Places of the values (n,) that are below the best one and below all before them.

    Examples
    --------
    >>> improvements(np.array([3.0, np.nan, 1.0, 2.0, 0.5]), best=2.0).tolist()
    [2, 4]
    """
    before = np.fmin.accumulate(np.concatenate([[best], values]))[:-1]
    return np.flatnonzero(values < before)
