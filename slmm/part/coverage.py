"""How much of every voxel the holes cover: exact areas, accumulated with a sign as font rasterisers do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray

Polygon = NDArray[np.float64]


def area_fraction(
    polygons: Sequence[Polygon], width: float, height: float, nx: int, ny: int
) -> NDArray[np.float64]:
    """Fraction of each voxel's area that lies inside the polygons.

    Parameters
    ----------
    polygons : sequence of (n, 2) arrays
        Corner points of closed, simple polygons, mm, in either sense of rotation. They may overlap (what two
        of them cover counts once) and may leave the plate.
    width, height : float
        Plate, mm; its lower left corner is the origin.
    nx, ny : int
        Number of voxels along x and y.

    Returns
    -------
    (ny, nx) array
        Covered fraction, 0 to 1; row 0 lies at y = 0. Exact to rounding.

    Raises
    ------
    ValueError
        When a polygon has fewer than three points, points that are not finite, or crosses itself.

    Examples
    --------
    >>> area_fraction([np.array([[0.5, 0.0], [2.0, 0.0], [2.0, 1.0], [0.5, 1.0]])], 2.0, 2.0, 2, 2)
    array([[0.5, 1. ],
           [0. , 0. ]])
    """
    if nx < 1 or ny < 1:
        raise ValueError(f"{nx} x {ny} voxels: at least one along each side is needed")
    if not (np.isfinite(width) and width > 0 and np.isfinite(height) and height > 0):
        raise ValueError(f"plate of {width} x {height} mm: both sides must be positive")
    # one column more than the grid: what enters there lies to the right of the plate and is dropped
    area = np.zeros((ny, nx + 1))
    scale = np.array([nx / width, ny / height])
    for ring in _disjoint_rings(polygons):
        _accumulate(ring * scale, area)
    covered: NDArray[np.float64] = np.cumsum(area, axis=1)[:, :nx]
    return np.clip(covered, 0.0, 1.0, out=covered)


def _disjoint_rings(polygons: Sequence[Polygon]) -> list[Polygon]:
    """Rings with the covered side on their left; overlapping polygons are united first."""
    shapes = []
    for number, points in enumerate(polygons):
        points = np.asarray(points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
            raise ValueError(f"polygon {number} has shape {points.shape}: (n, 2) with n >= 3 is needed")
        if not np.isfinite(points).all():
            raise ValueError(f"polygon {number} has a point that is not finite")
        shape = shapely.Polygon(points)
        if not shape.is_valid:
            raise ValueError(
                f"polygon {number} is not simple ({shapely.is_valid_reason(shape)}): remove the crossing"
            )
        shapes.append(shape)
    union = shapely.union_all(shapes) if len(shapes) > 1 else shapely.MultiPolygon(shapes)
    rings = []
    for part in shapely.get_parts(union):
        if part.geom_type == "Polygon":
            part = shapely.orient_polygons(part)  # shell counter-clockwise, its gaps clockwise
            rings += [np.asarray(ring.coords) for ring in (part.exterior, *part.interiors)]
    return rings


@njit(cache=True)
def _accumulate(ring: Polygon, area: NDArray[np.float64]) -> None:
    """Add the closed ``ring`` (in voxel units) so that the running sum along x is the covered area."""
    rows, columns = area.shape[0], area.shape[1] - 1
    for k in range(len(ring) - 1):
        x0, y0 = ring[k]
        x1, y1 = ring[k + 1]
        if y0 == y1:
            continue
        # going down with the covered side on the left means: everything to the right is covered
        sign = 1.0
        if y0 < y1:
            sign = -1.0
        else:
            x0, y0, x1, y1 = x1, y1, x0, y0
        slope = (x1 - x0) / (y1 - y0)
        bottom, top = max(y0, 0.0), min(y1, float(rows))
        if bottom >= top:
            continue
        for row in range(int(bottom), min(int(np.ceil(top)), rows)):
            low, high = max(bottom, float(row)), min(top, row + 1.0)
            if high > low:
                xa, xb = x0 + slope * (low - y0), x0 + slope * (high - y0)
                _accumulate_in_row(area[row], columns, xa, xb, sign * (high - low))


@njit(cache=True)
def _accumulate_in_row(row: NDArray[np.float64], columns: int, xa: float, xb: float, cover: float) -> None:
    """Add a piece of an edge, from ``xa`` to ``xb`` within one row of voxels and ``cover`` high."""
    left, right = min(xa, xb), max(xa, xb)
    if right > left:
        # what is left of the plate covers all of the row, what is right of it nothing
        row[0] += cover * max(0.0, min(right, 0.0) - left) / (right - left)
    elif left < 0.0:
        row[0] += cover
    first = max(left, 0.0)
    last = min(right, float(columns))
    if left == right:
        if 0.0 <= left < columns:
            column = int(left)
            row[column] += cover * (column + 1.0 - left)
            row[column + 1] += cover * (left - column)
        return
    for column in range(int(first), min(int(np.ceil(last)), columns)):
        a, b = max(first, float(column)), min(last, column + 1.0)
        if b > a:
            piece = cover * (b - a) / (right - left)
            covered = column + 1.0 - 0.5 * (a + b)
            row[column] += piece * covered
            row[column + 1] += piece * (1.0 - covered)
