"""The voxel model of a part of any outline under any conditions.

As that of a plate (`slmm.voxels.model`): bilinear elements, each as stiff as the material's share of it, solved by
conjugate gradients with multigrid. Its stiffness is kept as stencils, to which the springs that hold stretches of the
outline belong; 700 bytes for each voxel.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from slmm.mechanics.rigid import motions_about
from slmm.running.threaded import number_of_threads
from slmm.voxels import kernels as voxel_kernels
from slmm.voxels import stencil as voxel_stencil
from slmm.voxels.element import coefficients, largest_eigenvalue
from slmm.voxels.grid import VoxelGrid
from slmm.voxels.model import PATIENCE, SLOW, NotConvergedError, VoxelSolution, check_held, smoother_degree
from slmm.voxels.multigrid import PADDING, padded_zeros
from slmm.voxels.part_load import PartLoad
from slmm.voxels.stencil_multigrid import StencilMultigrid

Array = NDArray[np.float64]

#: eigenvalues of D^-1 A of springs at a point among four nodes, at most; computed
OF_SPRINGS = 4.0


class PartVoxels:
    """The stiffness of a part on a grid of voxels, with the springs that hold it, to be solved under loads.

    Parameters
    ----------
    grid : VoxelGrid
    stiffness : ndarray, shape (ny, nx)
        Relative stiffness of each voxel, above 0 and up to 1.
    E, nu : float
        Young's modulus, MPa, and Poisson's ratio, or what makes plane stress describe plane strain.
    load : PartLoad
        What holds it.

    Raises
    ------
    ValueError
        When a stiffness is out of range.
    """

    def __init__(self, grid: VoxelGrid, stiffness: Array, E: float, nu: float, load: PartLoad) -> None:
        """Assemble the stencils and build the coarse grids."""
        low, high = float(stiffness.min()), float(stiffness.max())
        if not (low >= 1e-12 and high <= 1 + 1e-9):
            raise ValueError(f"stiffness between {low} and {high}: must lie above 0 (1e-12) and not exceed 1")
        self.grid, self.stiffness, self.E, self.load = grid, stiffness, E, load
        self.shape = 2, grid.ny + PADDING, grid.nx + PADDING
        self._inner = np.s_[:, 1:-3, 1:-3]
        c = coefficients(grid.hx, grid.hy, nu)
        density = padded_zeros(grid.nx, grid.ny, np.float64, ())
        density[1:-4, 1:-4] = stiffness
        # single precision as in the voxel kernels: a void is as stiff as theirs
        density = density.astype(np.float32)
        self.stencil = np.zeros((self.shape[1], 19, self.shape[2]))
        for i in range(1, grid.ny + 2):
            voxel_kernels.stencil_row(i, density, c, self.stencil[i])
        self._add_springs()
        held = np.zeros(self.shape, dtype=bool)
        held[self._inner] = self._on_grid(load.held)
        self._free = (~held).astype(float)
        bound = largest_eigenvalue(grid.hx, grid.hy, nu)
        if load.springs:
            bound = max(bound, OF_SPRINGS)
        degree = smoother_degree(grid.hx, grid.hy, nu)
        self._threads = number_of_threads()
        try:
            self._multigrid = StencilMultigrid(self._decoupled(), grid, nu, load.free, degree, bound)
        finally:
            numba.set_num_threads(self._threads)
        motions = motions_about(grid.nodes, grid.middle, grid.reach) @ load.free.T
        self._rigid = np.zeros((len(load.free), *self.shape))
        for motion, k in zip(self._rigid, range(len(load.free)), strict=True):
            motion[self._inner] = self._on_grid(motions[..., k])
        # what is left of an unbalanced load is spread over the material, none of it over the void
        self._mass = np.zeros(self.shape)
        self._mass[self._inner] = sum(
            np.pad(stiffness, ((a, 1 - a), (b, 1 - b))) for a in (0, 1) for b in (0, 1)
        )

    def _on_grid(self, values: NDArray) -> NDArray:
        """Values (n, 2) at nodes as a field (2, ny + 1, nx + 1)."""
        return np.moveaxis(values.reshape(self.grid.ny + 1, self.grid.nx + 1, 2), 2, 0)

    def _add_springs(self) -> None:
        """The stiffness of the springs, as part of the stencils, over Young's modulus."""
        flat, columns, wide = self.stencil.reshape(-1), self.grid.nx + 1, self.shape[2]
        for nodes, share, stiffness, _ in self.load.springs:
            row, column = nodes[:, 0] // columns + 1, nodes[:, 0] % columns + 1
            for i, own, first in (
                (0, 0, 0),
                (1, 2, 3),
            ):  # xx is the first of four towards a neighbour, yy the last
                k = stiffness[:, i] / self.E
                own_entries = ((a, a, own) for a in range(4))
                east, north, aslant = ((0, 1, 3), (2, 3, 3)), ((0, 2, 7), (1, 3, 7)), ((0, 3, 11), (1, 2, 15))
                towards = ((a, b, q + first) for a, b, q in (*east, *north, *aslant))
                for a, b, q in (*own_entries, *towards):
                    place = ((row + a // 2) * 19 + q) * wide + column + a % 2
                    np.add.at(flat, place, k * share[:, a] * share[:, b])

    def _decoupled(self) -> Array:
        """The stencils without what couples to displacements that are held; these keep their diagonal."""
        if self._free.all():
            return self.stencil
        S, (x, y) = self.stencil.copy(), self._free
        S[:, 1] *= x * y
        for first, (up, right) in ((3, (0, 1)), (7, (1, 0)), (11, (1, 1)), (15, (1, -1))):
            there = np.roll(self._free, (-up, -right), axis=(1, 2))
            for q in range(4):
                S[:, first + q] *= (x, y)[q // 2] * there[q % 2]
        return S

    def solve(self, load: PartLoad, tol: float = 1e-8, max_iterations: int = 200) -> VoxelSolution:
        """Displacements under a load that holds the same displacements; where a rigid motion is free, one of them.

        Parameters
        ----------
        load : PartLoad
        tol : float
            Nodal forces out of balance to reach, over those of the load or, where it moves the part, over those that a
            solid rectangle would need; Euclidean norms.
        max_iterations : int

        Raises
        ------
        NotHeldError
            When 60 iterations did not suffice and the material is in pieces that are joined by void alone.
        NotConvergedError
            When ``max_iterations`` do not suffice.
        """
        reference = self._reference(load)
        u, b, force = (np.zeros(self.shape) for _ in range(3))
        u[self._inner] = self._on_grid(load.value)
        b[self._inner] = self._on_grid((load.force + load.pulls) / self.E)
        voxel_stencil.nodal_forces(self.stencil, u, force)
        r = self._balanced((b - force) * self._free / reference)
        step_u, iterations, residual = self._conjugate_gradients(r, tol, max_iterations)
        numba.set_num_threads(self._threads)
        if not residual <= tol:
            check_held(self.stiffness)
            raise NotConvergedError(
                f"{self.grid.nx} x {self.grid.ny} voxels: residual {residual:.1e} after {iterations} iterations, "
                f"{tol:.1e} wanted; allow more or make the void stiffer (now {self.stiffness.min():.1e})"
            )
        u += reference * step_u
        found = np.ascontiguousarray(np.moveaxis(u[self._inner], 0, 2))
        return VoxelSolution(found, iterations, residual, True)

    def solve_bodies(self, load: PartLoad, tol: float = 1e-8) -> VoxelSolution:
        """As `solve`, with the rigid bodies on the surface where the forces on them are those that act.

        By superposition of the part with the bodies still and of each of their motions.
        """
        still = self.solve(load, tol)
        moved = [self.solve(unit, tol) for unit in load.bodies]
        reactions = np.array(
            [
                [self._reaction(unit, each, one.u) for each, one in zip(load.bodies, moved, strict=True)]
                for unit in load.bodies
            ]
        )
        missing = load.resultants - [self._reaction(unit, load, still.u) for unit in load.bodies]
        by = np.linalg.solve(reactions, missing) if len(moved) else missing
        u = still.u + sum(
            (share * one.u for share, one in zip(by, moved, strict=True)), np.zeros(still.u.shape)
        )
        every = [still, *moved]
        return VoxelSolution(
            u, sum(one.iterations for one in every), max(one.residual for one in every), True
        )

    def _reaction(self, motion: PartLoad, load: PartLoad, u: Array) -> float:
        """Work of what holds the part under a load, at displacements u (ny + 1, nx + 1, 2), by a motion of a body."""
        flat, padded, force = u.reshape(-1, 2), np.zeros(self.shape), np.zeros(self.shape)
        padded[self._inner] = self._on_grid(flat)
        voxel_stencil.nodal_forces(self.stencil, padded, force)
        held = self.E * np.moveaxis(force[self._inner], 0, 2).reshape(-1, 2) - load.force - load.pulls
        work = float((held * motion.value).sum())
        for (nodes, share, stiffness, wanted), (*_, way) in zip(load.springs, motion.springs, strict=True):
            work += float((stiffness * (wanted - np.einsum("kn,kni->ki", share, flat[nodes])) * way).sum())
        return work

    def _conjugate_gradients(self, r: Array, tol: float, limit: int) -> tuple[Array, int, float]:
        """What takes a residual away, the number of iterations, and the norm of what is left."""
        u, p, Ap = (np.zeros(self.shape) for _ in range(3))
        residual, iterations, previous = float(np.linalg.norm(r)), 0, np.inf
        while residual > tol and iterations < limit:
            z = self._multigrid.precondition(r)[0] * self._free
            product = float(np.vdot(r, z))
            p = z + product / previous * p
            self._multigrid.share_work(u)
            voxel_stencil.nodal_forces(self.stencil, p, Ap)
            Ap *= self._free
            step = product / float(np.vdot(p, Ap))
            u += step * p
            r = self._balanced(r - step * Ap)
            residual, iterations, previous = float(np.linalg.norm(r)), iterations + 1, product
            if residual > max(tol, SLOW.get(iterations, np.inf)):
                self._multigrid.strengthen()
                previous = np.inf
            if residual > tol and iterations == PATIENCE:
                check_held(self.stiffness)
        return u, iterations, residual

    def _balanced(self, r: Array) -> Array:
        """Forces without what moves the part as a whole where nothing holds it."""
        if len(self._rigid):
            spread = self._mass * self._rigid
            work = np.einsum("krij,lrij->kl", self._rigid, spread)
            r = r - np.tensordot(np.linalg.solve(work, np.einsum("krij,rij->k", self._rigid, r)), spread, 1)
        return r

    def _reference(self, load: PartLoad) -> float:
        """Norm of a load's nodal forces over Young's modulus, or of those by which it would stretch a rectangle."""
        grid = self.grid
        moved = np.concatenate([np.zeros((1, 2)), *(wanted for *_, wanted in load.springs)])
        strain = float(np.ptp(moved, axis=0).max()) / (2 * grid.reach)
        edges = 2 * (grid.ny * grid.hy) ** 2 / grid.ny + 2 * (grid.nx * grid.hx) ** 2 / grid.nx
        # a load of zero has nothing to be relative to, and no residual either
        return math.hypot(float(np.linalg.norm(load.force)) / self.E, strain * math.sqrt(edges)) or 1.0
