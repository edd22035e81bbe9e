"""The cantilever of Paper C, section 2.1: a beam of cells under its own weight, whose end should sag as little as can.

The beam is 120 mm long and 40 mm high and held at its left edge. A cell of its grid is one element with eight nodes and
two by two integration points (plane stress), or nothing. The left column and the top row are always there. A design is
valid when every cell hangs together with them, edge to edge.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike
from scipy.sparse.linalg import splu

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.elements import ELEMENTS
from slmm.optimization.cantilever.column_kernels import all_connected, connected, endpoint_displacements, held
from slmm.optimization.checks import check_whole
from slmm.optimization.problem import Neighbours

LENGTH, HEIGHT = 120.0, 40.0  # mm
#: Table 1
MATERIAL = Elasticity(200.0, 0.45, "plane stress")
#: density, t/mm3, times gravity, mm/s2: N/mm3
WEIGHT = 1000e-12 * 9810.0


@dataclass(frozen=True)
class Cantilever:
    """The benchmark on a grid.

    Parameters
    ----------
    columns, rows : int
        Number of cells along the beam and over its height.

    Raises
    ------
    ValueError
        For less than one column or row.

    Examples
    --------
    >>> beam = Cantilever(8, 5)
    >>> full = np.ones((5, 8), dtype=bool)
    >>> lightest = full.copy()
    >>> lightest[1:, 1:] = False
    >>> loose = lightest.copy()
    >>> loose[4, 7] = True
    >>> beam.endpoint_displacement([full, lightest, loose]).round(5)
    array([0.01055, 0.16042,     nan])
    """

    columns: int
    rows: int

    #: of what `evaluate` finds
    objective: ClassVar[Mapping[str, str]] = {"units": "mm", "long_name": "sag of the upper right corner"}

    def __post_init__(self) -> None:
        for name in ("columns", "rows"):
            value = getattr(self, name)
            check_whole(name, value, 1)
            # the repr tells a beam from others
            object.__setattr__(self, name, int(value))

    def endpoint_displacement(self, designs: ArrayLike) -> np.ndarray:
        """How far the upper right corner sags (n,), mm; NaN where a design is not valid.

        Parameters
        ----------
        designs : array_like of bool (n, rows, columns)
            Where there is material; row 0 is the top.

        Raises
        ------
        ValueError
            For designs of another shape.
        """
        return endpoint_displacements(self.checked(designs), *self.cell)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.columns

    @cached_property
    def fixed(self) -> np.ndarray:
        """The cells that never change (rows, columns): those of the left column and of the top row."""
        result = np.zeros(self.shape, dtype=bool)
        result[0] = result[:, 0] = True
        return result

    @property
    def start(self) -> np.ndarray:
        """The design that has the fixed cells alone."""
        return self.fixed

    def valid(self, designs: ArrayLike) -> np.ndarray:
        """Whether designs (n, rows, columns) have their fixed cells and hang together (n,)."""
        return all_connected(self.checked(designs))

    def evaluate(self, designs: np.ndarray) -> np.ndarray:
        """See `endpoint_displacement`."""
        return self.endpoint_displacement(designs)

    def repaired(self, design: np.ndarray) -> np.ndarray:
        """The design (rows, columns) with its fixed cells and without what does not hang on them."""
        return held(self.checked([design])[0] | self.fixed)

    def resized(self, columns: int, rows: int) -> Cantilever:
        """The same beam on another grid."""
        return Cantilever(columns, rows)

    def neighbours(self, centre: np.ndarray) -> Neighbours:
        """A quick model of the designs around a valid one (rows, columns)."""
        # the model is made of this problem
        from slmm.optimization.cantilever.neighbourhood_model import model_around

        return model_around(self, np.ascontiguousarray(centre, dtype=bool).tobytes())

    def checked(self, designs: ArrayLike) -> np.ndarray:
        """Designs as an array of bool."""
        array = np.ascontiguousarray(designs)
        if array.ndim != 3 or array.shape[1:] != (self.rows, self.columns):
            raise ValueError(
                f"designs have the shape {array.shape}: must be (n, {self.rows}, {self.columns})"
            )
        if array.dtype != bool:
            if not np.isin(array, (0, 1)).all():
                raise ValueError("designs: must be True or False, or 1 and 0")
            array = array.astype(bool)
        return array

    @cached_property
    def cell(self) -> tuple[np.ndarray, np.ndarray]:
        """Stiffness (16, 16) and weight (16,) of one cell, y pointing down, for a thickness of 1 mm."""
        element = ELEMENTS["CPE8R"]
        X = element.nodes * [LENGTH / self.columns / 2, HEIGHT / self.rows / 2]
        jacobian = np.einsum("ni,pnj->pij", X, element.gradient_at_points)
        gradient = element.gradient_at_points @ np.linalg.inv(jacobian)
        volume = np.linalg.det(jacobian) * element.weights
        C = MATERIAL.stress(np.eye(4).reshape(4, 2, 2)).reshape(2, 2, 2, 2)
        K = np.einsum("pnj,klij,pml,p->nimk", gradient, C, gradient, volume)
        f = np.zeros((8, 2))
        f[:, 1] = WEIGHT * (element.shape(element.points).T @ volume)
        return K.reshape(16, 16), f.ravel()

    def solved_directly(self, design: ArrayLike) -> float:
        """The same for one design (rows, columns) by a sparse LU of all its nodes at once: slow, to compare with."""
        cells = self.checked(np.asarray(design)[None])[0]
        return float(self.displacements(cells)[0, -1, 1]) if connected(cells) else float("nan")

    def displacements(self, design: ArrayLike) -> np.ndarray:
        """Displacements (2 rows + 1, 2 columns + 1, 2) of all nodes of a valid design (rows, columns), y down, mm.

        Nodes are those of the corners and the middles of edges; where there is no material, they are NaN.

        Raises
        ------
        ValueError
            When the design is not valid.
        """
        cells = self.checked(np.asarray(design)[None])[0]
        if not connected(cells):
            raise ValueError("design: its cells must hang together with the left column and the top row")
        K_cell, f_cell = self.cell
        across, down = 2 * self.columns + 1, 2 * self.rows + 1
        number = np.arange(across * down).reshape(down, across)
        corner = [(0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0)]
        r, c = np.nonzero(cells)
        nodes = np.stack([number[2 * r + i, 2 * c + j] for i, j in corner], axis=1)
        dofs = (2 * nodes[..., None] + np.arange(2)).reshape(len(nodes), 16)
        K = sp.csr_array(
            (
                np.tile(K_cell.ravel(), len(dofs)),
                (np.repeat(dofs, 16, axis=1).ravel(), np.tile(dofs, 16).ravel()),
            ),
            shape=(2 * number.size, 2 * number.size),
        )
        f = np.bincount(dofs.ravel(), np.tile(f_cell, len(dofs)), 2 * number.size)
        held = (2 * number[:, :1] + np.arange(2)).ravel()
        free = np.setdiff1d(np.unique(dofs), held)
        u = np.full(2 * number.size, np.nan)
        u[held] = 0.0
        u[free] = splu(K[free][:, free].tocsc()).solve(f[free])
        return u.reshape(down, across, 2)
