"""The toughest design that does not fork: a small shift of all holes hardly changes its U_T.

Designs are asked in the order of their values. The search ends where no later one can be tougher with its holes shifted
the worse way than the best so far, and one that does not fork has been found.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from slmm.optimization.hole_patterns.margins import STEADY, shifted, spread_of
from slmm.optimization.hole_patterns.objectives import OVER
from slmm.optimization.hole_patterns.patterns import Design

if TYPE_CHECKING:
    from slmm.optimization.hole_patterns.problem import HolePattern


class Shifted(NamedTuple):
    """A design whose holes were shifted.

    Attributes
    ----------
    whole : ndarray of bool (grid, grid)
    value : float
        What counts of its directions, mJ.
    worst : float
        The same with its holes shifted the worse way or not at all, mJ.
    spread : float
        By how much the value changes, relative.
    """

    whole: Design
    value: float
    worst: float
    spread: float

    @property
    def is_steady(self) -> bool:
        """Whether it does not fork."""
        return self.spread <= STEADY


def shifted_design(problem: HolePattern, whole: Design) -> Shifted:
    """A design with its holes shifted, three simulations for each direction.

    Raises
    ------
    ValueError
        When a simulation failed, with its reason.

    Examples
    --------
    >>> from slmm.optimization import HolePattern
    >>> solid = shifted_design(HolePattern(1, "full", sides="left"), np.zeros((1, 1), bool))
    >>> solid.is_steady, solid.value == solid.worst
    (True, True)
    """
    turned = [np.rot90(whole, k) for k in range(problem.directions)]
    U_T = np.array([float(problem.fracture(problem.plate.scene(each)).U_T) for each in turned])
    moved = np.array([[float(result.U_T) for result in shifted(problem, each)] for each in turned])
    count = OVER[problem.over]
    value = count(U_T.tolist())
    worst = min(value, *(count(column) for column in moved.T.tolist()))
    return Shifted(whole, value, worst, spread_of(U_T, moved, problem.over))


def toughest_steady(problem: HolePattern, designs: Iterable[tuple[Design, float]]) -> list[Shifted]:
    """Designs with their holes shifted, the toughest first, until none that follows can be the best shifted one.

    Parameters
    ----------
    designs : iterable of (ndarray (grid, grid), float)
        Whole grids and their U_T, mJ, the toughest first, as `ListedPattern.ranked` has them.

    Returns
    -------
    list of Shifted
        Those that were asked, in their order; the first steady one is the toughest that does not fork. None is steady
        where all fork. One whose simulation fails with shifted holes is left out.

    Examples
    --------
    >>> from slmm.optimization import HolePattern
    >>> problem = HolePattern(1, "full", sides="left")
    >>> asked = toughest_steady(problem, [(np.zeros((1, 1), bool), 107.0), (np.zeros((1, 1), bool), 90.0)])
    >>> len(asked), asked[0].is_steady
    (1, True)
    """
    found: list[Shifted] = []
    for whole, value in designs:
        if any(each.is_steady for each in found) and value <= max(each.worst for each in found):
            break
        try:
            found.append(shifted_design(problem, whole))
        except ValueError:
            continue
    return found
