"""Several descents that share their values: from random designs, or from the best one kicked out of its optimum.

The latter is iterated local search, after H. R. Lourenço, O. C. Martin and T. Stützle, Iterated local search, in:
Handbook of Metaheuristics (Kluwer, 2003) 320-353. Each descent is that of TBFSL. A design that one descent has asked
for is not simulated for another, so that descents into an optimum that is known cost little.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from slmm.optimization.algorithms.breadth_first import descended, flips_within
from slmm.optimization.ask import Asking
from slmm.optimization.checks import check_whole
from slmm.optimization.problem import DRAWS, Problem, random_design, start_design


def ils(
    problem: Problem,
    start: ArrayLike | None,
    rng: np.random.Generator,
    *,
    starts: int = 10,
    depth: int = 1,
    radius: int = 3,
    kick: int = 3,
) -> Asking:
    """Iterated local search by truncated breadth-first descents.

    Parameters
    ----------
    starts : int
        Number of descents.
    depth : int
        Number of cells flipped at the most, in a descent.
    radius : int
        As that of TBFSL.
    kick : int
        So many random cells of the best design are flipped before the next descent; with 0 that begins with a random
        design.
    """
    check_whole("starts", starts, 1)
    check_whole("depth", depth, 1)
    check_whole("radius", radius, 0)
    check_whole("kick", kick, 0)
    free = ~problem.fixed
    cells = np.flatnonzero(free)
    levels = min(depth, len(cells))
    neighbourhood = [flips_within(free, level + 1, radius) for level in range(levels)]

    def shuffled(design: np.ndarray, level: int) -> np.ndarray:
        return rng.permutation(neighbourhood[level])

    design = start_design(problem, start, rng)
    best, value = yield from descended(problem, design, shuffled, levels)
    for _ in range(starts - 1):
        design = kicked(problem, best, cells, kick, rng) if kick else random_design(problem, rng)
        other, its = yield from descended(problem, design, shuffled, levels)
        if its < value:
            best, value = other, its
    return "all starts done"


def kicked(
    problem: Problem, design: np.ndarray, cells: np.ndarray, kick: int, rng: np.random.Generator
) -> np.ndarray:
    """A valid design in which so many random cells (n,) of another are flipped, or all; a random one without any.

    Examples
    --------
    >>> from slmm.optimization import Cantilever
    >>> beam, rng = Cantilever(4, 3), np.random.default_rng(0)
    >>> design = np.ones((3, 4), dtype=bool)
    >>> int((kicked(beam, design, np.flatnonzero(~beam.fixed), 2, rng) != design).sum())
    2
    """
    for _ in range(DRAWS):
        other = design.copy()
        other.flat[rng.choice(cells, min(kick, len(cells)), replace=False)] ^= True
        if problem.valid(other[None])[0]:
            return other
    return random_design(problem, rng)
