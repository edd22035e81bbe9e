"""Stress from patches: exact for polynomials, Kirsch's from his displacements, and NaN where nothing is known."""

import numpy as np
import pytest

from slmm.part.part import Part
from slmm.scene.loading import Loading, plate_loading
from slmm.voxels.grid import VoxelGrid
from slmm.voxels.patch_stress import DEGREE, PatchStress, displacements, surface_of, tractions

E, NU = 3000.0, 0.3


def patches(part, loading, grid, u):
    density = grid.density(part)
    surface = surface_of(part, loading, 0.5 * grid.size)
    return PatchStress(grid, u.reshape(grid.ny + 1, grid.nx + 1, 2), density, surface, E, NU)


def test_a_plate_under_tension_has_its_stress_at_edges_and_inside():
    part, loading = Part.plate(20.0, 30.0), plate_loading(20.0, 30.0, stress=6.0)
    grid = VoxelGrid((0.0, 0.0), 0.5, 0.5, 40, 60)
    x, y = grid.nodes.T
    u = np.column_stack([-NU * 6.0 / E * x, 6.0 / E * y])
    points = np.array([[0.0, 15.0], [10.0, 30.0], [10.0, 15.0], [20.0, 0.1]])
    stress = patches(part, loading, grid, u).stress(points)
    np.testing.assert_allclose(stress, np.tile([0.0, 6.0, 0.0], (4, 1)), atol=1e-9)


def test_pure_bending_is_a_polynomial():
    part, loading = Part.plate(40.0, 10.0), Loading(())
    grid = VoxelGrid((0.0, 0.0), 0.5, 0.5, 80, 20)
    x, y = (grid.nodes - [20.0, 5.0]).T
    # sigma_xx = y
    u = np.column_stack([x * y, -0.5 * x**2 - 0.5 * NU * y**2]) / E
    stress = patches(part, loading, grid, u).stress(np.array([[20.0, 10.0], [20.0, 0.0], [18.0, 6.0]]))
    np.testing.assert_allclose(stress, [[5.0, 0.0, 0.0], [-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]], atol=1e-9)


def test_displacements_and_tractions_belong_together():
    """By finite differences of the displacements, for each coefficient."""
    kappa, step = (3 - NU) / (1 + NU), 1e-5
    z, normal = np.array([0.4 - 0.3j]), np.array([0.6 + 0.8j])
    along_x, along_y = (
        (displacements(z + way, kappa, DEGREE) - displacements(z - way, kappa, DEGREE))[0] / (2 * step)
        for way in (step, 1j * step)
    )
    e_xx, e_yy = along_x.real, along_y.imag
    shear = 0.5 * (along_x.imag + along_y.real)
    # 2 mu = 1: sigma = epsilon + (nu/(1 - nu)) tr(epsilon) in plane stress
    mean = NU / (1 - NU) * (e_xx + e_yy)
    pulls = (e_xx + mean) * 0.6 + shear * 0.8 + 1j * (shear * 0.6 + (e_yy + mean) * 0.8)
    np.testing.assert_allclose(tractions(z, normal, DEGREE)[0], pulls, atol=1e-8)


def test_where_too_little_material_is_around_there_is_no_value():
    grid = VoxelGrid((0.0, 0.0), 1.0, 1.0, 20, 3)
    part = Part.plate(20.0, 3.0)
    model = patches(part, Loading(()), grid, np.zeros((len(grid.nodes), 2)))
    assert np.isnan(model.stress(np.array([[10.0, 1.5]]))).all()


@pytest.mark.parametrize("radius", [20.0, 10.0])
def test_a_hole_under_pressure_has_its_hoop_stress(radius):
    """Lamé's infinite body from exact displacements: within a percent at twenty voxels a radius, better at more."""
    from slmm.part.outline import Outline
    from slmm.part.shapes import circle
    from slmm.part.span import Span
    from slmm.scene.loading import Condition

    hole = Outline.through(circle((40.0, 40.0), radius))
    part = Part.plate(80.0, 80.0, [hole])
    at = tuple(hole.points(0.0).tolist())
    loading = Loading((Condition(at, at, pressure=5.0, span=Span(hole, hole.length, 0.0)),))
    grid = VoxelGrid((0.0, 0.0), 0.5, 0.5, 160, 160)
    out = grid.nodes - [40.0, 40.0]
    r2 = np.maximum((out**2).sum(axis=1), 1.0)
    u = 5.0 * radius**2 * (1 + NU) / E * out / r2[:, None]
    stress = patches(part, loading, grid, u).stress(np.array([[40.0 + radius, 40.0]]))[0]
    allowed = 1e-2 if radius == 10.0 else 1e-3
    np.testing.assert_allclose(stress, [-5.0, 5.0, 0.0], atol=5.0 * allowed)
