"""Multigrid for a grid whose finest stencil is given: the voxels of a part with the springs that hold it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.rigid import motions_about
from slmm.running.threaded import number_of_threads
from slmm.voxels import stencil as voxel_stencil
from slmm.voxels.element import coefficients
from slmm.voxels.grid import VoxelGrid
from slmm.voxels.multigrid import DIRECT, PADDING, Multigrid, coarser_nodes, interpolation


class StencilMultigrid(Multigrid):
    """Multigrid cycle for one stencil on a grid of voxels, in double precision.

    In single precision, rounding resists long waves of a slender part more than the part itself does.

    Parameters
    ----------
    stencil : float64 array
        In the padded layout of `slmm.voxels.stencil`; a node that is held keeps its diagonal alone.
    grid : VoxelGrid
    nu : float
        Poisson's ratio (plane stress equivalent).
    free : ndarray, shape (k, 3)
        Rigid motions that nothing holds, as combinations of `motions_about` the middle of the grid.
    degree : int
        Degree of the Chebyshev smoother.
    bound : float
        Of the eigenvalues of D^-1 A on the finest grid.
    """

    precision = np.float64

    def __init__(
        self,
        stencil: NDArray[np.float64],
        grid: VoxelGrid,
        nu: float,
        free: NDArray[np.float64],
        degree: int,
        bound: float,
    ) -> None:
        """Build all coarse grids and factorise the coarsest."""
        self.degree = degree
        self._cycles_on_first = 1
        self._threads = number_of_threads()
        self.grids = []
        nx, ny = grid.nx, grid.ny
        x, y = (np.linspace(0.0, n * h, n + 1) for n, h in ((nx, grid.hx), (ny, grid.hy)))
        no_voxels, exact = np.empty((0, 0), np.float32), coefficients(grid.hx, grid.hy, nu)
        self._append(stencil, nx, ny, (interpolation(x), interpolation(y)))
        self.grids[0].bound = min(bound, self.grids[0].bound)
        while len(x) * len(y) > DIRECT and min(len(x), len(y)) > 3:
            weights = interpolation(x), interpolation(y)
            x, y = coarser_nodes(x), coarser_nodes(y)
            nx, ny = len(x) - 1, len(y) - 1
            coarse = np.zeros((ny + PADDING, 19, nx + PADDING))
            self.share_work(coarse[:, 0][None])
            voxel_stencil.coarsen(no_voxels, exact, stencil, *weights, coarse)
            stencil = coarse
            self._append(stencil, nx, ny, weights)
        middle = np.array([0.5 * x[-1], 0.5 * y[-1]])
        nodes = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        motions = motions_about(nodes, middle, float(middle.max())) @ free.T
        rows = motions.transpose(2, 1, 0).reshape(len(free), 2 * len(nodes))
        rows = np.linalg.qr(rows.T)[0].T if len(rows) else rows
        self._factorise(stencil, np.ones((2, ny + 1, nx + 1), dtype=bool), rows)

    def _append(
        self,
        stencil: NDArray[np.float64],
        nx: int,
        ny: int,
        weights: tuple[NDArray[np.float64], NDArray[np.float64]],
    ) -> None:
        """One more grid, with the weights of interpolation from it."""
        free = np.zeros((2, ny + PADDING), np.float32)
        columns = np.zeros(nx + PADDING, np.float32)
        free[:, 1:-3], columns[1:-3] = 1, 1
        self._append_grid(stencil, nx, ny, *weights, free, columns)

    def precondition(self, b: NDArray) -> tuple[NDArray, float]:
        """One cycle from zero: z, about A^-1 b, and b . z. The array z belongs to this object."""
        finest = self.grids[0]
        finest.b[...] = b
        z = self._cycle(0)
        return z, float(np.sum(finest.b * z, dtype=float))
