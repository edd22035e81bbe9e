"""Element sizes: small enough where outlines bend, gaps are narrow and stresses singular, and no law broken between."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from slmm.fem.element_size import (
    ACROSS_GAP,
    SIZE_GROWTH,
    ElementSize,
    SizePolicy,
    all_sizes,
    along_path,
)
from slmm.fem.mesh import plate_mesh
from slmm.part import shapes
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.scene import gallery

pytest.importorskip("netgen")

COORDINATES = st.floats(-100.0, 100.0, width=32)
POINTS = arrays(float, (6, 2), elements=COORDINATES)
SIZES = arrays(float, 6, elements=st.floats(0.01, 20.0))


def turns(outline, s):
    """How far an outline turns between arc lengths s (n, 2), rad, by what it turns up to and from the middle."""
    middle = s.mean(axis=1)
    # a corner has two tangents
    inset = 1e-8 * outline.length * np.sign(s[:, 1] - s[:, 0])
    first, last = s[:, 0] + inset, s[:, 1] - inset
    direction = [np.arctan2(*outline.tangents(at % outline.length).T[::-1]) for at in (first, middle, last)]
    half = np.abs((np.diff(direction, axis=0) + np.pi) % (2 * np.pi) - np.pi)
    return half.sum(axis=0)


def edge_lengths(mesh):
    return np.linalg.norm(np.diff(mesh.vertices[mesh.edges], axis=1)[:, 0], axis=1)


@given(sources=POINTS, prescribed=SIZES, points=POINTS)
def test_size_is_the_least_that_any_source_allows(sources, prescribed, points):
    size = ElementSize(10.0)
    size.prescribe(sources, prescribed)
    distance = np.linalg.norm(points[:, None] - sources, axis=-1)
    expected = np.minimum((prescribed + SIZE_GROWTH * distance).min(axis=1), 10.0)
    assert size(points) == pytest.approx(expected)
    assert np.all(size(sources) <= np.minimum(prescribed, 10.0) * (1 + 1e-12))


@given(sources=POINTS, prescribed=SIZES, points=POINTS, others=POINTS)
def test_size_never_grows_faster_than_the_mesher_follows(sources, prescribed, points, others):
    size = ElementSize(10.0)
    size.prescribe(sources, prescribed)
    apart = np.linalg.norm(points - others, axis=1)
    assert np.all(np.abs(size(points) - size(others)) <= SIZE_GROWTH * apart + 1e-9)


@pytest.mark.parametrize("angle_max", [0.06, 0.25])
@pytest.mark.parametrize(
    "name", ["circle", "slender ellipse", "rounded square", "lobes", "root of 0.05 mm", "two notches"]
)
def test_no_edge_turns_more_than_asked_for(name, angle_max):
    width, height = (40.0, 120.0) if name == "root of 0.05 mm" else (100.0, 100.0)
    outlines = {
        "circle": [Outline.through(shapes.circle((50, 50), 20.0))],
        "slender ellipse": [Outline.through(shapes.ellipse((50, 50), (30.0, 1.5), 20.0))],
        "rounded square": [Outline.through(shapes.rectangle((50, 50), (30, 30), 0.5))],
        "lobes": gallery.lobed_notch().outlines,
        "root of 0.05 mm": gallery.v_notch(radius=0.05, opening=30.0).outlines,
        "two notches": [
            Outline.through(shapes.circle((0, 30), 8.0)),
            Outline.through(shapes.ellipse((100, 70), (20.0, 3.0))),
        ],
    }[name]
    mesh = plate_mesh(Part.plate(width, height, outlines), policy=SizePolicy(turn=angle_max))
    for k, outline in enumerate(mesh.outlines):
        turn = turns(outline, mesh.edge_s[mesh.edge_outline == k])
        # an edge grows by 17 % on its own length, and its node may miss a jump of the curvature
        assert turn.max() < 1.25 * angle_max
        assert turn.max() > 0.3 * angle_max  # and it is what decides


def test_a_sharp_root_on_a_long_outline_has_its_share_of_the_elements():
    """The root's arc is shorter than the intervals at which a long outline is looked at first."""
    scene = gallery.v_notch(radius=0.05, opening=30.0)
    (outline,) = scene.outlines
    assert outline.length / 256 > 0.05 * np.radians(150)
    mesh = plate_mesh(Part.plate(40.0, 120.0, scene.outlines), policy=SizePolicy(turn=0.12))
    middle = mesh.edge_midpoints()
    centre = np.array([10.0 - 0.05, 60.0])
    on_root = np.abs(np.linalg.norm(middle - centre, axis=1) - 0.05) < 1e-4
    assert on_root.sum() >= 0.8 * np.radians(150) / 0.12
    assert edge_lengths(mesh)[on_root].max() < 1.25 * 0.12 * 0.05


@pytest.mark.parametrize("gap", [0.02, 0.5, 5.0])
def test_edges_in_a_gap_are_half_as_long_as_it_is_wide(gap):
    outlines = [Outline.through(shapes.circle((50 + side * (10 + gap / 2), 50), 10.0)) for side in (-1, 1)]
    mesh = plate_mesh(Part.plate(100.0, 100.0, outlines))
    # the distance to the other hole at the end of such an edge is up to 10 % larger
    narrow = np.abs(mesh.edge_midpoints() - 50).max(axis=1) < 0.75 * gap
    assert narrow.sum() >= 2 * ACROSS_GAP
    assert edge_lengths(mesh)[narrow].max() < 1.2 * gap * 1.1 / ACROSS_GAP


def test_elements_at_a_crack_tip_and_its_kinks_are_a_thousandth_of_its_length():
    crack = np.array([[0.0, 60.0], [6.0, 60.0], [9.0, 64.0]])
    mesh = plate_mesh(Part.plate(40.0, 120.0, cracks=[crack]))
    line = mesh.vertices[mesh.cracks[0]]
    step = np.linalg.norm(np.diff(line, axis=0), axis=1)
    wanted = SizePolicy().at_tips * 11.0
    kink = int(np.argmin(np.linalg.norm(line - crack[1], axis=1)))
    assert np.allclose(line[kink], crack[1]) and np.allclose(line[-1], crack[2])
    for edge in (step[-1], step[kink - 1], step[kink]):
        assert 0.5 * wanted < edge < 1.3 * wanted
    assert step[0] > 20 * wanted  # the mouth needs none


def test_only_corners_of_the_material_are_singular():
    """A square hole's corners are; those of a square peg of material that sticks into it, and those outside, not."""
    hole = gallery.square_hole().outlines
    mesh = plate_mesh(Part.plate(100.0, 100.0, hole))
    at_corner = np.linalg.norm(mesh.edge_midpoints() - [35.0, 35.0], axis=1) < 0.1
    assert edge_lengths(mesh)[at_corner].min() < 1.3 * SizePolicy().at_tips * 30.0

    peg = [[20, 20], [80, 20], [80, 80], [55, 80], [55, 60], [45, 60], [45, 80], [20, 80]]
    outline = Outline.of_pieces(shapes.polygon(np.array(peg, dtype=float)))
    mesh = plate_mesh(Part.plate(100.0, 100.0, [outline]))
    lengths, middle = edge_lengths(mesh), mesh.edge_midpoints()
    salient = np.linalg.norm(middle - [55.0, 60.0], axis=1) < 3
    reentrant = np.linalg.norm(middle - [55.0, 80.0], axis=1) < 3
    assert lengths[salient].min() > 20 * lengths[reentrant].min()

    notch = [[-10, 45], [10, 45], [10, 55], [-10, 55]]
    outside = Outline.of_pieces(shapes.polygon(np.array(notch, dtype=float)))
    size = all_sizes(SizePolicy(8.0), Part.plate(100.0, 100.0, [outside]), [], None)
    inner, outer = size(np.array([[10.0, 45.0], [-10.0, 45.0]]))
    assert inner == pytest.approx(SizePolicy().at_tips * 10.0)
    # as small as the gap between the notch's own sides asks for at most
    assert outer > 100 * inner


def test_sizes_at_given_points_of_the_boundary_are_kept():
    at, wanted = np.array([[30.0, 50.0], [50.0, 70.0], [0.0, 20.0]]), np.array([0.05, 0.3, 0.8])
    outline = Outline.through(shapes.circle((50, 50), 20.0))
    mesh = plate_mesh(Part.plate(100.0, 100.0, [outline]), fine_at=(at, wanted))
    corner = mesh.vertices[mesh.triangles]
    shortest = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=-1).min(axis=1)
    nearest = shapely.STRtree(shapely.polygons(corner)).nearest(shapely.points(at))
    assert np.all(shortest[nearest] < 1.2 * wanted)
    assert np.all(shortest[nearest] > 0.5 * wanted)


@given(
    factor=st.floats(0.01, 100.0),
    prescribed=st.lists(st.floats(0.1, 2.0), min_size=3, max_size=10),
)
def test_steps_along_a_path_are_the_shorter_of_the_neighbours(factor, prescribed):
    depth = np.concatenate([[0.0], np.cumsum(prescribed)]) * factor
    path = depth[:, None] * [0.6, 0.8]
    size = along_path(path)
    step = np.diff(depth)
    assert size[0] == pytest.approx(step[0]) and size[-1] == pytest.approx(step[-1])
    assert size[1:-1] == pytest.approx(np.minimum(step[1:], step[:-1]))


@pytest.mark.parametrize("factor", [0.01, 30.0])
def test_a_plate_in_another_size_has_the_same_mesh(factor):
    def sizes(k):
        outline = Outline.through(shapes.ellipse((50 * k, 50 * k), (20 * k, 4 * k), 30.0))
        crack = np.array([[0.0, 20.0], [15.0, 25.0]]) * k
        part = Part.plate(100 * k, 100 * k, [outline], [crack])
        size = all_sizes(SizePolicy(8.0 * k), part, part.crack_lines, None)
        points = np.random.default_rng(0).uniform(0, 100, (200, 2))
        return size(points * k) / k

    assert sizes(factor) == pytest.approx(sizes(1.0), rel=1e-5)


def test_the_policy_decides_how_fine_tips_and_kinks_are():
    part = Part.plate(100.0, 100.0, cracks=[[(0, 50), (20, 50), (35, 60)]])
    kink, tip = np.array([[20.0, 50.0]]), np.array([[35.0, 60.0]])
    length = 20.0 + np.hypot(15.0, 10.0)
    for policy in (SizePolicy(), SizePolicy(at_tips=4e-3, at_kinks=0.05)):
        size = all_sizes(policy, part, part.crack_lines, None)
        assert size(tip) == pytest.approx(policy.at_tips * length)
        assert size(kink) == pytest.approx(policy.at_kinks * length)
    # a point on a straight stretch, or where another crack ends at a right angle, is no kink
    straight = Part.plate(100.0, 100.0, cracks=[[(0, 50), (20, 50), (40, 50)], [(20, 50), (20, 70)]])
    assert all_sizes(SizePolicy(), straight, straight.crack_lines, None)(kink) > 1.0
