"""Multi-grid optimisation (MG): the best design of a coarse grid starts the search on a finer one (Paper C, 2.3.3)."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from slmm.optimization.algorithms.registry import ON_ONE_GRID, Algorithm, chosen, completed
from slmm.optimization.ask import Ask, Asking, improvements
from slmm.optimization.problem import Repairing, Resizing, check_has

#: columns, rows, algorithm, settings
Stage = tuple[int, int, str, Mapping[str, Any]]

#: Table 4
PUBLISHED: tuple[Stage, ...] = tuple(
    (columns, rows, "tbfsl", {"depth": 4, "radius": radius})
    for columns, rows, radius in (
        (10, 10, 6),
        (12, 12, 6),
        (14, 12, 5),
        (16, 12, 5),
        (18, 13, 4),
        (20, 14, 3),
        (22, 15, 3),
        (24, 16, 2),
        (48, 16, 2),
    )
)


def mg(
    problem: Resizing,
    start: ArrayLike | None,
    rng: np.random.Generator,
    *,
    stages: Sequence[Stage] = PUBLISHED,
) -> Asking:
    """One search after the other, each on its grid and from the best design before (A.8).

    Parameters
    ----------
    stages : sequence of (int, int, str, mapping)
        Columns, rows, algorithm and its settings; the last grid is the problem's.
    """
    check_has(problem, "repaired", "resized")
    if not isinstance(stages, Sequence):
        raise ValueError(f"stages = {stages!r}: must be a sequence")
    algorithms = [checked(problem, stage) for stage in stages]
    if not stages or (stages[-1][1], stages[-1][0]) != problem.shape:
        rows, columns = problem.shape
        raise ValueError(f"stages: the last one must have the problem's {columns} columns and {rows} rows")
    design = None if start is None else np.asarray(start)
    if design is not None and not (design.ndim == 2 and design.size and np.isin(design, (0, 1)).all()):
        raise ValueError(
            f"start: must be one design of cells that are 0 or 1, and has the shape {design.shape}"
        )
    for algorithm, (columns, rows, _, settings) in zip(algorithms, stages, strict=True):
        there = problem.resized(columns, rows)
        begin = None if design is None else transferred(design.astype(bool), there)
        design, stopped = yield from followed(algorithm(there, begin, rng, **settings))
    return f"last grid: {stopped}"


def checked(problem: Resizing, stage: Stage) -> Algorithm:
    """The algorithm of a stage, which takes its settings.

    Raises
    ------
    ValueError
        When the stage is none, there is no such algorithm, or it does not take these settings.
    """
    if not (isinstance(stage, Sequence) and len(stage) == 4 and isinstance(stage[3], Mapping)):
        raise ValueError(f"stages: {stage!r} must be columns, rows, an algorithm and its settings by name")
    columns, rows, name, settings = stage
    try:
        algorithm = chosen(ON_ONE_GRID, name)
        completed(algorithm, settings)
        # an algorithm looks at its settings before it asks
        next(algorithm(problem.resized(columns, rows), None, np.random.default_rng(0), **settings))
    except ValueError as error:
        raise ValueError(f"stage {columns} x {rows}: {name}: {error}") from None
    return algorithm


def followed(asking: Asking) -> Generator[Ask, np.ndarray, tuple[np.ndarray | None, str]]:
    """The best design that an algorithm has seen, None where it has seen no value, and why it stopped."""
    best, design = np.inf, None
    try:
        ask = next(asking)
        while True:
            values = yield ask
            better = improvements(values, best)
            if better.size:
                last = int(better[-1])
                best, design = values[last], ask.designs[last : last + 1][0]
            ask = asking.send(values)
    except StopIteration as end:
        return design, end.value


def transferred(design: np.ndarray, problem: Repairing) -> np.ndarray:
    """A valid design on a problem's grid like one on another grid (rows, columns)."""
    rows, columns = problem.shape
    result = np.where(problem.fixed, problem.start, scaled(design, columns, rows))
    return result if problem.valid(result[None])[0] else problem.repaired(result)


def scaled(design: np.ndarray, columns: int, rows: int) -> np.ndarray:
    """A design on another grid: every cell is as the nearest cell (Fig. 6).

    Where two are equally near, it is the one on the right or below.

    Examples
    --------
    >>> scaled(np.array([[1, 0, 0], [1, 1, 0]], dtype=bool), 4, 3).astype(int)
    array([[1, 0, 0, 0],
           [1, 1, 1, 0],
           [1, 1, 1, 0]])
    """
    return design[np.ix_(nearest(design.shape[0], rows), nearest(design.shape[1], columns))]


def nearest(old: int, new: int) -> np.ndarray:
    """Which of the old cells of a line is nearest to each of the new ones (new,)."""
    return (2 * np.arange(new) + 1) * old // (2 * new)
