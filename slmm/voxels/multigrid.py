"""Geometric multigrid for the voxel model: a cycle in single precision that preconditions the CG of voxel.py.

Galerkin coarse grids, bilinear interpolation, and Chebyshev polynomials of the fourth kind over Jacobi as
smoother (J. Lottes, Optimal polynomial smoothers for multigrid V-cycles, Numer. Linear Algebra Appl. 30,
2023). They need a bound of the largest eigenvalue only, so nothing has to be estimated.

The coarse grids' stencils are computed in double precision, each from the finer one, and only then rounded for
the cycle. What is soft about a plate (it bends, it turns freely, its voids) is a difference of stiff entries; in
single precision it drowned after a few grids, and models of a million voxels under a stress did not converge.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from slmm.running.threaded import number_of_threads
from slmm.voxels import kernels as voxel_kernels
from slmm.voxels import stencil as voxel_stencil
from slmm.voxels.element import coefficients, largest_eigenvalue

Field = NDArray[Any]  # float32, or float64 where a model asks for it

PADDING = 5  # n intervals have n + 1 nodes, and an array one zero before and three after them; computed
DIRECT = 300  # nodes below which a grid is solved directly; chosen
NODES_PER_THREAD = (
    25_000  # below, threads wait for each other longer than they work: 50 times on a busy machine; measured
)


def padded_zeros(nx: int, ny: int, dtype: type = np.float32, leading: tuple[int, ...] = (2,)) -> NDArray:
    """Zeros in the layout of kernels for nx by ny intervals."""
    return np.zeros((*leading, ny + PADDING, nx + PADDING), dtype)


@dataclass
class Grid:
    """One coarse grid: its stencils, fields and how it hangs on the finer one."""

    stencil: Field  # (rows, 19, columns)
    free: Field  # (2, rows), see kernels
    columns: Field  # (columns,)
    weights_x: Field  # (2, columns of nodes + 1) interpolation from this grid to the finer one
    weights_y: Field
    bound: float  # of the eigenvalues of D^-1 A
    b: Field
    u: Field
    other: Field


class Multigrid:
    """Multigrid cycle for one voxel model.

    Parameters
    ----------
    density : float32 array
        Relative stiffness in the padded layout of kernels.
    nx, ny : int
        Number of voxels.
    width, height : float
        Plate, mm.
    nu : float
        Poisson's ratio (plane stress equivalent).
    free_rows : (2, ny + 1) bool array
        Whether u_x, u_y are unknown in the node rows.
    free_sides : bool
        Whether the nodes on the left and right edge are unknown.
    rigid : sequence of {"x", "y", "rotation"}
        Rigid motions that nothing holds.
    degree : int
        Degree of the Chebyshev smoother, before and after the coarse correction.
    """

    precision: type = np.float32  # of the coarse grids' stencils and fields

    def __init__(
        self,
        density: Field,
        nx: int,
        ny: int,
        width: float,
        height: float,
        nu: float,
        free_rows: NDArray[np.bool_],
        free_sides: bool,
        rigid: tuple[str, ...] = (),
        degree: int = 3,
    ) -> None:
        """Build all coarse grids and factorise the coarsest."""
        hx, hy = width / nx, height / ny
        self.density = density
        exact = coefficients(hx, hy, nu)
        self.coefficients = exact.astype(np.float32)
        self.free, self.columns = _free(free_rows, free_sides, nx)
        self.bound = largest_eigenvalue(hx, hy, nu)
        self.degree = degree
        self._cycles_on_first = 1  # corrections by the first coarse grid in a cycle; two on all others
        self._threads = number_of_threads()
        self.u = padded_zeros(nx, ny)
        self.other = padded_zeros(nx, ny)
        self.products = np.zeros(ny + PADDING)
        self.grids: list[Grid] = []
        stencil = np.empty((0, 19, 0))  # of the coarsest grid so far
        x, y = np.linspace(0, width, nx + 1), np.linspace(0, height, ny + 1)
        while len(x) * len(y) > DIRECT and min(len(x), len(y)) > 3:
            weights_x, weights_y = interpolation(x), interpolation(y)
            x, y, rows = coarser_nodes(x), coarser_nodes(y), coarser_nodes(np.arange(free_rows.shape[1]))
            free_rows = free_rows[:, rows]
            nx, ny = len(x) - 1, len(y) - 1
            coarse = np.zeros((ny + PADDING, 19, nx + PADDING))
            self.share_work(coarse[:, 0][None])
            voxel_stencil.coarsen(density, exact, stencil, weights_x, weights_y, coarse)
            stencil = coarse
            self._append_grid(stencil, nx, ny, weights_x, weights_y, *_free(free_rows, free_sides, nx))
        if not len(stencil):
            stencil = np.zeros((ny + PADDING, 19, nx + PADDING))
            for i in range(1, ny + 2):
                voxel_kernels.stencil_row(i, density, exact, stencil[i])
        unknown = np.repeat(free_rows[:, :, None], nx + 1, axis=2)
        if not free_sides:
            unknown[:, :, [0, -1]] = False
        self._factorise(stencil, unknown, _rigid_motions(x, y, rigid))

    def _append_grid(
        self,
        stencil: NDArray[np.float64],
        nx: int,
        ny: int,
        weights_x: NDArray[np.float64],
        weights_y: NDArray[np.float64],
        free: Field,
        columns: Field,
    ) -> None:
        rounded: Field = stencil.astype(self.precision, copy=False)
        b, u, other = (padded_zeros(nx, ny, self.precision) for _ in range(3))
        bound = _largest_eigenvalue(rounded, free, columns, u)
        u[:] = 0
        wx: Field = weights_x.astype(self.precision)
        wy: Field = weights_y.astype(self.precision)
        self.grids.append(Grid(rounded, free, columns, wx, wy, bound, b, u, other))

    def _factorise(
        self, stencil: NDArray[np.float64], unknown: NDArray[np.bool_], motions: NDArray[np.float64]
    ) -> None:
        """LU of the coarsest grid; rigid motions that nothing holds are fixed by Lagrange multipliers."""
        A = _matrix(stencil[1:-3, :, 1:-3])
        self._unknown = np.flatnonzero(unknown)
        A = A[self._unknown][:, self._unknown]
        # A cycle in single precision cannot tell softer motions from its own rounding, and must not magnify that:
        # with 1e-10, 2 of 150 random plates did not converge. With 1e-3, slender plates were too stiff to bend.
        A = A + sp.diags_array(1e-6 * A.diagonal())
        motions = motions[:, self._unknown]
        self._multipliers = len(motions)
        if self._multipliers:
            border = sp.csr_array(motions * A.diagonal().mean())
            A = sp.block_array([[A, border.T], [border, None]])
        self._lu = splu(A.tocsc())

    def _solve_coarsest(self, b: Field, u: Field) -> None:
        rhs = np.zeros(len(self._unknown) + self._multipliers)
        inner = b[:, 1:-3, 1:-3]
        rhs[: len(self._unknown)] = inner.ravel()[self._unknown]
        solution = np.zeros(inner.size)
        solution[self._unknown] = self._lu.solve(rhs)[: len(self._unknown)]
        u[:, 1:-3, 1:-3] = solution.reshape(inner.shape)

    def precondition(self, b: Field) -> tuple[Field, float]:
        """One cycle from zero: z, about A^-1 b, and b . z. The array z belongs to this object."""
        if not self.grids:
            self._solve_coarsest(b, self.u)
            return self.u, float(np.sum(b * self.u, dtype=float))
        density, c, free, columns = self.density, self.coefficients, self.free, self.columns
        u, other = self.u, self.other
        steps = chebyshev_steps(self.degree, self.bound)
        voxel_kernels.smooth_from_zero(density, b, u, c, steps[0][1], free, columns)
        for number, (momentum, step) in enumerate(steps[1:]):
            # the start was zero, whatever ``other`` holds in the first of these steps
            old = momentum if number else np.float32(0)
            voxel_kernels.smooth(
                density, u, b, other, c, 1 + momentum, old, step, free, columns, self.products
            )
            u, other = other, u
        first = self.grids[0]
        voxel_stencil.restrict_from_voxels(
            density, u, b, c, free, columns, first.weights_x, first.weights_y, first.b
        )
        correction = self._cycle(0)
        self.share_work(u)
        voxel_stencil.prolong(correction, u, first.weights_x, first.weights_y)
        for momentum, step in steps:
            voxel_kernels.smooth(
                density, u, b, other, c, 1 + momentum, momentum, step, free, columns, self.products
            )
            u, other = other, u
        return u, float(self.products.sum())

    def strengthen(self) -> None:
        """Make the cycle dearer and better from here on: twice the degree, no less than two cycles on any coarse grid.

        For what coarse grids do not see, as gaps and ligaments of a voxel.
        """
        self.degree *= 2
        self._cycles_on_first = 2

    def share_work(self, field: np.ndarray) -> None:
        """Set the number of threads to what a grid of this size is worth, at most what was set before."""
        numba.set_num_threads(max(1, min(self._threads, field[0].size // NODES_PER_THREAD)))

    def _cycle(self, level: int) -> Field:
        """The coarse correction: one cycle on the first coarse grid, two on all others (they cost little).

        Gaps between holes vanish on coarse grids, and the second cycle makes up for that: up to 40 % fewer
        iterations with many holes, a tenth more time with one.
        """
        grid = self.grids[level]
        if level == len(self.grids) - 1:
            self._solve_coarsest(grid.b, grid.u)
            return grid.u
        self.share_work(grid.u)
        stencil, b, free, columns, coarser = (
            grid.stencil,
            grid.b,
            grid.free,
            grid.columns,
            self.grids[level + 1],
        )
        wx, wy = coarser.weights_x, coarser.weights_y
        u, other = grid.u, grid.other
        steps = chebyshev_steps(self.degree, grid.bound)
        for cycle in range(self._cycles_on_first if level == 0 else 2):
            first = 0
            if cycle == 0:
                voxel_stencil.smooth_from_zero(stencil, b, u, steps[0][1], free, columns)
                first = 1
            for number, (momentum, step) in enumerate(steps[first:]):
                old = momentum if number else np.float32(0)
                voxel_stencil.smooth(stencil, u, b, other, 1 + momentum, old, step, free, columns)
                u, other = other, u
            voxel_stencil.restrict_from_stencil(stencil, u, b, free, columns, wx, wy, coarser.b)
            correction = self._cycle(level + 1)
            self.share_work(u)
            voxel_stencil.prolong(correction, u, wx, wy)
            for momentum, step in steps:
                voxel_stencil.smooth(stencil, u, b, other, 1 + momentum, momentum, step, free, columns)
                u, other = other, u
        return u


def chebyshev_steps(degree: int, bound: float) -> list[tuple[np.float32, np.float32]]:
    """Momentum and step of each degree: u_k = u + momentum (u - u_old) + step D^-1 (b - A u)."""
    return [
        (
            np.float32((2 * k - 3) / (2 * k + 1) if k > 1 else 0.0),
            np.float32((8 * k - 4) / (2 * k + 1) / bound),
        )
        for k in range(1, degree + 1)
    ]


def _free(free_rows: NDArray[np.bool_], free_sides: bool, nx: int) -> tuple[Field, Field]:
    free = np.zeros((2, free_rows.shape[1] + PADDING - 1), np.float32)
    free[:, 1:-3] = free_rows
    columns = np.zeros(nx + PADDING, np.float32)
    columns[1:-3] = 1
    if not free_sides:
        columns[[1, -4]] = 0
    return free, columns


def coarser_nodes(nodes: NDArray) -> NDArray:
    """Every second node, and always the last."""
    return nodes[::2] if len(nodes) % 2 else np.append(nodes[::2], nodes[-1])


def interpolation(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights of the coarse neighbours of each odd node, in the layout of voxel_stencil."""
    left, middle = x[:-1:2], x[1::2]
    right = x[2::2] if len(x) % 2 else np.append(x[2::2], x[-1])
    weights = np.zeros((2, len(middle) + 2))
    t = (middle - left) / (right - left)
    weights[:, 1:-1] = 1 - t, t
    return weights


def _largest_eigenvalue(stencil: Field, free: Field, columns: Field, scale: Field) -> float:
    """Gershgorin bound of D^-1 A; ``scale`` is working space."""
    for component, q in enumerate((0, 2)):
        diagonal = stencil[1:-3, q, 1:-3]
        scale[component, 1:-3, 1:-3] = free[component, 1:-3, None] * columns[1:-3] / np.sqrt(diagonal)
    bounds = np.zeros(len(stencil), np.float32)
    voxel_stencil.row_sum_bound(stencil, scale, free, columns, bounds)
    return float(bounds.max())


def _matrix(stencil: NDArray[np.float64]) -> sp.csr_array:
    """The sparse matrix of a small stencil (rows, 19, columns); unknowns by component, row, column."""
    rows, _, columns = stencil.shape
    node = np.arange(rows * columns).reshape(rows, columns)
    i, j, value = [], [], []
    for q, components in ((0, (0, 0)), (1, (0, 1)), (2, (1, 1))):
        i.append(node + components[0] * node.size)
        j.append(node + components[1] * node.size)
        value.append(stencil[:, q] * (1.0 if q == 1 else 0.5))
    for q, (up, right) in ((3, (0, 1)), (7, (1, 0)), (11, (1, 1)), (15, (1, -1))):
        start, stop = max(0, -right), columns - max(0, right)
        here = np.s_[: rows - up, start:stop]
        there = np.s_[up:, start + right : stop + right]
        for k in range(4):
            i.append(node[here] + k // 2 * node.size)
            j.append(node[there] + k % 2 * node.size)
            value.append(stencil[here[0], q + k, here[1]])
    entries = (np.concatenate([v.ravel() for v in value]),)
    indices = (np.concatenate([v.ravel() for v in i]), np.concatenate([v.ravel() for v in j]))
    half = sp.coo_array((*entries, indices), shape=(2 * node.size, 2 * node.size)).tocsr()
    return (half + half.T).tocsr()


def _rigid_motions(
    x: NDArray[np.float64], y: NDArray[np.float64], rigid: tuple[str, ...]
) -> NDArray[np.float64]:
    """The named rigid motions as rows of unit length, orthogonal to each other."""
    one, zero = np.ones((len(y), len(x))), np.zeros((len(y), len(x)))
    X, Y = np.meshgrid(x - x.mean(), y - y.mean())
    motions = {"x": (one, zero), "y": (zero, one), "rotation": (-Y, X)}
    rows = [np.concatenate([part.ravel() for part in motions[name]]) for name in rigid]
    return np.array([row / np.linalg.norm(row) for row in rows]).reshape(len(rows), 2 * one.size)
