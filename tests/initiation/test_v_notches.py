"""V-notches are recognised by their flanks, whatever outline they belong to."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm import Scene
from slmm.initiation.positions import find_positions
from slmm.initiation.v_notches import notch_at
from slmm.scene import gallery


def at(scene, point):
    """The notch at a point of the scene."""
    return notch_at(scene, find_positions(scene.with_(analysis={"points": [list(point)]})), 0)


def notch_in_square(opening, radius, direction, depth):
    """A plate with a V-notch in its middle, the root in the centre."""
    hole = {
        "shape": "v-notch",
        "tip": [50.0, 50.0],
        "direction": direction,
        "opening": opening,
        "radius": radius,
        "depth": depth,
    }
    return Scene.from_dict(
        {
            "plate": {"width": 100.0, "height": 100.0},
            "holes": [hole],
            "material": {"name": "PMMA"},
            "load": {"stress": 1.0},
        }
    )


@given(
    opening=st.floats(10.0, 120.0),
    radius=st.sampled_from([0.0, 0.1, 1.0]),
    direction=st.floats(-180.0, 180.0),
    depth=st.floats(5.0, 10.0),
)
def test_notch_is_found_with_its_opening_radius_and_bisector(opening, radius, direction, depth):
    notch = at(notch_in_square(opening, radius, direction, depth), (50.0, 50.0))
    angle = np.radians(direction)
    assert np.degrees(notch.opening) == pytest.approx(opening, abs=1e-4)
    assert notch.radius == pytest.approx(radius, rel=1e-4)
    assert notch.root == pytest.approx([50.0, 50.0], abs=1e-6)
    assert notch.direction == pytest.approx([np.cos(angle), np.sin(angle)], abs=1e-6)
    # its own back side is nearest
    assert notch.clear == pytest.approx(depth, rel=1e-9)


def test_root_is_bounded_by_where_the_flanks_begin():
    notch = at(gallery.v_notch(opening=60.0, radius=1.0), (10.0, 60.0))
    flank, other = notch.on_root(np.array([-1.0, 1.0]))
    centre = np.array([9.0, 60.0])
    assert flank - centre == pytest.approx([0.5, -np.sqrt(0.75)], abs=1e-5)
    assert other - centre == pytest.approx([0.5, np.sqrt(0.75)], abs=1e-5)


def test_u_notch_has_no_opening():
    notch = at(gallery.v_notch(opening=0.0, radius=2.0), (10.0, 60.0))
    assert (notch.opening, notch.radius) == pytest.approx((0.0, 2.0), abs=1e-5)


def test_position_a_little_beside_the_bisector_belongs_to_the_root():
    scene = gallery.v_notch(opening=60.0, radius=1.0)
    for degrees, found in ((2.0, True), (10.0, False)):
        beside = [9.0 + np.cos(np.radians(degrees)), 60.0 + np.sin(np.radians(degrees))]
        if found:
            assert at(scene, beside).root == pytest.approx([10.0, 60.0], abs=1e-4)
        else:
            with pytest.raises(ValueError, match="10 degrees off its bisector"):
                at(scene, beside)


@pytest.mark.parametrize(
    ("scene", "point", "reason"),
    [
        (gallery.circular_hole(), (70.0, 50.0), "nothing as long as its radius of curvature, 20 mm"),
        (gallery.elliptic_hole(), (70.0, 50.0), "without flanks"),
        (gallery.lobed_notch(), (74.0, 50.0), "without flanks"),
        (gallery.square_hole(), (65.0, 50.0), "does not bulge"),
    ],
)
def test_smooth_surface_without_flanks_is_no_notch(scene, point, reason):
    with pytest.raises(ValueError, match=reason):
        at(scene, point)


def test_corner_of_the_material_is_no_notch():
    dart = {"shape": "polygon", "points": [[40, 40], [60, 40], [50, 45], [50, 60]]}
    with pytest.raises(ValueError, match="corner of the material"):
        at(gallery.square_hole(holes=[dart]), (50.0, 45.0))


def test_flanks_of_a_square_hole_are_its_sides():
    notch = at(gallery.square_hole(), (65.0, 65.0))
    assert notch.clear == pytest.approx(30.0)
    assert notch.direction == pytest.approx([np.sqrt(0.5)] * 2)


def test_clear_distance_sees_edges_holes_and_cracks():
    crack = {"points": [[0.0, 60.0], [10.0, 60.0], [14.0, 60.0]]}
    bent = {"points": [[0.0, 60.0], [10.0, 58.0], [14.0, 60.0]]}
    hole = {"shape": "circle", "center": [20.0, 60.0], "radius": 3.0}
    other = {"points": [[40.0, 61.0], [14.0, 61.0]]}
    for changes, expected in (
        ({"cracks": [crack]}, 4.0),  # only its last segment is known to be straight
        ({"cracks": [bent]}, np.hypot(4.0, 2.0)),
        ({"cracks": [crack], "holes": [hole]}, 3.0),
        ({"cracks": [crack, other]}, 1.0),
        ({"cracks": [{"points": [[0.0, 60.0], [34.0, 60.0]]}]}, 6.0),
    ):
        scene = gallery.edge_crack(**changes)
        assert at(scene, scene.cracks[0].points[-1]).clear == pytest.approx(expected, rel=1e-5)
