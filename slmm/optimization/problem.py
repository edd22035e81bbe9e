"""What a search has to know of a problem, and designs to start from.

Every problem is a `Problem`, and says in one of two ways how good designs are: `ManyAtOnce`, where one is cheap, or
`OneByOne`, where it takes seconds and may be given up once it is known not to be good enough. What else it can do is up
to it: `Repairing` and `Resizing`, which some algorithms need, `WithKeys`, and `WithNeighbours`.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

#: how often a random design is drawn before the last draw is repaired; fine grids have next to no valid draw (chosen)
DRAWS = 1000
#: what every problem has
NEEDED = ("shape", "fixed", "start", "objective", "valid", "evaluate")


@dataclass(frozen=True)
class Value:
    """How good a design is, the less the better. What is not finite counts as failed.

    Parameters
    ----------
    value : float
        In the units of the problem's objective.

    Raises
    ------
    TypeError, ValueError
        For what is no real number.
    """

    value: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", float(self.value))


@dataclass(frozen=True)
class Bound:
    """What the value of a design is at least, where that was enough to know.

    Parameters
    ----------
    least : float
        In the units of the problem's objective.

    Raises
    ------
    TypeError, ValueError
        For what is no real number.
    """

    least: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "least", float(self.least))


class Problem(Protocol):
    """Cells on a grid, each of them on or off, and how good they are together: what every algorithm needs.

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

    @property
    def evaluate(self) -> Callable[..., Any]:
        """As that of `ManyAtOnce`, or of `OneByOne`: it is the latter if it takes ``below``."""
        ...


class ManyAtOnce(Problem, Protocol):
    """A problem of cheap designs, many of which are evaluated in one call."""

    def evaluate(self, designs: np.ndarray) -> np.ndarray:
        """Values (n,) of designs (n, rows, columns), the less the better; NaN where invalid, or where it failed.

        What is not finite counts as failed. A value depends on its design alone, to the bit: not on those evaluated
        beside it.
        """
        ...


class OneByOne(Problem, Protocol):
    """A problem of expensive designs.

    Examples
    --------
    Steps of a staircase, which is given up as soon as it is too high:

    >>> class Stairs:
    ...     shape = (1, 4)
    ...     fixed = start = np.zeros(shape, dtype=bool)
    ...     objective = {"units": "mm", "long_name": "height"}
    ...     def valid(self, designs):
    ...         return designs.any(axis=(1, 2))
    ...     def evaluate(self, design, below):
    ...         height = 0.0
    ...         for rise, there in zip((5.0, 3.0, 1.0, 2.0), design[0], strict=True):
    ...             height += rise * there
    ...             if height >= below:
    ...                 return Bound(height)
    ...         return Value(height)
    >>> Stairs().evaluate(np.array([[True, True, True, True]]), below=6.0)
    Bound(least=8.0)
    >>> from slmm.optimization import search
    >>> search(Stairs(), "bf").value
    1.0
    """

    def evaluate(self, design: np.ndarray, below: float) -> Value | Bound:
        """The value of a valid design (rows, columns), or a bound that is not below a limit.

        The value depends on the design alone, to the bit: not on the limit, which is infinity where the value itself is
        asked for. An exception is a failure of this design: the search goes on, the journal holds the reason, and the
        same question is not asked again.
        """
        ...


class Repairing(Problem, Protocol):
    """What `ga` and `mg` need besides, and random designs where next to none is valid."""

    def repaired(self, design: np.ndarray) -> np.ndarray:
        """A valid design (rows, columns) near this one, whose fixed cells are as they must be."""
        ...


class Resizing(Repairing, Protocol):
    """What `mg` needs besides."""

    def resized(self, columns: int, rows: int) -> Resizing:
        """The same problem on another grid."""
        ...


class WithKeys(Problem, Protocol):
    """What a problem has besides if designs are equal by symmetry: only one of them is evaluated."""

    def key(self, design: np.ndarray) -> bytes:
        """What a design (rows, columns) shares with those that are equal to it, and with no other of its shape.

        Which of them is evaluated is left to chance, so their values must be the same to the bit, and they must all be
        valid, or none: a problem evaluates the one by which the key is made.
        """
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


def one_by_one(problem: Problem) -> bool:
    """Whether a problem is evaluated one design at a time: its ``evaluate`` takes ``below``."""
    try:
        return "below" in inspect.signature(problem.evaluate).parameters
    except (TypeError, ValueError):  # of compiled functions nothing is known
        return False


def check_has(problem: Problem, *names: str) -> None:
    """Refuse a problem that does not have what an algorithm needs.

    Raises
    ------
    ValueError

    Examples
    --------
    >>> from slmm.optimization import Cantilever
    >>> check_has(Cantilever(4, 3), "repaired", "resized")
    """
    if missing := [name for name in names if not hasattr(problem, name)]:
        raise ValueError(
            f"problem: {problem!r} has no {' and no '.join(missing)}, needed here; see slmm.optimization.problem"
        )


def random_design(problem: Problem, rng: np.random.Generator) -> np.ndarray:
    """A random valid design (rows, columns): every free cell on or off by a coin, drawn again until it is valid.

    After a thousand draws the last one is repaired.

    Raises
    ------
    ValueError
        When the problem cannot repair it.

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
    repaired = getattr(problem, "repaired", None)
    if repaired is None:
        raise ValueError(
            f"problem: none of {DRAWS} random designs is valid, and {problem!r} has no repaired to make one; "
            "give it that, or a start to an algorithm that goes on from it alone"
        )
    return repaired(designs[-1])


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
