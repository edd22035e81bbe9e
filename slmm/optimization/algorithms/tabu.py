"""Tabu search on cells that are on or off: it leaves local optima, and does not come back to them soon.

After F. Glover, Tabu search, parts I and II, ORSA Journal on Computing 1 (1989) 190-206 and 2 (1990) 4-32. In each step
one cell flips, for better or worse, and is barred for a while. Three things are as they are because simulations cost
most: the first better neighbour is taken, not the best one; barred cells are not tried at all, not even to see whether
they would lead to the best design so far; and most cells are barred, so that few are left to try. After a new best
design cells are barred for a few steps only, so that the search stays around it for a while.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import ArrayLike

from slmm.optimization.ask import Ask, Asking, Flipped
from slmm.optimization.checks import check_between, check_whole
from slmm.optimization.problem import Problem, random_design, start_design


def tabu(
    problem: Problem,
    start: ArrayLike | None,
    rng: np.random.Generator,
    *,
    steps: int = 5000,
    tenure: float = 0.6,
    focus: int = 60,
    focused_tenure: int = 3,
    patience: int = 20,
) -> Asking:
    """Flip the first cell that makes the design better, or else the one that makes it least worse; then bar that cell.

    No design is simulated twice. The defaults were chosen on four grids of the cantilever: on 8 x 5 and 7 x 5 cells a
    tenure from 0.55 to 0.65 is best, on 5 x 7 one from 0.5 to 0.6, on 6 x 6 one of 0.55 or less. With any focus from 15
    to 240 steps the best of all designs of 8 x 5 is found in six of ten runs, without it in less than one.

    Parameters
    ----------
    steps : int
        It stops after so many. On 8 x 5 cells a step takes five to six simulations.
    tenure : float
        For so many steps a cell is barred once it has flipped: a share of the number of free cells.
    focus : int
        For so many steps after a new best design the focused tenure is in force.
    focused_tenure : int
        For so many steps a cell is barred then.
    patience : int
        It goes on from a random design after so many steps that have come upon none but known designs.
    """
    check_whole("steps", steps, 1)
    check_between("tenure", tenure, 0, 1)
    check_whole("focus", focus, 0)
    check_whole("focused_tenure", focused_tenure, 0)
    check_whole("patience", patience, 1)
    if not hasattr(problem, "repaired"):
        random_design(problem, np.random.default_rng(0))  # that there is none is told now, not after hours
    free = np.flatnonzero(~problem.fixed)
    usual_tenure = round(tenure * len(free))
    known: dict[bytes, float] = {}
    design = start_design(problem, start, rng)
    value = yield from value_of(problem, design, known)
    best, found, new = value, 0, 0
    flipped = np.full(len(free), -np.inf)
    for step in range(1, steps + 1):
        if step - new > patience:
            design, new = random_design(problem, rng), step
            value = yield from value_of(problem, design, known)
        simulated = len(known)
        barred = focused_tenure if step - found <= focus else usual_tenure
        choice = rng.permutation(np.flatnonzero(step - flipped > barred))
        taken = yield from first_better_or_least_worse(problem, design, value, free[choice], known)
        if len(known) > simulated:
            new = step
        if taken is None:
            continue
        place, value = taken
        design = design.copy()
        design.flat[free[choice[place]]] ^= True
        flipped[choice[place]] = step
        if value < best:
            best, found = value, step
    return "all steps done"


def value_of(
    problem: Problem, design: np.ndarray, known: dict[bytes, float]
) -> Generator[Ask, np.ndarray, float]:
    """Value of a design (rows, columns); infinity, which any other is better than, where it has none."""
    name = design.tobytes()
    if name not in known:
        (known[name],) = yield Ask(problem, design[None])
    return np.inf if np.isnan(known[name]) else float(known[name])


def first_better_or_least_worse(
    problem: Problem, design: np.ndarray, value: float, cells: np.ndarray, known: dict[bytes, float]
) -> Generator[Ask, np.ndarray, tuple[int, float] | None]:
    """Which of the cells (n,) to flip, tried in this order, and the value then; None where no neighbour has a value.

    Parameters
    ----------
    value : float
        Of the design.
    known : dict of bytes to float
        Values of designs by their bytes; those that are asked for are added.
    """
    neighbours = Flipped(design, cells[:, None])[:]
    names = [neighbour.tobytes() for neighbour in neighbours]
    values = np.array([known.get(name, np.nan) for name in names])
    better = np.flatnonzero(values < value)
    end = better[0] + 1 if len(better) else len(names)
    new = [i for i in range(end) if names[i] not in known]
    if new:
        answer = yield Ask(problem, neighbours[new], below=value)
        for i, other in zip(new, answer, strict=False):
            known[names[i]] = values[i] = other
        if answer[-1] < value:
            end = new[len(answer) - 1] + 1
    if np.isnan(values[:end]).all():
        return None
    place = int(np.nanargmin(values[:end]))
    return place, float(values[place])
