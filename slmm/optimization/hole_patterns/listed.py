"""Hole patterns whose values are listed: a real problem with a known optimum to try searches on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from slmm.optimization.hole_patterns.patterns import Design
from slmm.optimization.hole_patterns.problem import HolePattern
from slmm.optimization.problem import Bound, Value
from slmm.running.input_file import shown


@dataclass(frozen=True)
class ListedPattern(HolePattern):
    """A hole pattern that looks up what others simulate.

    Parameters
    ----------
    values : mapping
        Minus U_T, mJ, of every valid design by its key; NaN where a simulation failed.

    Examples
    --------
    >>> key = HolePattern(1, "full").key
    >>> solid, hole = np.array([[False]]), np.array([[True]])
    >>> listed = ListedPattern(1, "full", values={key(solid): -107.0, key(hole): -200.0})
    >>> listed.evaluate(hole, np.inf), listed.rank(-107.0)
    (Value(value=-200.0), 2)
    """

    values: Mapping[bytes, float] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def read(cls, path: str | Path, pattern: str, grid: int) -> ListedPattern:
        """One space of a file as validation/hole_pattern_values.py writes it.

        Raises
        ------
        ValueError
            When the space is not in it.
        """
        with xr.open_dataset(path) as file:
            here = (file.pattern == pattern).values & (file.grid == grid).values
            names, U_T = file.key.values[here], file.U_T.values[here]
        if not len(names):
            raise ValueError(
                f"{shown(Path(path))}: has no values of {pattern} patterns of {grid} x {grid} points"
            )
        return cls(grid, pattern, values=dict(zip(map(bytes.fromhex, names), (-U_T).tolist(), strict=True)))

    def valid(self, designs: np.ndarray) -> np.ndarray:
        """Which designs (n, rows, columns) are in the list."""
        return np.array([self.key(design) in self.values for design in designs], dtype=bool)

    def evaluate(self, design: np.ndarray, below: float) -> Value | Bound:
        """What is in the list; a bound where the value is not below the limit."""
        value = self.values[self.key(design)]
        return Bound(value) if value >= below else Value(value)

    def rank(self, value: float) -> int:
        """How many classes of equal designs are as good or better, with itself."""
        return 1 + int(np.sum(np.array(list(self.values.values())) < value))

    def ranked(self) -> list[tuple[Design, float]]:
        """A whole grid of each class of equal designs, and its U_T, mJ, the toughest first; none without a value.

        Examples
        --------
        >>> key = HolePattern(2, "full").key
        >>> corner = np.array([[True, False], [False, False]])
        >>> listed = ListedPattern(2, "full", values={key(0 * corner): -107.0, key(corner): -200.0})
        >>> listed.ranked()[0]
        (array([[False, False],
               [False,  True]]), 200.0)
        """
        size = self.grid**2
        known = [(key, -value) for key, value in self.values.items() if np.isfinite(value)]
        return [
            (
                np.unpackbits(np.frombuffer(key, np.uint8))[:size].astype(bool).reshape(self.grid, self.grid),
                U_T,
            )
            for key, U_T in sorted(known, key=lambda item: -item[1])
        ]
