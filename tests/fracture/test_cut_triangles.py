"""Triangles cut along cracks: area, topology, and where the fields of their points are taken."""

from itertools import pairwise

import numpy as np
import pytest

from slmm.fracture.cut_triangles import cut_triangles
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle

HOLE = Outline.through(circle((20.0, 20.0), 6.0))
#: plates and how many holes are left when cracks are open: one with two tips is a hole, one to a hole is none
PARTS = {
    "a plate": (Part.plate(40.0, 40.0), 0),
    "an edge crack": (Part.plate(40.0, 40.0, cracks=[[(0, 20), (15, 21)]]), 0),
    "an internal crack": (Part.plate(40.0, 40.0, cracks=[[(10, 20), (18, 21), (22, 17)]]), 1),
    "a hole": (Part.plate(40.0, 40.0, [HOLE]), 1),
    "a crack to a hole": (Part.plate(40.0, 40.0, [HOLE], [[(0, 18), (16, 18)]]), 0),
    "a crack from a hole": (Part.plate(40.0, 40.0, [HOLE], [[(24, 22), (35, 25)]]), 1),
    "two cracks that meet": (Part.plate(40.0, 40.0, cracks=[[(10, 20), (30, 20)], [(20, 20), (22, 30)]]), 1),
    "two cracks that cross": (Part.plate(40.0, 40.0, cracks=[[(10, 20), (30, 20)], [(20, 10), (21, 30)]]), 1),
}


@pytest.mark.parametrize("name", PARTS)
def test_topology_and_area(name):
    part, holes = PARTS[name]
    mesh = cut_triangles(part, 2.0)
    sides = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    sides, count = np.unique(sides, axis=0, return_counts=True)
    assert count.max() == 2
    assert len(mesh.points) - len(sides) + len(mesh.triangles) == 1 - holes  # Euler
    a, b = (mesh.points[mesh.triangles[:, k]] - mesh.points[mesh.triangles[:, 0]] for k in (1, 2))
    area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert (area > 0).all()
    # chords are 1 % of the size off the outline of the hole at most, which is 38 mm long
    assert area.sum() == pytest.approx(part.body.area, abs=0.02 * 38)


def test_cracks_are_sides_of_triangles_and_nothing_crosses_them():
    part, _ = PARTS["an internal crack"]
    mesh = cut_triangles(part, 2.0)
    line = part.cracks[0].points
    middles = mesh.points[mesh.triangles].mean(axis=1)
    for a, b in pairwise(line):
        normal = np.array([-(b - a)[1], (b - a)[0]])
        for triangle, middle in zip(mesh.triangles, middles, strict=True):
            heights = (mesh.points[triangle] - a) @ normal
            along = (mesh.points[triangle] - a) @ (b - a) / ((b - a) @ (b - a))
            if (along > 0).all() and (along < 1).all():
                assert (heights >= -1e-9).all() or (heights <= 1e-9).all(), middle


def test_fields_are_taken_beside_cracks_on_their_own_side_and_elsewhere_at_the_points():
    part, _ = PARTS["an edge crack"]
    mesh = cut_triangles(part, 2.0)
    moved = np.linalg.norm(mesh.places - mesh.points, axis=1)
    tip = np.linalg.norm(mesh.points - part.cracks[0].points[-1], axis=1) < 1e-9
    on_crack = moved > 0
    assert tip.sum() == 1 and on_crack[tip].all()
    assert moved[on_crack & ~tip].max() < 1e-3
    # each place stands there twice, above and below
    points = mesh.points[on_crack & ~tip]
    assert len(np.unique(points.round(9), axis=0)) * 2 == len(points)
    slope = (mesh.places - mesh.points)[on_crack & ~tip] @ np.array([-1.0, 15.0])
    assert (slope > 0).sum() == (slope < 0).sum()


def test_a_part_of_any_outline_is_cut():
    disk = Outline.through(circle((0.0, 0.0), 20.0))
    part = Part.within(disk, cracks=[[(-20.0, 0.0), (0.0, 0.0)]])
    mesh = cut_triangles(part, 2.0)
    assert (np.linalg.norm(mesh.points - [-20.0, 0.0], axis=1) < part.tolerance).sum() == 2
    assert np.linalg.norm(mesh.points, axis=1).max() < 20.0 + 1e-9


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan")])
def test_sizes_that_are_none_are_refused(size):
    with pytest.raises(ValueError, match="size = "):
        cut_triangles(Part.plate(4.0, 4.0), size)
