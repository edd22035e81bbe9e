"""The stress behind the notches: of cracks, of given displacements, of a plain plate."""

import math
import sys

import numpy as np
import pytest
from made_up_result import made_up
from pictured import PLATE, plate_of_the_data

from slmm.mechanics.stress import principal_stress
from slmm.pictures.initiation import plot_initiation
from slmm.pictures.stress_field import principal_stress_field, stress_in_view
from slmm.scene import gallery


def test_a_crack_s_faces_are_free_of_stress():
    """At 0.1 a above the face of an edge crack, next to nothing is left of the tension; without it, all."""
    scene = gallery.edge_crack(10.0)
    view = (2.0, 6.0, 60.5, 61.5)
    field = stress_in_view(scene, view)
    assert field.cracked
    assert field.extent == view
    assert np.all(np.abs(field.sigma_I) < 0.25 * 10.0)
    whole = gallery.edge_crack(
        10.0, cracks=[], holes=[{"shape": "circle", "center": [30, 20], "radius": 0.1}]
    )
    assert np.median(stress_in_view(whole, view).sigma_I) == pytest.approx(10.0, rel=0.01)


def test_around_a_crack_tip_the_stress_is_that_of_its_stress_intensity():
    """K_I of an edge crack in a strip; straight ahead, sigma_I = K_I/sqrt(2 pi r) (1 + O(r/a))."""
    scene = gallery.edge_crack(10.0)
    ratio = 10.0 / 40.0
    factor = 1.122 - 0.231 * ratio + 10.55 * ratio**2 - 21.71 * ratio**3 + 30.382 * ratio**4
    K = 10.0 * math.sqrt(math.pi * 10.0) * factor
    field = stress_in_view(scene, (10.0, 11.0, 59.5, 60.5))
    r = (np.arange(field.sigma_I.shape[1]) + 0.5) / field.sigma_I.shape[1]
    ahead = field.sigma_I[[99, 100]].mean(axis=0)
    near = (r > 0.2) & (r < 0.4)
    np.testing.assert_allclose(ahead[near], K / np.sqrt(2 * np.pi * r[near]), rtol=0.08)


def test_without_the_mesher_the_stress_is_that_without_cracks(monkeypatch):
    monkeypatch.setitem(sys.modules, "netgen", None)
    monkeypatch.setitem(sys.modules, "netgen.geom2d", None)
    scene = gallery.edge_crack()
    field = stress_in_view(scene, (0.0, 20.0, 50.0, 70.0))
    assert not field.cracked
    np.testing.assert_allclose(field.sigma_I, 10.0, rtol=1e-2)
    labels = [axes.get_xlabel() for axes in plot_initiation(scene, made_up(scene)).axes]
    assert any("without crack" in label for label in labels)


def test_the_stress_of_given_displacements_is_theirs():
    scene = plate_of_the_data()
    view = (5.0, 15.0, 5.0, 15.0)
    field = stress_in_view(scene.with_(load={"stress": 1.0}), view, PLATE)
    own = stress_in_view(scene, view)
    # the same cells, of 0.05 mm; the finite element model's own are ten times as large at the hole
    assert field.sigma_I.shape == (200, 200) and own.sigma_I.shape == (400, 400)
    middle = 5.0 + (np.arange(200) + 0.5) / 20
    outside = np.hypot(*np.meshgrid(middle - 10, middle - 10)) > 2.2
    difference = np.abs(field.sigma_I - own.sigma_I[100:300, 100:300])[outside]
    assert np.median(difference) < 0.005 * 29.6
    assert np.max(difference) < 0.1 * 3 * 29.6
    assert np.isnan(field.sigma_I[100, 100])  # in the hole


def test_plain_plate_has_the_stress_of_hooke():
    scene = gallery.circular_hole(radius=0.1, load={"stress": 10.0})
    field = principal_stress_field(scene, 2500)
    assert np.median(field) == pytest.approx(10.0, rel=2e-3)
    assert field[0, 0] == pytest.approx(principal_stress(np.array([[0.0, 10.0, 0.0]]))[0], rel=2e-3)
