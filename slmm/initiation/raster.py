"""Pieces of a part's box that tell material from notches: by their number, or as shares of the material."""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np
import shapely
from numpy.typing import NDArray

from slmm.initiation.uncracked import Raster
from slmm.part.coverage import area_fraction
from slmm.part.part import Part

SMALLEST_SIDE = 16  # pieces along each side of the box, at least; chosen
POINTS_PER_PIECE = 8  # of an outline: its polygon is then off the curve by far less than a piece; chosen
#: pieces of a plate that tell material from notches where the local model has no voxels; chosen
RASTER_PIECES = 400**2


class Polygonal(Protocol):
    """An outline, by polygons of so many points."""

    def polygon(self, n: int) -> NDArray[np.float64]:
        """Points (n, 2)."""


def rasterised(scene: Any) -> Raster:
    """The material's share of pieces of a scene's plate."""
    if scene.plate is None:
        return _rasterised(scene.part)
    width, height = scene.plate.width, scene.plate.height
    nx, ny = grid_size(width, height, RASTER_PIECES)
    hx, hy = width / nx, height / ny
    polygons = [fine_polygon(outline, min(hx, hy)) for outline in scene.outlines]
    return Raster(1 - area_fraction(polygons, width, height, nx, ny), hx, hy)


def _rasterised(part: Part) -> Raster:
    """The material's share of pieces of the box around a part."""
    (left, bottom), (right, top) = part.box.tolist()
    width, height = right - left, top - bottom
    nx, ny = grid_size(width, height, RASTER_PIECES)
    rings = [shapely.get_coordinates(ring) - (left, bottom) for ring in shapely.get_rings(part.body)]
    density = area_fraction(rings[:1], width, height, nx, ny)
    if len(rings) > 1:
        density -= area_fraction(rings[1:], width, height, nx, ny)
    return Raster(np.clip(density, 0.0, 1.0), width / nx, height / ny, (left, bottom))


def grid_size(width: float, height: float, voxels: int) -> tuple[int, int]:
    """Number of nearly square voxels along x and y that together are about ``voxels``.

    Examples
    --------
    >>> grid_size(100.0, 50.0, 20_000)
    (200, 100)
    """
    if voxels < SMALLEST_SIDE**2:
        raise ValueError(f"voxels = {voxels!r}: at least {SMALLEST_SIDE**2} are needed")
    side = math.sqrt(width * height / voxels)
    return max(SMALLEST_SIDE, round(width / side)), max(SMALLEST_SIDE, round(height / side))


def fine_polygon(outline: Polygonal, h: float) -> NDArray[np.float64]:
    """Points (n, 2) of an outline for pieces of a side h, mm."""
    points = outline.polygon(256)
    length = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1).sum()
    n = int(POINTS_PER_PIECE * length / h)
    return points if n <= len(points) else outline.polygon(n)
