"""Functions of the way along straight paths, through values at a few places of each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from slmm.boundary.rules import Array


@dataclass(frozen=True, eq=False)
class AlongPaths:
    """Chebyshev's places in log(1 + a/scale), so that what varies over the scale near the mouth is seen.

    Parameters
    ----------
    longest, scale : ndarray, shape (k,)
        mm.
    n : int
        Places on each path.
    with_ends : bool
        Whether the ends are two of them.

    Examples
    --------
    >>> paths = AlongPaths(np.array([2.0]), np.array([0.5]), 9)
    >>> a = np.array([[0.0, 0.3, 2.0]])
    >>> paths.at(a) @ np.exp(-paths.places)[0] - np.exp(-a) < 1e-5
    array([[ True,  True,  True]])
    """

    longest: Array
    scale: Array
    n: int
    with_ends: bool = False

    @cached_property
    def _x(self) -> Array:
        k = np.arange(self.n)
        turn = k / (self.n - 1) if self.with_ends else (k + 0.5) / self.n
        return 0.5 * (1 - np.cos(np.pi * turn))

    @cached_property
    def _factor(self) -> Array:
        k = np.arange(self.n)
        sign = (-1.0) ** k
        if self.with_ends:
            return sign * np.where((k == 0) | (k == self.n - 1), 0.5, 1.0)
        return sign * np.sin(np.pi * (k + 0.5) / self.n)

    @cached_property
    def places(self) -> Array:
        """The places (k, n), mm."""
        whole = np.log1p(self.longest / self.scale)[:, None]
        return self.scale[:, None] * np.expm1(whole * self._x)

    def at(self, a: Array) -> Array:
        """From values at the places to those at lengths (k, m), mm; (k, m, n)."""
        x = np.log1p(a / self.scale[:, None]) / np.log1p(self.longest / self.scale)[:, None]
        gap = x[:, :, None] - self._x
        exact = np.abs(gap) < 1e-14
        weights = self._factor / np.where(exact, 1.0, gap)
        on = exact.any(axis=2)
        weights[on] = exact[on]
        return weights / weights.sum(axis=2, keepdims=True)

    def tail(self, values: Array) -> Array:
        """The last two coefficients (k,) of Chebyshev's series, without ends, of values (k, n): what it leaves out."""
        k = np.arange(self.n)
        last = np.arange(self.n - 2, self.n)
        series = 2 / self.n * np.cos(np.pi * last[:, None] * (k + 0.5) / self.n)
        return np.abs(values @ series.T).sum(axis=1)
