"""What is known of designs: values, bounds, and failures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from slmm.optimization.problem import Bound, Problem, Value
from slmm.optimization.workers import Failure

if TYPE_CHECKING:
    from slmm.optimization.journal import Journal


@dataclass
class Memory:
    """What is known of designs, by `keys`, and the journal that holds it.

    Parameters
    ----------
    values : dict of bytes to float
        NaN where the evaluation of one among many failed.
    bounds : dict of bytes to float
        What values are at least.
    failures : dict of bytes to (float, str)
        The lowest limit with which an evaluation failed, and why it did.
    journal : Journal, optional
    """

    values: dict[bytes, float] = field(default_factory=dict)
    bounds: dict[bytes, float] = field(default_factory=dict)
    failures: dict[bytes, tuple[float, str]] = field(default_factory=dict)
    journal: Journal | None = None

    def add_values(self, found: Mapping[bytes, float]) -> None:
        """Remember values of many designs."""
        self.values.update(found)
        if self.journal is not None:
            self.journal.add(found)

    def add(self, name: bytes, below: float, found: Value | Bound | Failure) -> None:
        """Remember what became of one design that was evaluated with a limit; the journal has it at once."""
        match found:
            case Value(value):
                self.values[name] = value
            case Bound(least):
                self.bounds[name] = least  # higher than one before, which did not answer
            case Failure(reason):
                self.failures[name] = below, reason  # lower than one before, which did not answer
        if self.journal is not None:
            self.journal.write_one(name, below, found)

    def answer(self, name: bytes, needed: float) -> float | None:
        """The value of a design, infinity where it is not below what is needed, NaN where its evaluation fails.

        None where that is not known. What is answered does not hang on what else is known: a value found with a higher
        limit is told as a bound would be, and a failure with a higher limit does not answer, as an evaluation with this
        one might be given up before it.

        Examples
        --------
        >>> memory = Memory(values={b"a": 2.0}, bounds={b"b": 3.0}, failures={b"c": (5.0, "lost")})
        >>> memory.answer(b"a", 4.0), memory.answer(b"a", 1.0), memory.answer(b"b", 3.0), memory.answer(b"c", 5.0)
        (2.0, inf, inf, nan)
        >>> memory.answer(b"b", 4.0), memory.answer(b"c", 4.0), memory.answer(b"d", 4.0)
        (None, None, None)
        """
        if (value := self.values.get(name)) is not None:
            return np.inf if value >= needed else value
        if self.bounds.get(name, -np.inf) >= needed:
            return np.inf
        if name in self.failures and self.failures[name][0] <= needed:
            return np.nan
        return None


def keys(problem: Problem, designs: np.ndarray) -> list[bytes]:
    """A name for each design (n, rows, columns): its shape, and its key or else its bits.

    Raises
    ------
    ValueError
        For a key that is not of bytes.

    Examples
    --------
    >>> from slmm.optimization import Cantilever
    >>> keys(Cantilever(4, 2), np.ones((1, 2, 4), dtype=bool))
    [b'2x4:\\xff']
    """
    n, rows, columns = designs.shape
    shape = f"{rows}x{columns}:".encode()
    its = getattr(problem, "key", None)
    if its is None:
        return [shape + bits.tobytes() for bits in np.packbits(designs.reshape(n, rows * columns), axis=1)]
    names = [its(design) for design in designs]
    if wrong := [name for name in names if not isinstance(name, bytes)]:
        raise ValueError(f"{problem!r}: key must return bytes, and returned {wrong[0]!r}")
    return [shape + name for name in names]
