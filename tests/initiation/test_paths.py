"""Trial paths: they go into the material, and end where the material does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm import Scene
from slmm.initiation.paths import IN_IRWIN_LENGTHS, IN_LIGAMENT, LONGER, ligaments, trial_paths
from slmm.initiation.positions import find_positions
from slmm.scene import gallery

#: what the polygons in place of the outlines may cost
CHORDS = 1e-4
FEW = settings(max_examples=8, deadline=None)


def paths(scene, positions=None):
    where = find_positions(scene, positions)
    return where, trial_paths(scene, where)


def to_edges(points, direction, width, height):
    """Distance (n,) along directions to the edges of the plate."""
    with np.errstate(divide="ignore"):
        reach = np.where(direction > 0, (np.array([width, height]) - points) / direction, -points / direction)
    return np.where(np.isfinite(reach), reach, np.inf).min(axis=1)


def to_circle(points, direction, center, radius):
    """Distance (n,) along directions to a circle from outside; inf where it is missed."""
    offset = points - center
    b, c = np.sum(offset * direction, axis=1), np.sum(offset**2, axis=1) - radius**2
    discriminant = b**2 - c
    t = -b - np.sqrt(np.maximum(discriminant, 0))
    return np.where((discriminant > 0) & (t > 1e-6), t, np.inf)


@FEW
@given(x=st.floats(20.0, 80.0), y=st.floats(25.0, 75.0), radius=st.floats(0.5, 15.0))
def test_ligament_of_a_hole_ends_at_the_plates_edge(x, y, radius):
    hole = {"shape": "circle", "center": [x, y], "radius": radius}
    where, found = paths(gallery.circular_hole(holes=[hole], plate={"width": 110.0, "height": 100.0}), 12)
    outward = (where.points - [x, y]) / radius
    assert found.direction == pytest.approx(outward, abs=1e-4)
    assert found.ligament == pytest.approx(to_edges(where.points, outward, 110.0, 100.0), rel=CHORDS)


def test_ligament_between_two_holes_ends_at_the_other():
    scene = gallery.two_holes(10.0)
    where, found = paths(scene, 36)
    centres = np.array([[35.0, 50.0], [65.0, 50.0]])
    outward = (where.points - centres[where.hole]) / 10.0
    other = centres[1 - where.hole]
    expected = np.minimum(
        to_edges(where.points, outward, 100.0, 100.0), to_circle(where.points, outward, other, 10.0)
    )
    assert found.ligament == pytest.approx(expected, rel=CHORDS)
    assert found.ligament.min() == pytest.approx(10.0, rel=CHORDS)


def test_ligament_of_an_edge_notch_crosses_the_plate():
    scene = gallery.circular_hole(holes=[{"shape": "circle", "center": [0.0, 50.0], "radius": 12.0}])
    where, found = paths(scene.with_(analysis={"points": [[12.0, 50.0], [6.0, 50 + 6 * np.sqrt(3)]]}))
    assert np.all(where.points[:, 0] > 0)
    assert found.ligament == pytest.approx([88.0, (50 - 6 * np.sqrt(3)) / (np.sqrt(3) / 2)], rel=CHORDS)


def test_a_crack_in_the_way_ends_the_ligament():
    hole = {"shape": "circle", "center": [50.0, 50.0], "radius": 10.0}
    crack = {"points": [[75.0, 0.0], [75.0, 60.0]]}
    scene = gallery.circular_hole(holes=[hole], cracks=[crack])
    scene = scene.with_(analysis={"points": [[60.0, 50.0], [50.0, 60.0], [40.0, 50.0]]})
    assert paths(scene)[1].ligament == pytest.approx([15.0, 40.0, 40.0], rel=CHORDS)


def test_a_crack_goes_straight_on_from_its_tip_whatever_kinks_it_has():
    crack = {"points": [[0.0, 60.0], [10.0, 60.0], [13.0, 64.0]]}
    where, found = paths(gallery.edge_crack(cracks=[crack]))
    assert where.points.tolist() == [[13.0, 64.0]]
    assert found.direction[0] == pytest.approx([0.6, 0.8])
    assert found.ligament[0] == pytest.approx(27.0 / 0.6, rel=CHORDS)


def test_a_path_from_a_corner_follows_its_bisector():
    where, found = paths(gallery.square_hole(), 1)
    at = np.flatnonzero(np.isfinite(where.corner))
    outward = np.sign(where.points[at] - 50.0) / np.sqrt(2)
    assert len(at) == 4
    assert found.direction[at] == pytest.approx(outward)
    assert found.ligament[at] == pytest.approx(35.0 * np.sqrt(2), rel=CHORDS)


def test_a_path_into_a_concave_part_ends_at_the_notchs_own_other_side():
    points = [[20, 20], [80, 20], [80, 80], [55, 80], [55, 40], [45, 40], [45, 80], [20, 80]]
    scene = Scene.from_dict(
        {
            "plate": {"width": 100.0, "height": 100.0},
            "holes": [{"shape": "polygon", "points": points}],
            "material": {"name": "PMMA"},
            "load": {"stress": 1.0},
            "analysis": {"points": [[55.0, 60.0], [80.0, 50.0]]},
        }
    )
    assert paths(scene)[1].ligament == pytest.approx([10.0, 20.0], rel=CHORDS)


@pytest.mark.parametrize("l_ch", [0.1, 10.0, 1000.0])
def test_longest_crack_is_a_share_of_irwins_length_or_of_the_ligament(l_ch):
    material = {"E": 3000.0, "nu": 0.3, "sigma_c": 50.0, "G_c": l_ch * 50.0**2 / 3000.0}
    found = paths(gallery.two_holes(10.0, material=material), 16)[1]
    assert found.longest == pytest.approx(np.minimum(IN_IRWIN_LENGTHS * l_ch, IN_LIGAMENT * found.ligament))
    longer = found.lengthened()
    assert longer.longest == pytest.approx(np.minimum(LONGER * found.longest, IN_LIGAMENT * found.ligament))
    assert np.array_equal(longer.ligament, found.ligament)


@FEW
@given(factor=st.floats(0.01, 100.0))
def test_ligaments_scale_with_the_plate(factor):
    def found(k):
        scene = gallery.circular_hole(
            plate={"width": 100.0 * k, "height": 100.0 * k},
            holes=[{"shape": "circle", "center": [40.0 * k, 55.0 * k], "radius": 10.0 * k}],
        )
        points = np.array([[50.0, 55.0], [40.0, 65.0]]) * k
        return ligaments(scene, points, np.array([[1.0, 0.0], [0.6, 0.8]])) / k

    assert found(factor) == pytest.approx(found(1.0), rel=1e-6)
    assert found(1.0) == pytest.approx([50.0, 43.75], rel=CHORDS)


def test_ligament_thinner_than_a_step_into_the_body():
    """Where a notch meets the plate's edge at an acute angle the path leaves the material at once."""
    centre = np.array([3.0, 50.0])
    scene = gallery.circular_hole(holes=[{"shape": "circle", "center": centre.tolist(), "radius": 10.0}])
    angle = np.arccos(-0.3) - np.array([1e-2, 1e-3, 3e-4, 1e-4])
    outward = np.column_stack([np.cos(angle), np.sin(angle)])
    points = centre + 10.0 * outward
    expected = to_edges(points, outward, 100.0, 100.0)
    assert expected[-1] < 0.005
    assert ligaments(scene, points, outward) == pytest.approx(expected, rel=0.05)
