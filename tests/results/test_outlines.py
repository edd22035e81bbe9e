"""Outlines of meshes: nodes lie on them, arcs and lines come out as such, corners where the part has them."""

import numpy as np
import pytest

from slmm.part.outline import Outline
from slmm.part.shapes import circle, polygon
from slmm.results.field import DisplacementField
from slmm.results.outlines import mesh_outlines
from slmm.results.results import read_displacements
from tests.solved_plates import ring, triangles, with_middles


def outlines(points, cells):
    return mesh_outlines(DisplacementField(points, cells, np.zeros_like(points)))


@pytest.mark.parametrize("kind", ["triangle", "quad", "quad8", "quad8, straight sides"])
def test_a_circle_of_few_nodes_is_a_circle(kind):
    """Twelve elements around: nodes lie on the circle, and the curve between them too."""
    points, quads = ring(12, 3)
    cells = {"quad": quads}
    if kind == "triangle":
        cells = {"triangle": triangles(quads)}
    elif kind != "quad":
        points, nodes = with_middles(points, quads, 2.0 if kind == "quad8" else None)
        cells = {"quad8": nodes}
    hole, outer = outlines(points, cells)
    assert outer.is_outer and not hole.is_outer
    at = hole.outline.points(np.linspace(0.0, hole.outline.length, 200))
    assert np.abs(np.hypot(*(at - 10.0).T) - 2.0).max() < 2e-6
    assert not len(hole.outline.corners)
    assert len(outer.outline.corners) == 4 and outer.outline.length == pytest.approx(80.0, rel=1e-12)
    # the material on the right of all outlines
    inwards = hole.outline.points(0.0) + 0.1 * hole.outline.normals(0.0)
    assert np.hypot(*(inwards.ravel() - 10.0)) > 2.0
    middle = 0.5 * outer.outline.length / 4
    assert np.abs(outer.outline.points(middle) + outer.outline.normals(middle) - 10.0).max() < 10.0


def fan(around):
    """Triangles between the points (n, 2) of an outline that is seen whole from its middle, and that middle."""
    n = len(around)
    points = np.vstack([around, around.mean(axis=0)])
    return points, {"triangle": np.array([[k, (k + 1) % n, n] for k in range(n)])}


def test_a_fillet_goes_over_into_its_sides_without_a_corner():
    """A square with round corners, four nodes on each arc: the sides stay straight, the arcs keep their radius."""
    exact = Outline.of_pieces(polygon([[0, 0], [10, 0], [10, 10], [0, 10]], 2.0))
    angle = np.radians(np.arange(0, 91, 22.5))
    arc, side = 8.0 + 2.0 * np.exp(1j * angle), np.array([1.0, 2.0, 3.0]) * 1.5
    quarter = np.concatenate([arc + 8.0j, 8.0 - side + 10.0j]) - (5.0 + 5.0j)
    z = np.concatenate([quarter * 1j**k for k in range(4)]) + (5.0 + 5.0j)
    (outer,) = outlines(*fan(np.column_stack([z.real, z.imag])))
    assert not len(outer.outline.corners)
    s = np.linspace(0.0, outer.outline.length, 400)
    at = outer.outline.points(s)
    away = np.linalg.norm(exact.points(exact.project(at)) - at, axis=1)
    # a spline through a jump of curvature: 1e-4 of the radius
    assert away.max() < 2e-4
    assert outer.outline.length == pytest.approx(exact.length, rel=1e-5)


@pytest.mark.parametrize("nodes", [1, 2, 7])
def test_corners_are_where_sides_meet(nodes):
    """A square of so many elements on each side."""
    t = np.arange(nodes)[:, None] / nodes
    corners = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], dtype=float)
    sides = [a + t * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    (outer,) = outlines(*fan(np.concatenate(sides)))
    assert np.degrees(outer.outline.corner_angles).round(9).tolist() == [270.0] * 4


def test_a_flat_corner_is_seen_between_straight_sides():
    """A turn of 20 degrees, as of a V-shaped edge, with four nodes on each side."""
    line = np.concatenate([np.linspace((0, 0), (5, 5 * np.tan(np.radians(10))), 5)[:-1],
                           np.linspace((5, 5 * np.tan(np.radians(10))), (10, 0), 5)])  # fmt: skip
    (outer,) = outlines(*fan(np.concatenate([line, [[10.0, -8.0], [5.0, -8.0], [0.0, -8.0]]])))
    corner = outer.outline.points(outer.outline.corners)
    assert np.linalg.norm(corner - (5, 5 * np.tan(np.radians(10))), axis=1).min() < 1e-9


def test_what_is_no_part_is_refused():
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    apart = np.concatenate([square, square + 3.0])
    with pytest.raises(ValueError, match="2 outer edges"):
        outlines(apart, {"quad": np.array([[0, 1, 2, 3], [4, 5, 6, 7]])})
    # two elements with a slit between them, that hang together at its end
    slit = np.array(
        [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [0, 0], [0, -1], [1, -1], [2, -1]], dtype=float
    )
    cells = {"quad": np.array([[0, 1, 4, 3], [1, 2, 5, 4], [7, 8, 1, 6], [8, 9, 2, 1]])}
    with pytest.raises(ValueError, match="tip of a crack"):
        outlines(slit, cells)


def test_tied_parts_of_calculix_are_one():
    """Two squares with nodes of their own where they meet, that move as one."""
    (outer,) = mesh_outlines(read_displacements("tests/data/two_blocks.frd"))
    assert outer.outline.length == pytest.approx(60.0, rel=1e-9)
    assert len(outer.outline.corners) == 4


def test_circles_stay_where_they_are_after_a_turn():
    """Turned nodes give the turned curve."""
    at = circle((0, 0), 3.0)[::40]
    c, s = np.cos(0.3), np.sin(0.3)
    turn = np.array([[c, -s], [s, c]])
    (one,), (other,) = outlines(*fan(at)), outlines(*fan(at @ turn.T))
    s = np.linspace(0.0, one.outline.length, 50)
    assert np.abs(one.outline.points(s) @ turn.T - other.outline.points(s)).max() < 1e-9
