"""Support by the plate's edges: signs, distances, and what stands in the way."""

import numpy as np
import pytest

from slmm.initiation.support import LIMIT, edge_support, supported
from slmm.scene import gallery


def rho(scene, point=(70.0, 50.0), height=10.0):
    outline = scene.outlines[0]
    s = outline.project(np.array([point]))
    return float(edge_support(scene, outline, s, np.array([height]), np.array([-1 / 40]))[0])


def test_held_edges_stiffen_and_free_ones_weaken():
    assert rho(gallery.circular_hole()) > 0
    assert rho(gallery.circular_hole(load={"stress": 1.0})) < 0


def test_distance_counts_with_its_square():
    """Twice the plate and twice the hole with the same cell: a quarter of the support, but for the cell's own."""
    near = rho(gallery.circular_hole(radius=20.0, size=100.0), (70.0, 50.0), height=5.0)
    far = rho(gallery.circular_hole(radius=20.0, size=1000.0), (520.0, 500.0), height=5.0)
    assert far < 0.01 * near
    # the same picture at another scale has the same rho
    scene = gallery.circular_hole(radius=40.0, size=200.0)
    outline = scene.outlines[0]
    s = outline.project(np.array([[140.0, 100.0]]))
    twice = edge_support(scene, outline, s, np.array([10.0]), np.array([-1 / 80]))[0]
    assert twice == pytest.approx(near, rel=1e-6)


def test_another_notch_in_the_way_hides_the_edge():
    one = {"shape": "circle", "center": [30.0, 50.0], "radius": 10.0}
    other = {"shape": "rectangle", "center": [70.0, 50.0], "size": [10.0, 80.0], "corner_radius": 4.0}
    alone = rho(gallery.circular_hole(holes=[one]), (40.0, 50.0))
    hidden = rho(gallery.circular_hole(holes=[one, other]), (40.0, 50.0))
    assert 0 < hidden < alone


def test_very_near_edges_are_limited():
    tight = gallery.circular_hole(radius=48.0)
    assert abs(rho(tight, (98.0, 50.0), height=30.0)) <= LIMIT


def test_mixture_of_stiffnesses():
    unbounded, held = np.array([[3.0, 3.0]]), np.array([[1.0, 3.0]])
    np.testing.assert_allclose(supported(unbounded, held, np.array([0.0])), unbounded)
    np.testing.assert_allclose(supported(unbounded, held, np.array([1.0])), held)
    middle = supported(unbounded, held, np.array([0.5]))
    np.testing.assert_allclose(1 / middle, 0.5 / unbounded + 0.5 / held)
    assert supported(unbounded, held, np.array([-0.3]))[0, 0] > 3.0
