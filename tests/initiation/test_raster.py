"""Pieces of a part's box: their number, and the material's share of them."""

import numpy as np
import pytest

from slmm.initiation.raster import grid_size, rasterised
from slmm.scene import gallery


def test_grid_follows_the_plate():
    assert grid_size(100, 100, 10_000) == (100, 100)
    assert grid_size(400, 10, 1000) == (200, 16)
    with pytest.raises(ValueError, match="voxels = 10"):
        grid_size(100, 100, 10)


def test_shares_add_up_to_the_area_of_the_part():
    scene = gallery.circular_hole()
    raster = rasterised(scene)
    area = raster.density.sum() * raster.hx * raster.hy
    assert area == pytest.approx(scene.plate.width * scene.plate.height - np.pi * 20.0**2, rel=1e-6)
    assert raster.density[raster.density.shape[0] // 2, raster.density.shape[1] // 2] == 0.0
