"""Designs of hole patterns: from the variables of a pattern to the whole grid, and what symmetry makes equal.

A design of the full pattern is the whole grid, row 0 at the top, True for a hole. The reflected pattern repeats its top
right quarter by mirroring, the rotated one by turning; the quarter has the middle row and column of an odd grid. Under
turns half of these are the same cells: the middle row right of the middle is fixed then and of no importance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Design = NDArray[np.bool_]
#: directions from which the crack comes, in quarter turns, that symmetry leaves different
DIRECTIONS: dict[str, int] = {"full": 4, "reflected": 2, "rotated": 1}


def shape_of(pattern: str, grid: int) -> tuple[int, int]:
    """Rows and columns of a design."""
    side = grid if pattern == "full" else (grid + 1) // 2
    return side, side


def fixed_cells(pattern: str, grid: int) -> Design:
    """Cells of a design that are of no importance.

    Examples
    --------
    >>> [int((~fixed_cells("rotated", n)).sum()) for n in (3, 5, 7, 9)]
    [3, 7, 13, 21]
    """
    fixed = np.zeros(shape_of(pattern, grid), dtype=bool)
    if pattern == "rotated" and grid % 2:
        fixed[-1, 1:] = True
    return fixed


def expanded(design: Design, pattern: str, grid: int) -> Design:
    """The whole grid of a design.

    Examples
    --------
    >>> quarter = np.array([[False, True], [False, False]])
    >>> expanded(quarter, "reflected", 4).astype(int).tolist()
    [[1, 0, 0, 1], [0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 1]]
    >>> expanded(np.array([[True, False], [False, False]]), "rotated", 3).astype(int).tolist()
    [[0, 1, 0], [1, 0, 1], [0, 1, 0]]
    """
    if pattern == "full":
        return np.asarray(design, dtype=bool)
    row, column = np.indices((grid, grid))
    if pattern == "reflected":
        upper = np.minimum(row, grid - 1 - row)
        right = np.maximum(column, grid - 1 - column) - grid // 2
        return np.asarray(design[upper, right], dtype=bool)
    half, odd = grid // 2, grid % 2
    whole = np.zeros((grid, grid), dtype=bool)
    # top right, with the upper part of the middle column
    whole[:half, half:] = design[:half]
    whole = whole | np.rot90(whole) | np.rot90(whole, 2) | np.rot90(whole, 3)
    if odd:
        whole[half, half] = design[half, 0]
    return whole


def symmetric(whole: Design) -> Design:
    """Of the eight grids that turning and mirroring make of one, the least.

    Examples
    --------
    >>> corner = np.array([[False, True], [False, False]])
    >>> symmetric(corner).astype(int).tolist()
    [[0, 0], [0, 1]]
    """
    turned = [np.rot90(whole, k) for k in range(4)]
    return min((*turned, *(grid[::-1] for grid in turned)), key=lambda grid: np.packbits(grid).tobytes())
