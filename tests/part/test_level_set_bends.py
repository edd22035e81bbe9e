"""Outlines whose bends are sharper than the samples that a contour is traced on: beside saddles near the threshold."""

from dataclasses import replace

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.part.level_set import IslandError, LevelSet
from slmm.scene.scene import Scene

CENTRE, SPACING = (40.0, 40.0), 10.0
#: two holes that meet at a corner; the saddle between them lies in the middle
TWO = LevelSet(np.eye(2), CENTRE, SPACING)
#: a ring that is closed by four such saddles, and has material in it
RING = LevelSet(np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]]), CENTRE, SPACING)


def beside(level_set, by):
    """With the threshold so far above the saddle that is nearest to it."""
    _, values = level_set.saddles()
    return replace(level_set, threshold=float(values[0]) + by)


@pytest.mark.parametrize("by", [-1e-2, -1e-4, -1e-6, 1e-6, 1e-4, 1e-2])
def test_outlines_lie_on_the_contour_and_bend_as_it_does_at_the_saddle(by):
    level_set = beside(TWO, by)
    outlines = level_set.outlines()
    assert len(outlines) == (1 if by < 0 else 2)
    for outline in outlines:
        points = outline.points(np.linspace(0.0, outline.length, 20_001))
        slope = np.linalg.norm(level_set._slopes((points - CENTRE) / SPACING), axis=1) / SPACING
        off = np.abs(level_set(points) - level_set.threshold) / slope
        assert off.max() < 1e-3 * SPACING
    # at a saddle the contour is a hyperbola: its smallest radius follows from the second derivatives alone
    xx, yy, xy = level_set._second(np.zeros((1, 2)))
    along, across = np.linalg.eigvalsh([[xx[0], xy[0]], [xy[0], yy[0]]])
    rises, falls = (across, -along) if by > 0 else (-along, across)
    radius = np.sqrt(2 * abs(by) * rises) / falls * SPACING
    sharpest = min(1 / np.abs(outline.curvatures(outline.breaks)).max() for outline in outlines)
    if abs(by) <= 1e-4:
        assert sharpest == pytest.approx(radius, rel=0.02)


@pytest.mark.parametrize("by", [-1e-3, -1e-5])
def test_a_ring_that_is_closed_by_saddles_has_an_island(by):
    assert len(beside(RING, -by).outlines()) == 4
    with pytest.raises(IslandError, match=r"island of material near \((39.9\d|40), (39.9\d|40)\)"):
        beside(RING, by).outlines()


def test_stress_intensities_beside_so_sharp_a_bend_do_not_hang_on_the_number_of_points():
    level_set = beside(TWO, -1e-4)
    scene = Scene.from_dict(
        {
            "plate": {"width": 80.0, "height": 80.0},
            "holes": [
                {
                    "shape": "pattern",
                    "values": TWO.values.tolist(),
                    "center": list(CENTRE),
                    "frame": 30.0,
                    "threshold": level_set.threshold,
                }
            ],
            "cracks": [{"points": [[0.0, 40.0], [20.0, 40.0]]}],
            "material": {"name": "PMMA"},
            "load": {"displacement": 0.1},
        }
    )
    K = [
        BoundaryModel(scene.part, scene.material, scene.loading, p, p).stress_intensities()[0]
        for p in (8, 12)
    ]
    assert K[0] == pytest.approx(K[1], abs=1e-4 * np.abs(K[1]).max())
