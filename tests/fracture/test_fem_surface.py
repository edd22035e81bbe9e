"""Closed curves around a part by the way along them."""

import numpy as np
import pytest
import shapely

from slmm.fem.mesh import plate_mesh
from slmm.fracture.fem_surface import rings
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle

HOLES = [Outline.through(circle((x, y), r)) for x, y, r in ((12.0, 20.0, 4.0), (40.0, 30.0, 6.0))]
#: a hole inside, and one that cuts the right edge
PLATE = Part.plate(40.0, 60.0, HOLES)
DISK = Part.within(Outline.through(circle((0.0, 0.0), 20.0)), HOLES[:0])


@pytest.mark.parametrize("part", [PLATE, DISK])
def test_places_lie_on_the_boundary_and_point_into_the_body(part):
    curves = rings(part)
    assert sum(curve.length for curve in curves) == pytest.approx(part.body.length, rel=1e-5)
    for curve in curves:
        assert curve.at(np.array([curve.length + 1.0])).points == pytest.approx(curve.at(np.ones(1)).points)
        # the middles of short stretches, none of them at a corner
        where = curve.at((np.arange(207) + 0.5) * curve.length / 207)
        off = shapely.distance(shapely.points(where.points), part.body.boundary)
        assert off.max() < 1e-4
        inside = where.points + 0.01 * where.inward
        assert shapely.contains_xy(part.body, *inside.T).all()


def test_holes_are_told_from_straight_edges():
    outer, inner = sorted(rings(PLATE), key=lambda curve: -curve.length)
    way = np.linspace(0.0, outer.length, 400, endpoint=False)
    where = outer.at(way)
    on_circle = np.abs(np.hypot(*(where.points - [40.0, 30.0]).T) - 6.0) < 1e-6
    assert (where.hole[on_circle] == 1).all() and (where.hole[~on_circle] == -1).all()
    assert set(inner.at(way % inner.length).hole.tolist()) == {0}


@pytest.mark.parametrize("part", [PLATE, DISK])
def test_all_vertices_of_a_mesh_on_the_boundary_are_among_the_places(part):
    pytest.importorskip("netgen")
    mesh = plate_mesh(part)
    near = shapely.dwithin(shapely.points(mesh.vertices), part.body.boundary, 1e-3)
    on_curves = np.concatenate([curve.at(curve.nodes(mesh)).points for curve in rings(part)])
    assert len(on_curves) == 2 * near.sum()  # and one between any two of them
    away = np.linalg.norm(mesh.vertices[near][:, None] - on_curves, axis=-1).min(axis=1)
    assert away.max() < 1e-8
