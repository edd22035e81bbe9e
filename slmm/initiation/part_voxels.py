"""The uncracked part on voxels, under conditions on any stretch of any outline: displacement and stress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slmm.initiation.local_model import STIFFER_VOID, displacements_on
from slmm.initiation.raster import SMALLEST_SIDE, grid_size
from slmm.initiation.uncracked import Raster
from slmm.voxels.grid import VoxelGrid
from slmm.voxels.part_load import part_load
from slmm.voxels.part_model import PartVoxels
from slmm.voxels.patch_stress import SURFACE_POINTS, PatchStress, surface_of

Array = NDArray[np.float64]

#: what voxels of twice the size change may be less than the error of these by this factor: it falls with the size, not
#: always evenly; with cracks, which act longer or shorter by half a voxel, more slowly (chosen on
#: validation/part_models.py)
COVERED, COVERED_CRACKED = 2.0, 4.0


@dataclass(frozen=True)
class PartField:
    """Displacements of a part on voxels: an `uncracked.UncrackedField` that has its stress, too.

    Attributes
    ----------
    grid : VoxelGrid
    u : ndarray, shape (ny + 1, nx + 1, 2)
        Displacements of the nodes, mm.
    density : ndarray, shape (ny, nx)
        The material's share of each voxel.
    patches : PatchStress
    covered : float
        The estimated error over what the coarser grid changes.
    iterations : int
        Of the solver.
    coarser : PartField or None
        With voxels of twice the size, for estimates of the error.
    """

    grid: VoxelGrid
    u: Array
    density: Array
    patches: PatchStress
    covered: float
    iterations: int
    coarser: PartField | None = None

    @property
    def raster(self) -> Raster:
        """Where the material is."""
        return Raster(self.density, self.grid.hx, self.grid.hy, self.grid.origin)

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {
            "local_model": "voxels",
            "voxels": self.grid.nx * self.grid.ny,
            "voxel_size": f"{self.grid.hx:.6g} x {self.grid.hy:.6g} mm",
            "solver_iterations": self.iterations,
        }

    def displacement(self, points: Array) -> Array:
        """Displacements (k, 2) at points (k, 2), mm."""
        return displacements_on(self.u, self.grid.hx, self.grid.hy, points - self.grid.origin)

    def resolution(self, points: Array) -> Array:
        """Size (k,) of the voxels at points (k, 2), mm."""
        return np.full(len(points), self.grid.size)

    def element_size(self, points: Array) -> Array:
        """Half the radius (k,) of the patches that the stress at points (k, 2) comes from, mm."""
        return np.full(len(points), 0.5 * self.patches.radius)

    def stress(self, points: Array) -> tuple[Array, Array]:
        """Stress xx, yy, xy (k, 3) at points (k, 2), and an estimate of its error (k,), MPa.

        NaN where there is too little material around, or too little for the coarser grid.
        """
        assert self.coarser is not None
        stress, coarse = self.patches.stress(points), self.coarser.patches.stress(points)
        return stress, self.covered * np.abs(stress - coarse).max(axis=1)


def solve_part(scene: Any, voxels: int, void: float) -> PartField:
    """Solve a scene on about so many nearly square voxels, and on a quarter of them.

    The grid covers the box around the part; outside of the part there is void, as in its holes. A crack is a slot, as
    wide as the voxels that it goes through.

    Parameters
    ----------
    scene : Scene
        With ``part``, ``material`` and ``loading``.
    voxels : int
    void : float
        Stiffness of the void as a share of the material's.

    Raises
    ------
    ValueError
        When ``voxels`` is too small, or the part is free to move and its forces do not balance.
    NotConvergedError, NotHeldError
        When the solver fails; see slmm.voxels.model.
    """
    rough = _solve(scene, max(voxels // 4, SMALLEST_SIDE**2), min(STIFFER_VOID * void, 1.0), None)
    return _solve(scene, voxels, void, rough)


def _solve(scene: Any, voxels: int, void: float, coarser: PartField | None) -> PartField:
    part, (E, nu) = scene.part, scene.material.plane_stress_equivalent
    (left, bottom), (right, top) = part.box.tolist()
    nx, ny = grid_size(right - left, top - bottom, voxels)
    grid = VoxelGrid((left, bottom), (right - left) / nx, (top - bottom) / ny, nx, ny)
    density = grid.density(part)
    load = part_load(part, scene.loading, grid, E)
    solution = PartVoxels(grid, void + (1 - void) * density, E, nu, load).solve_bodies(load)
    surface = surface_of(part, scene.loading, grid.size / SURFACE_POINTS)
    patches = PatchStress(grid, solution.u, density, surface, E, nu)
    covered = COVERED_CRACKED if part.cracks else COVERED
    return PartField(grid, solution.u, density, patches, covered, solution.iterations, coarser)
