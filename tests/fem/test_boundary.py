"""The boundary of a notched plate: curves that meet exactly, keep the body on their left, and have the nodes wanted."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from slmm.fem.boundary import (
    boundary_pieces,
    boundary_segments,
    crack_nodes,
    path_nodes,
    spaced,
)
from slmm.fem.element_size import ElementSize, SizePolicy, along_path, follow_outline
from slmm.part import shapes
from slmm.part.outline import Outline
from slmm.part.part import Part

WIDTH, HEIGHT = 100.0, 80.0


def hole(x, y, radius):
    return Outline.through(shapes.circle((x, y), radius))


CASES = {
    "plate": [],
    "hole": [hole(50, 40, 20)],
    "two holes": [hole(30, 40, 12), hole(70, 40, 15)],
    "edge notch": [hole(0, 30, 25)],
    "notches in two corners": [hole(0, 0, 30), hole(100, 80, 30)],
    "holes that overlap": [hole(40, 40, 15), hole(60, 45, 15)],
    "notch and hole": [hole(100, 40, 12), Outline.through(shapes.ellipse((40, 40), (20, 5), 30.0))],
    "triangle": [Outline.of_pieces(shapes.polygon([[30, 20], [70, 30], [45, 60]]))],
}


def boundary(outlines, mouths=(), largest=5.0, angle=0.12):
    """Rings, nodes (n, 2) and segments (n, 2)."""
    body = Part.plate(WIDTH, HEIGHT, outlines).body
    rings = boundary_pieces(body, outlines, np.reshape(mouths, (-1, 2)))
    size = ElementSize(largest)
    for outline in outlines:
        follow_outline(size, outline, SizePolicy(turn=angle), body)
    parameters = [spaced(piece, outlines, size) for ring in rings for piece in ring]
    return rings, *boundary_segments(rings, parameters, outlines)[:2]


def area(points, segments):
    a, b = points[segments].swapaxes(0, 1)
    return 0.5 * np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


@pytest.mark.parametrize("name", CASES)
def test_each_piece_begins_where_the_one_before_ends(name):
    outlines = CASES[name]
    rings, points, segments = boundary(outlines)
    for ring in rings:
        for piece, following in zip(ring, ring[1:] + ring[:1], strict=True):
            ends = piece.points(piece.s[[0, -1]], outlines)
            assert ends[0] == pytest.approx(piece.start, abs=1e-9)
            assert ends[1] == pytest.approx(following.start, abs=1e-9)
    # every node ends one segment and begins another
    assert np.array_equal(np.sort(segments[:, 0]), np.arange(len(points)))
    assert np.array_equal(np.sort(segments[:, 1]), np.arange(len(points)))


@pytest.mark.parametrize("name", CASES)
def test_the_body_lies_on_the_left_and_has_its_true_area(name):
    outlines = CASES[name]
    true = shapely.box(0, 0, WIDTH, HEIGHT).difference(
        shapely.union_all([shapely.Polygon(outline.polygon(20000)) for outline in outlines])
    )
    errors = []
    for angle in (0.2, 0.1):
        _, points, segments = boundary(outlines, angle=angle)
        errors.append(area(points, segments) / true.area - 1)
    # chords of a hole leave material of the order of the square of their length
    assert -1e-9 < errors[1] < 0.6 * errors[0] + 1e-9
    assert errors[0] < 0.2**2


def test_a_notch_meets_the_plates_edge_where_the_circle_does():
    _, points, _ = boundary([hole(0, 30, 25)])
    for y in (5.0, 55.0):
        assert np.linalg.norm(points - [0.0, y], axis=1).min() < 1e-6
    # exactly on the edge: there a load looks for its nodes
    assert np.sum(points[:, 0] == 0.0) >= 4
    inside = (points[:, 0] > 0) & (points[:, 0] < 50) & (points[:, 1] > 0) & (points[:, 1] < HEIGHT)
    assert np.linalg.norm(points[inside] - [0, 30], axis=1) == pytest.approx(25.0, abs=1e-6)


def test_outlines_that_overlap_meet_where_the_circles_do():
    _, points, _ = boundary([hole(40, 40, 15), hole(60, 40, 15)])
    for y in (40 - np.sqrt(125), 40 + np.sqrt(125)):
        assert np.linalg.norm(points - [50.0, y], axis=1).min() < 1e-6


@given(angle=st.floats(0.0, 6.28), depth=st.floats(1.0, 79.0))
def test_mouths_are_nodes(angle, depth):
    outline = CASES["hole"][0]
    on_hole = outline.points(outline.length * angle / (2 * np.pi))
    mouths = [on_hole, (0.0, depth), (WIDTH, 80 - depth)]
    _, points, _ = boundary([outline], mouths)
    for mouth in mouths:
        assert np.linalg.norm(points - mouth, axis=1).min() < 1e-9


def test_corners_are_nodes():
    corners = [[30, 20], [70, 30], [45, 60], [0, 0], [WIDTH, 0], [0, HEIGHT], [WIDTH, HEIGHT]]
    _, points, _ = boundary(CASES["triangle"])
    for corner in corners:
        assert np.linalg.norm(points - corner, axis=1).min() < 1e-9


def test_a_small_hole_is_never_one_chord():
    rings, points, _ = boundary([hole(50, 40, 0.01)], largest=20.0, angle=3.0)
    assert len(rings) == 2
    assert np.sum(np.linalg.norm(points - [50, 40], axis=1) < 0.011) >= 8


@given(
    prescribed=st.lists(st.floats(0.01, 5.0), min_size=1, max_size=4),
    places=st.lists(st.floats(0.0, 50.0), min_size=4, max_size=4),
)
def test_nodes_are_as_far_apart_as_the_sizes_there(prescribed, places):
    size = ElementSize(5.0)
    at = np.array(places[: len(prescribed)])
    size.prescribe(np.column_stack([at, np.zeros_like(at)]), np.array(prescribed))
    crack = np.array([[0.0, 0.0], [30.0, 0.0], [50.0, 0.0]])
    nodes = crack_nodes(crack, size)
    for point in crack:
        assert np.any(np.all(nodes == point, axis=1))
    step = np.diff(nodes[:, 0])
    assert np.all(step > 0)
    largest = np.max([size(nodes[:-1]), size(nodes[1:])], axis=0)
    assert np.all(step < 1.2 * largest)
    # no more than needed: the nodes are rounded up to a whole number on either side of the kink
    x = np.linspace(0, 50, 20001)
    needed = np.trapezoid(1 / size(np.column_stack([x, np.zeros_like(x)])), x)
    assert len(step) <= 1.05 * needed + 2


def test_a_path_keeps_its_nodes_and_gets_more_where_its_surroundings_are_finer():
    path = np.column_stack(
        [50 + np.concatenate([np.linspace(0, 1, 5)[:-1], 1.2 ** np.arange(12)]), np.full(16, 40)]
    )
    size = ElementSize(10.0)
    size.prescribe(path, along_path(path))
    assert np.array_equal(path_nodes(path, size), path)
    size.prescribe(path[:1], np.array([0.01]))
    nodes = path_nodes(path, size)
    assert np.isin(path[:, 0], nodes[:, 0]).all() and np.all(nodes[:, 1] == 40)
    step = np.diff(nodes[:, 0])
    assert step[0] < 0.015
    # the mesher follows no sudden change
    assert np.max(step[1:] / step[:-1]) < 1.5 and np.max(step[:-1] / step[1:]) < 1.5


def test_an_outline_that_runs_clockwise_is_refused():
    outline = hole(0, 30, 25)
    # the same curve backwards: powers of (length - s) in place of s, piece by piece
    step = np.diff(outline.breaks)
    c3, c2, c1, c0 = outline.coefficients
    h = step[:, None]
    flipped = np.stack(
        [-c3, 3 * c3 * h + c2, -(3 * c3 * h**2 + 2 * c2 * h + c1), c3 * h**3 + c2 * h**2 + c1 * h + c0]
    )[:, ::-1]
    backwards = Outline(np.concatenate([[0.0], np.cumsum(step[::-1])]), flipped)
    assert backwards.points(1.0) == pytest.approx(outline.points(-1.0))
    with pytest.raises(ValueError, match="outline 0 runs clockwise"):
        boundary([backwards])


def test_a_crack_keeps_the_order_of_its_points():
    size = ElementSize(1.0)
    crack = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [7.0, 7.0]])
    nodes = crack_nodes(crack, size)
    where = [int(np.flatnonzero(np.all(nodes == point, axis=1))[0]) for point in crack]
    assert where == sorted(where) and where[0] == 0 and where[-1] == len(nodes) - 1
    for i, j in pairwise(where):
        a, b = nodes[i], nodes[j]
        off = np.abs((nodes[i : j + 1] - a) @ [-(b - a)[1], (b - a)[0]])
        assert off.max() < 1e-9
