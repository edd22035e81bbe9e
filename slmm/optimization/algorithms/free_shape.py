"""Free shape optimisation (FS): only cells on the outer edge of the design change (Paper C, section 2.2.5)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import label

from slmm.optimization.algorithms.breadth_first import descent
from slmm.optimization.ask import Asking
from slmm.optimization.problem import Problem, start_design


def fs(problem: Problem, start: ArrayLike | None, rng: np.random.Generator) -> Asking:
    """Flip one cell on the outer edge after the other, column by column, and begin again when one is better (A.5)."""

    def edge(design: np.ndarray, level: int) -> np.ndarray:
        column, row = np.nonzero((outer_edge(design) & ~problem.fixed).T)
        return np.ravel_multi_index((row, column), design.shape)[:, None]

    return (yield from descent(problem, start_design(problem, start, rng), edge))


def outer_edge(design: np.ndarray) -> np.ndarray:
    """Cells (rows, columns) on both sides of the edge between what is on and the outside.

    The outside are the cells that are off and reach the border of the grid, edge to edge. Cavities stay as they are
    (Fig. 9c): with their edges FS would need twice as many simulations as Table 2 says and find better designs.

    Examples
    --------
    >>> design = np.array([[1, 1, 1, 1], [1, 0, 1, 0], [1, 1, 1, 0]], dtype=bool)
    >>> outer_edge(design).astype(int)
    array([[0, 0, 0, 1],
           [0, 0, 1, 1],
           [0, 0, 1, 1]])
    """
    void, _ = label(~design)
    border = np.concatenate([void[0], void[-1], void[:, 0], void[:, -1]])
    outside = np.isin(void, border[border > 0])
    return (design & beside(outside)) | (outside & beside(design))


def beside(cells: np.ndarray) -> np.ndarray:
    """Which cells (rows, columns) share an edge with one of these."""
    around = np.pad(cells, 1)
    return around[:-2, 1:-1] | around[2:, 1:-1] | around[1:-1, :-2] | around[1:-1, 2:]
