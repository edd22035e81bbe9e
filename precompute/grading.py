"""Graded divisions of a line: fine where a crack tip will be, coarse elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np


@dataclass(frozen=True)
class Fineness:
    """How finely a half body is divided.

    Parameters
    ----------
    tip : float
        Element size at each stored crack tip, as a fraction of that crack's length.
    growth : float
        Ratio of the sizes of neighbouring elements away from tips and crack line.
    coarsest : float
        Largest element size within the cell, mm in the image space.
    """

    tip: float = 0.002
    growth: float = 1.3
    coarsest: float = 0.08


def graded(length: float, first: float, last: float, growth: float, coarsest: float = np.inf) -> np.ndarray:
    """Divide [0, length] with sizes that grow geometrically away from both ends.

    ``inf`` as the size at one end lets the sizes grow all the way to it.

    Examples
    --------
    >>> graded(7.0, 1.0, float("inf"), 2.0)
    array([0., 1., 3., 7.])
    """
    left = [first] if np.isfinite(first) else []
    right = [last] if np.isfinite(last) else []
    while sum(left) + sum(right) < length * (1 - 1e-12):
        at_left = left[-1] if left else np.inf
        at_right = right[-1] if right else np.inf
        side = left if at_left <= at_right else right
        side.append(min(side[-1] * growth, coarsest))
    sizes = np.array(left + right[::-1])
    return np.concatenate([[0.0], np.cumsum(sizes)]) * (length / sizes.sum())


def crack_line(lengths: np.ndarray, end: float, fineness: Fineness, coarsest_tail: float) -> np.ndarray:
    """Ends of the elements along the crack line from the mouth to ``end``.

    Every stored tip is an element end with fine elements on both sides. Up to the last tip the division does
    not depend on ``end``.
    """
    f = fineness
    tips = np.concatenate([[0.0], lengths])
    pieces = [
        a + graded(b - a, f.tip * a if a > 0 else np.inf, f.tip * b, f.growth, f.coarsest)[:-1]
        for a, b in pairwise(tips)
    ]
    left = end - tips[-1]
    tail = graded(left, f.tip * tips[-1], np.inf, f.growth, coarsest_tail) if left > 0 else np.zeros(1)
    return np.concatenate([*pieces, tips[-1] + tail])
