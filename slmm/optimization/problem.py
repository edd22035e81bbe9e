"""What a search has to know of a problem, and designs to start from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

#: how often a random design is drawn before the last draw is repaired; fine grids have next to no valid draw
DRAWS = 1000


class Problem(Protocol):
    """Cells on a grid, each of them on or off, and how good they are together.

    Its ``repr`` tells it from any other one: journals and results carry it. It must not change, and to be evaluated by
    other processes it must be possible to pickle it.

    Parameters
    ----------
    shape : (int, int)
        Rows and columns of a design.
    fixed : ndarray of bool (rows, columns)
        Cells that never change.
    start : ndarray of bool (rows, columns)
        A design that has the fixed cells as they must be; what its other cells are does not matter.
    objective : mapping
        ``units`` and ``long_name`` of the values.
    """

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        ...

    @property
    def fixed(self) -> np.ndarray:
        """Cells that never change."""
        ...

    @property
    def start(self) -> np.ndarray:
        """A design that has the fixed cells as they must be."""
        ...

    @property
    def objective(self) -> Mapping[str, str]:
        """Units and long name of the values."""
        ...

    def valid(self, designs: np.ndarray) -> np.ndarray:
        """Which designs (n, rows, columns) can be evaluated at all (n,); quick compared with an evaluation."""
        ...

    def evaluate(self, designs: np.ndarray) -> np.ndarray:
        """Values (n,) of designs (n, rows, columns), the less the better; NaN where invalid, or where it failed.

        What is not finite counts as failed. A value depends on its design alone, to the bit: not on those evaluated
        beside it.
        """
        ...

    def repaired(self, design: np.ndarray) -> np.ndarray:
        """A valid design (rows, columns) near this one, whose fixed cells are as they must be."""
        ...

    def resized(self, columns: int, rows: int) -> Problem:
        """The same problem on another grid."""
        ...


class Neighbours(Protocol):
    """A quick model of the designs around one."""

    def evaluate(self, flips: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Approximate values (n,) of designs in which these cells (n, k) of the centre are flipped, and errors (n,).

        Cells are counted row after row: ``row * columns + column``. All of these designs are valid. Where a value less
        its error is not below what is looked for, the design is not evaluated. NaN where there is no approximation.
        """
        ...


@runtime_checkable
class WithNeighbours(Protocol):
    """What a problem has besides, if there is a quick model of the designs around one."""

    def neighbours(self, centre: np.ndarray) -> Neighbours:
        """The model around a valid design (rows, columns)."""
        ...


def random_design(problem: Problem, rng: np.random.Generator) -> np.ndarray:
    """A random valid design (rows, columns): every free cell on or off by a coin, drawn again until it is valid.

    After a thousand draws the last one is repaired.

    Examples
    --------
    >>> from slmm.optimization import Cantilever
    >>> random_design(Cantilever(4, 3), np.random.default_rng(0)).astype(int)
    array([[1, 1, 1, 1],
           [1, 0, 1, 1],
           [1, 1, 0, 0]])
    """
    batch = 50
    for _ in range(DRAWS // batch):
        designs = random_cells(problem, rng, batch)
        if (valid := problem.valid(designs)).any():
            return designs[valid.argmax()]
    return problem.repaired(designs[-1])


def random_cells(problem: Problem, rng: np.random.Generator, n: int) -> np.ndarray:
    """Designs (n, rows, columns) with every free cell on or off by a coin, valid or not."""
    return np.where(problem.fixed, problem.start, rng.random((n, *problem.shape)) < 0.5)


def start_design(problem: Problem, start: ArrayLike | None, rng: np.random.Generator) -> np.ndarray:
    """The design (rows, columns) to start from: the given one, or a random one.

    Raises
    ------
    ValueError
        When the given one is not a valid design of the problem.
    """
    if start is None:
        return random_design(problem, rng)
    return start_designs(problem, np.asarray(start)[None])[0]


def start_designs(problem: Problem, start: ArrayLike) -> np.ndarray:
    """Given designs (n, rows, columns), as bool.

    Raises
    ------
    ValueError
        When one of them is not a valid design of the problem.
    """
    designs = np.asarray(start)
    if designs.shape[1:] != problem.shape or not np.isin(designs, (0, 1)).all():
        raise ValueError(
            f"start: must have {problem.shape[0]} rows and {problem.shape[1]} columns of True and False, "
            f"has the shape {designs.shape[1:]}"
        )
    designs = designs.astype(bool)
    if (designs != problem.start)[:, problem.fixed].any():
        raise ValueError(f"start: must have the fixed cells of {problem!r}")
    if not problem.valid(designs).all():
        raise ValueError(f"start: must be a valid design of {problem!r}")
    return designs
