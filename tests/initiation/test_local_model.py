from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from slmm.initiation.local_model import bilinear, solve_local_model
from slmm.mechanics.material import Material
from slmm.part.shapes import circle
from slmm.scene.loading import plate_loading


class Circle:
    def __init__(self, x, y, r):
        self.centre, self.r = np.array([x, y]), r

    def polygon(self, n):
        t = np.linspace(0, 2 * np.pi, n, endpoint=False)
        return self.centre + self.r * np.stack([np.cos(t), np.sin(t)], -1)


HOLE = Circle(50, 50, 20)


def plate(load=None, thickness=1.0, void=1e-6, material=None, outlines=(HOLE,)):
    return SimpleNamespace(
        plate=SimpleNamespace(width=100.0, height=100.0, thickness=thickness),
        outlines=outlines,
        material=material or Material.from_name("PMMA"),
        loading=plate_loading(100.0, 100.0, **(load or {"strain": (0.0, 0.1, 0.0)})),
        analysis=SimpleNamespace(void_stiffness=void),
    )


def on_the_hole(distance=0.0):
    return circle((50, 50), 20 + distance)[::4]


def test_displacements_converge_with_the_voxels():
    """First order on the notch's edge; 250 x 250 voxels are within 0.4 % of the finest grid there."""
    finest = solve_local_model(plate(), 600**2).displacement(on_the_hole())
    errors = []
    for n in (75, 150, 300):
        u = solve_local_model(plate(), n**2).displacement(on_the_hole())
        errors.append(np.sqrt(np.mean((u - finest) ** 2)) / np.ptp(finest))
    assert errors[0] < 4e-3
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


def test_stress_in_the_ligament_is_that_of_a_hole_in_a_plate():
    """Strain at the notch of a small hole approaches Kirsch's factor of three."""
    model = solve_local_model(plate({"stress": 10.0}, outlines=(Circle(50, 50, 4),)), 500**2)
    x = np.array([54.5, 55.0, 56.0, 58.0])
    step = 0.2
    up, down = (model.displacement(np.stack([x, np.full(4, 50 + s)], -1)) for s in (step, -step))
    strain = (up - down)[:, 1] / (2 * step)
    ratio = 4 / (x - 50)
    s_yy, s_xx = 5 * (2 + ratio**2 + 3 * ratio**4), 15 * (ratio**2 - ratio**4)
    expected = (s_yy - 0.35 * s_xx) / 2960
    np.testing.assert_allclose(strain, expected, rtol=0.03)


def test_thickness_does_not_matter_and_E_divides_under_stress():
    stressed = {"stress": 10.0}
    u = solve_local_model(plate(stressed), 64**2).u
    np.testing.assert_array_equal(solve_local_model(plate(stressed, thickness=7.0), 64**2).u, u)
    stiffer = replace(Material.from_name("PMMA"), E=2 * 2960.0)
    np.testing.assert_allclose(
        solve_local_model(plate(stressed, material=stiffer), 64**2).u, u / 2, rtol=1e-10
    )


def test_plane_strain_is_plane_stress_with_other_constants():
    strained = Material(1000.0, 0.3, 10.0, 1.0, "plane strain")
    equivalent = Material(1000.0 / 0.91, 0.3 / 0.7, 10.0, 1.0)
    a, b = (solve_local_model(plate(material=m), 50**2).u for m in (strained, equivalent))
    np.testing.assert_allclose(a, b, atol=1e-12)


def test_softer_void_changes_little():
    a, b = (solve_local_model(plate(void=v), 100**2).displacement(on_the_hole(2.0)) for v in (1e-6, 1e-9))
    assert np.abs(a - b).max() < 1e-5


def test_plate_without_holes_is_strained_uniformly():
    model = solve_local_model(plate(outlines=()), 400)
    assert (model.nx, model.ny, model.iterations) == (20, 20, 0)
    np.testing.assert_allclose(model.displacement(np.array([[33.0, 71.0]])), [[0.0, 7.1]], atol=1e-9)


def test_bilinear_is_exact_for_bilinear_fields_and_clamps():
    x, y = np.meshgrid(np.linspace(0, 3, 4), np.linspace(0, 1, 3))
    u = np.stack([1 + x - 2 * y + 3 * x * y, x], -1)
    assert bilinear(u, 1.0, 0.5, 1.3, 0.7) == pytest.approx((1 + 1.3 - 1.4 + 3 * 1.3 * 0.7, 1.3))
    assert bilinear(u, 1.0, 0.5, 9.0, -1.0) == pytest.approx((4.0, 3.0))
    assert bilinear(u, 1.0, 0.5, 3.0, 1.0) == pytest.approx((11.0, 3.0))


def test_void_without_stiffness_is_refused():
    with pytest.raises(ValueError, match="void_stiffness = 0"):
        solve_local_model(plate(void=0.0), 400)
