"""Polynomial deformation modes of the crack cell (Paper A, Eq. 3 to 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Mode:
    """Displacement xi^p eta^q in one direction.

    Parameters
    ----------
    direction : int
        0: along xi, 1: along eta.
    p, q : int
        Powers of xi and eta.
    """

    direction: int
    p: int
    q: int

    @property
    def name(self) -> str:
        """Readable name, e.g. ``xi: xi^1 eta^0``."""
        return f"{('xi', 'eta')[self.direction]}: xi^{self.p} eta^{self.q}"

    @property
    def symmetric(self) -> bool:
        """Whether the mode is its own mirror image about the crack line xi = 0."""
        return (self.p % 2 == 1) == (self.direction == 0)

    def __call__(self, xi: np.ndarray, eta: np.ndarray) -> np.ndarray:
        """Displacement, mm."""
        return xi**self.p * eta**self.q


def published_modes() -> list[Mode]:
    """The 16 modes of Paper A, Eq. 5.

    Examples
    --------
    >>> [mode.name for mode in published_modes()[:2]]
    ['xi: xi^0 eta^1', 'xi: xi^0 eta^2']
    """
    return [Mode(d, p, q) for d in (0, 1) for p in range(3) for q in range(3) if p + q > 0]


def complete_modes(degree: int) -> list[Mode]:
    """The published modes and every other polynomial with p + q <= degree that adds something.

    On the three straight edges (1 - xi^2)(l - eta) vanishes, so beyond the published ones all powers with
    p >= 2 and q >= 1 only repeat lower ones there.

    Examples
    --------
    >>> len(complete_modes(4))
    26
    """
    modes = published_modes()
    for d in (0, 1):
        for n in range(1, degree + 1):
            higher = [Mode(d, p, n - p) for p in range(n + 1) if p < 2 or p == n]
            modes += [mode for mode in higher if mode not in modes]
    return modes
