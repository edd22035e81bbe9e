"""The grid of voxels over the box of a part, and the share of a point's displacement that each node has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.part.coverage import area_fraction
from slmm.part.crack import TIP
from slmm.part.part import Part

Array = NDArray[np.float64]

#: a crack on a line of the grid goes through the voxels on both sides of it, nearer than this many voxels; round-off
BESIDE = 1e-6


@dataclass(frozen=True)
class VoxelGrid:
    """Equal rectangles over the box of a part.

    Parameters
    ----------
    origin : (float, float)
        Lower left corner, mm.
    hx, hy : float
        Sides of a voxel, mm.
    nx, ny : int
        Number of voxels along x and y.

    Examples
    --------
    >>> grid = VoxelGrid((0.0, 0.0), 1.0, 1.0, 2, 2)
    >>> nodes, share = grid.shares(np.array([[1.25, 0.5]]))
    >>> nodes.tolist(), share.tolist()
    ([[1, 2, 4, 5]], [[0.375, 0.125, 0.375, 0.125]])
    """

    origin: tuple[float, float]
    hx: float
    hy: float
    nx: int
    ny: int

    @property
    def size(self) -> float:
        """Longer side of a voxel, mm."""
        return max(self.hx, self.hy)

    @property
    def middle(self) -> Array:
        """mm."""
        return np.array(self.origin) + 0.5 * np.array([self.nx * self.hx, self.ny * self.hy])

    @property
    def reach(self) -> float:
        """Half of the longer side, mm."""
        return 0.5 * max(self.nx * self.hx, self.ny * self.hy)

    @property
    def nodes(self) -> Array:
        """Points (n, 2) of all nodes, row by row, mm."""
        x, y = (
            start + step * np.arange(n + 1)
            for start, step, n in zip(self.origin, (self.hx, self.hy), (self.nx, self.ny), strict=True)
        )
        return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)

    def cells(self, points: Array) -> tuple[NDArray[np.int64], Array]:
        """Column and row (n, 2) of the voxels that points (n, 2) lie in, and where in it (n, 2), 0 to 1."""
        scaled = (points - self.origin) / (self.hx, self.hy)
        # a point on a line of the grid may be beside it by round-off
        nearest = np.round(scaled)
        scaled = np.where(np.abs(scaled - nearest) < BESIDE, nearest, scaled)
        cell = np.clip(scaled.astype(int), 0, (self.nx - 1, self.ny - 1))
        return cell, scaled - cell

    def shares(self, points: Array) -> tuple[NDArray[np.int64], Array]:
        """Nodes (n, 4) around points (n, 2), and their bilinear shape functions (n, 4) there."""
        (column, row), (s, t) = (values.T for values in self.cells(points))
        first = row * (self.nx + 1) + column
        nodes = first[:, None] + np.array([0, 1, self.nx + 1, self.nx + 2])
        return nodes, np.stack([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t], axis=1)

    def density(self, part: Part) -> Array:
        """The material's share (ny, nx) of each voxel; a crack takes all the voxels that it goes through."""
        width, height = self.nx * self.hx, self.ny * self.hy
        rings = [shapely.get_coordinates(ring) - self.origin for ring in shapely.get_rings(part.body)]
        density = area_fraction(rings[:1], width, height, self.nx, self.ny)
        if len(rings) > 1:
            density = density - area_fraction(rings[1:], width, height, self.nx, self.ny)
        density = np.clip(density, 0.0, 1.0)
        for crack, line in zip(part.cracks, part.crack_lines, strict=True):
            ahead = (line - self.origin) / (self.hx, self.hy)
            slot = shapely.LineString(ahead)
            for end, last, inner in ((crack.start, 0, 1), (crack.end, -1, -2)):
                if end == TIP:
                    along = ahead[last] - ahead[inner]
                    ahead[last] += 2 * along / np.hypot(*along)
            self._cut(density, slot, shapely.LineString(ahead))
        return density

    def _cut(self, density: Array, crack: shapely.LineString, ahead: shapely.LineString) -> None:
        """Take the voxels along a crack out; of that of a tip, the share that the crack covers of its way through it.

        ``ahead`` is the crack that goes on beyond its tips; both in voxels from the grid's corner.
        """
        whole, cut = (line.buffer(BESIDE, cap_style="flat") for line in (ahead, crack))
        shapely.prepare([whole, cut])
        left, bottom, right, top = cut.bounds
        x = np.arange(max(int(left), 0), min(int(right) + 1, self.nx))
        y = np.arange(max(int(bottom), 0), min(int(top) + 1, self.ny))
        column, row = (grid.ravel() for grid in np.meshgrid(x, y))
        hit = cut.intersects(shapely.box(column, row, column + 1, row + 1))
        column, row = column[hit], row[hit]
        boxes = shapely.box(column, row, column + 1, row + 1)
        share = shapely.area(cut.intersection(boxes)) / shapely.area(whole.intersection(boxes))
        density[row, column] *= 1 - np.clip(share, 0.0, 1.0)
