"""Breadth-first search with limited depth (BFSL), and truncated to a radius (TBFSL): Paper C, 2.3.1 and 2.3.2.

All designs that differ from the best one in one cell are tried in random order, then those that differ in two cells,
and so on up to the depth. As soon as one is better, it is the best one, and all begins again with one cell.
"""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np
from numpy.typing import ArrayLike

from slmm.optimization.ask import Ask, Asking, Flipped
from slmm.optimization.checks import check_whole
from slmm.optimization.problem import Problem, start_design

#: so many combinations of flips are held at once; a radius makes less
MOST = 20_000_000


def tbfsl(
    problem: Problem, start: ArrayLike | None, rng: np.random.Generator, *, depth: int = 4, radius: int = 2
) -> Asking:
    """Truncated breadth-first search with limited depth (A.7).

    Parameters
    ----------
    depth : int
        Number of cells flipped at the most.
    radius : int
        The box around flipped cells has at most so many more columns and rows, added up, than that of a single cell.
    """
    check_whole("radius", radius, 0)
    return (yield from _breadth_first(problem, start, rng, depth, radius))


def bfsl(problem: Problem, start: ArrayLike | None, rng: np.random.Generator, *, depth: int = 1) -> Asking:
    """Breadth-first search with limited depth (A.6): the flipped cells may lie anywhere.

    Parameters
    ----------
    depth : int
        Number of cells flipped at the most.
    """
    return (yield from _breadth_first(problem, start, rng, depth, sum(problem.shape)))


def _breadth_first(
    problem: Problem, start: ArrayLike | None, rng: np.random.Generator, depth: int, radius: int
) -> Asking:
    check_whole("depth", depth, 1)
    free = ~problem.fixed
    levels = min(depth, int(free.sum()))
    neighbourhood = [flips_within(free, level + 1, radius) for level in range(levels)]

    def shuffled(design: np.ndarray, level: int) -> np.ndarray:
        return rng.permutation(neighbourhood[level])

    return (yield from descent(problem, start_design(problem, start, rng), shuffled, levels))


def descent(
    problem: Problem,
    best: np.ndarray,
    neighbourhood: Callable[[np.ndarray, int], np.ndarray],
    levels: int = 1,
) -> Asking:
    """Take the first better neighbour, as long as there is one.

    Parameters
    ----------
    best : ndarray of bool (rows, columns)
        Where to start.
    neighbourhood : callable
        Flips (n, k) of a design's neighbours, in the order in which they are tried, from a design and a level.
    levels : int
        A level is tried when none before has a better neighbour.
    """
    yield from descended(problem, best, neighbourhood, levels)
    return "no better neighbour"


def descended(
    problem: Problem,
    best: np.ndarray,
    neighbourhood: Callable[[np.ndarray, int], np.ndarray],
    levels: int = 1,
) -> Generator[Ask, np.ndarray, tuple[np.ndarray, float]]:
    """Where a `descent` ends, and its value; infinity where that has none."""
    (value,) = yield Ask(problem, best[None])
    # any value is better than none
    value = np.inf if np.isnan(value) else value
    level = 0
    while level < levels:
        neighbours = Flipped(best, neighbourhood(best, level))
        values = yield Ask(problem, neighbours, below=value, needed=value)
        if len(values) and values[-1] < value:
            best, value, level = neighbours[len(values) - 1 : len(values)][0], values[-1], 0
        else:
            level += 1
    return best, float(value)


def flips_within(free: np.ndarray, flipped: int, radius: int) -> np.ndarray:
    """All sets of so many free cells in a box with (width - 1) + (height - 1) <= radius.

    Parameters
    ----------
    free : ndarray of bool (rows, columns)
    flipped : int
        Number of cells in a set.
    radius : int

    Returns
    -------
    ndarray of int (n, flipped)
        Cells, ``row * columns + column``, in ascending order.

    Raises
    ------
    ValueError
        When there are more than twenty million.

    Examples
    --------
    >>> flips_within(np.ones((2, 2), dtype=bool), 2, radius=1).tolist()
    [[0, 1], [0, 2], [1, 3], [2, 3]]
    """
    row, column = np.nonzero(free)
    # a set is a prefix and one of the cells behind it, down to the last row that its first cell allows
    end = np.searchsorted(row, row + radius, side="right")
    sets = np.arange(len(row))[:, None]
    for _ in range(1, flipped):
        choices = end[sets[:, 0]] - sets[:, -1] - 1
        if (total := int(choices.sum())) > MOST:
            raise ValueError(
                f"depth = {flipped}: {total:,} combinations of {len(row)} cells; no more than {MOST:,} are tried, "
                "so a smaller depth or radius (of tbfsl) is needed"
            )
        before = np.repeat(np.cumsum(choices) - choices, choices)
        prefixes = np.repeat(sets, choices, axis=0)
        sets = np.column_stack([prefixes, prefixes[:, -1] + 1 + np.arange(total) - before])
        sets = sets[np.ptp(row[sets], axis=1) + np.ptp(column[sets], axis=1) <= radius]
    return np.ravel_multi_index((row, column), free.shape)[sets]
