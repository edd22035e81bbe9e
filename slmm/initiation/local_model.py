"""The local model: one cheap voxel solve of the whole plate, for the displacements around its notches.

Paper A, section 2.2.2. Each voxel is as stiff as the material's share of its area.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray

from slmm.initiation.raster import Polygonal, fine_polygon, grid_size
from slmm.initiation.uncracked import Raster
from slmm.mechanics.material import Material
from slmm.part.coverage import area_fraction
from slmm.part.edges import material_on_edges, share_of_pieces
from slmm.scene.loading import Loading
from slmm.voxels.model import solve_voxels

#: stiffness of the coarser grid's void over that of the finer one's, so that the estimates show what it does (chosen)
STIFFER_VOID = 3.0


class _Plate(Protocol):
    @property
    def width(self) -> float: ...
    @property
    def height(self) -> float: ...


class _Analysis(Protocol):
    @property
    def void_stiffness(self) -> float: ...


class _Scene(Protocol):
    @property
    def plate(self) -> _Plate | None: ...
    @property
    def outlines(self) -> tuple[Polygonal, ...]: ...
    @property
    def material(self) -> Material: ...
    @property
    def loading(self) -> Loading: ...
    @property
    def analysis(self) -> _Analysis: ...


@dataclass(frozen=True)
class LocalModel:
    """Displacements of the plate on a grid of voxels: an `uncracked.UncrackedField`.

    Attributes
    ----------
    u : (ny + 1, nx + 1, 2) array
        Nodal displacements u_x, u_y, mm; row 0 lies at y = 0. Bilinear in between (``bilinear``).
    hx, hy : float
        Sides of a voxel, mm.
    nx, ny : int
        Number of voxels along x and y.
    density : (ny, nx) array
        The material's share of each voxel, 0 in a hole to 1.
    iterations : int
        Of the solver.
    residual : float
        Relative residual of the solver.
    coarser : LocalModel, optional
        The same with voxels twice as large, for estimates of the error.
    """

    u: NDArray[np.float64]
    hx: float
    hy: float
    nx: int
    ny: int
    density: NDArray[np.float64]
    iterations: int
    residual: float
    coarser: LocalModel | None = None

    def displacement(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacements (n, 2) at points (n, 2), mm."""
        return displacements_on(self.u, self.hx, self.hy, points)

    def resolution(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Size of the voxels at points (n, 2), mm."""
        return np.full(len(points), max(self.hx, self.hy))

    @property
    def raster(self) -> Raster:
        """Where the material is."""
        return Raster(self.density, self.hx, self.hy)

    @property
    def described(self) -> dict[str, object]:
        """What it is, as attributes of a result."""
        return {
            "local_model": "voxels",
            "voxels": self.nx * self.ny,
            "voxel_size": f"{self.hx:.6g} x {self.hy:.6g} mm",
            "solver_iterations": self.iterations,
        }


def solve_local_model(scene: _Scene, voxels: int, tol: float = 1e-8) -> LocalModel:
    """Solve a scene on a grid of about ``voxels`` nearly square voxels.

    Parameters
    ----------
    scene : object with ``plate``, ``outlines``, ``material``, ``loading`` and ``analysis``
        Only the outlines' ``polygon(n)`` and the ``void_stiffness`` of the analysis are used of the latter.
    voxels : int
        Their total number; each side of the plate has at least 16.
    tol : float
        Relative residual of the solver.

    Raises
    ------
    ValueError
        When ``voxels`` or the void's stiffness is out of range.
    NotConvergedError
        When the solver fails; see slmm.voxels.model.
    """
    void = scene.analysis.void_stiffness
    if not 0 < void <= 1:
        raise ValueError(
            f"analysis.void_stiffness = {void!r}: must lie above 0 (1e-9 is safe) and not exceed 1"
        )
    if scene.plate is None:
        raise ValueError(
            "solve_local_model: is for plates under [load]; slmm.initiation.part_voxels.solve_part takes any part"
        )
    width, height = scene.plate.width, scene.plate.height
    nx, ny = grid_size(width, height, voxels)
    hx, hy = width / nx, height / ny
    polygons = [fine_polygon(outline, min(hx, hy)) for outline in scene.outlines]
    density = 1 - area_fraction(polygons, width, height, nx, ny)
    E, nu = scene.material.plane_stress_equivalent
    loaded = None
    if any(condition.is_loaded for condition in scene.loading):
        edges = material_on_edges([shapely.Polygon(polygon) for polygon in polygons], width, height)
        loaded = np.stack([share_of_pieces(stretches, width, nx) for stretches in (edges.bottom, edges.top)])
    solution = solve_voxels(
        void + (1 - void) * density, width, height, nu, scene.loading, E=E, tol=tol, loaded=loaded
    )
    return LocalModel(solution.u, hx, hy, nx, ny, density, solution.iterations, solution.residual)


@njit(cache=True, inline="always", error_model="numpy")
def bilinear(u, hx, hy, x, y):
    """Displacement (u_x, u_y) at x, y (mm); points outside the plate get that of the nearest edge point."""
    columns, rows = u.shape[1] - 1, u.shape[0] - 1
    x_scaled = min(max(x / hx, 0.0), float(columns))
    y_scaled = min(max(y / hy, 0.0), float(rows))
    i = min(int(y_scaled), rows - 1)
    j = min(int(x_scaled), columns - 1)
    s, t = x_scaled - j, y_scaled - i
    a, b, c, d = (1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t
    u_x = a * u[i, j, 0] + b * u[i, j + 1, 0] + c * u[i + 1, j, 0] + d * u[i + 1, j + 1, 0]
    u_y = a * u[i, j, 1] + b * u[i, j + 1, 1] + c * u[i + 1, j, 1] + d * u[i + 1, j + 1, 1]
    return u_x, u_y


def displacements_on(
    u: NDArray[np.float64], hx: float, hy: float, points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Displacements (n, 2) at points (n, 2), mm, of a grid whose lower left corner is the origin, see `bilinear`."""
    return _displacements(u, hx, hy, np.ascontiguousarray(points, dtype=float))


@njit(cache=True)
def _displacements(u, hx, hy, points):
    values = np.empty_like(points)
    for k in range(len(points)):
        values[k, 0], values[k, 1] = bilinear(u, hx, hy, points[k, 0], points[k, 1])
    return values
