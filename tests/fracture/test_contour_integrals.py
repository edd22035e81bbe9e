"""J and K of fields that are known exactly: given at the nodes, or solved for in plates."""

import numpy as np
import pytest

from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fracture.configurational_forces import nodal_configurational_forces
from slmm.fracture.contour_integrals import face_term, j_vector, stress_intensities
from slmm.fracture.tip_field import tip_displacement
from slmm.fracture.tips import find_crack_tips
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import linear_elastic
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading

STEEL = Elasticity(210e3, 0.3)
PMMA = Material.from_name("PMMA")


def given_field(displacement, elasticity=STEEL, turn=0.0, n=40):
    """Elements of a polar mesh with a slit, a displacement field given at their nodes, turned about the tip."""
    theta = np.linspace(-np.pi, np.pi, 2 * n + 1)
    r = np.concatenate([[0.0], np.geomspace(0.02, 10.0, 2 * 50)])
    grid = r[:, None, None] * np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    grid[np.abs(grid) < 1e-14] = 0.0
    grid[:, 1::2] = (grid[:, :-1:2] + grid[:, 2::2]) / 2
    grid[1::2] = (grid[:-1:2] + grid[2::2]) / 2
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:2])
    number[0] = 0
    i, j = (a.ravel() for a in np.meshgrid(np.arange(0, 100, 2), np.arange(0, 2 * n, 2), indexing="ij"))
    place = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    nodes = np.stack([number[i + a, j + b] for a, b in place], axis=1)
    points = grid.reshape(-1, 2)
    at = points.copy()
    at[number[:, 0], 1] = -0.0
    u = displacement(at)
    R = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    results = linear_elastic(points @ R.T, {"CPE8": nodes}, u @ R.T, elasticity)
    (tip,) = find_crack_tips(results.points, results.cells)
    return results, tip


def forces_of(results):
    return nodal_configurational_forces(
        results.points, results.cells, results.u, results.stress, results.energy, results.method
    )


@pytest.mark.parametrize("state", ["plane strain", "plane stress"])
@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_given_stress_intensities_come_back_in_any_direction(state, turn):
    elasticity = Elasticity(210e3, 0.3, state)
    K = np.array([20.0, -7.0])
    results, tip = given_field(lambda at: tip_displacement(at, K, elasticity), elasticity, turn)
    for radius in (1.0, 3.0, tip.clear):
        np.testing.assert_allclose(stress_intensities(results, tip, radius, elasticity), K, rtol=1e-4)
        J = j_vector(results, forces_of(results), tip, radius, elasticity)
        exact = np.array([K @ K, -2 * K[0] * K[1]]) / elasticity.E_prime
        np.testing.assert_allclose(J, exact, rtol=1e-3)


def test_without_elasticity_j_along_the_crack_is_known_and_across_it_is_not():
    results, tip = given_field(lambda at: tip_displacement(at, np.array([20.0, 0.0]), STEEL))
    J = j_vector(results, forces_of(results), tip, 5.0, None)
    assert J[0] == pytest.approx(400 / STEEL.E_prime, rel=1e-3)
    assert np.isnan(J[1])


def test_a_stress_along_the_crack_and_k_ii_meet_in_the_energy_of_the_faces():
    """T parallel to the crack: J stays that of K, and the faces' part is 8 T K_II sqrt(r / 2 pi) / E' within q = 1."""
    K, T, radius = np.array([20.0, 10.0]), 5.0, 4.0

    def displacement(at):
        H = np.diag([1.0, -STEEL.nu / (1 - STEEL.nu)]) * T / STEEL.E_prime
        return tip_displacement(at, K, STEEL) + at @ H.T

    results, tip = given_field(displacement)
    q_1 = np.sqrt(radius / 2)  # the weight is 1 up to half the radius and falls to 0 linearly
    x = np.linspace(0.5, 1.0, 2001)
    q_2 = np.trapezoid(2 * (1 - x) / (2 * np.sqrt(x)), x) * np.sqrt(radius)
    exact = 8 * T * K[1] * (q_1 + q_2) / np.sqrt(2 * np.pi) / STEEL.E_prime
    assert face_term(results, tip, radius, STEEL) == pytest.approx(exact, rel=1e-3)
    J = j_vector(results, forces_of(results), tip, radius, STEEL)
    np.testing.assert_allclose(J, np.array([K @ K, -2 * K[0] * K[1]]) / STEEL.E_prime, rtol=1e-3)


def plate_results(crack, width=80.0, height=80.0, **load):
    mesh = plate_mesh(Part.plate(width, height, cracks=[crack]))
    return PlateModel(mesh, PMMA, plate_loading(width, height, **load)).results


def test_domains_that_reach_past_what_is_clear_are_refused():
    results = plate_results([[0, 40], [20, 40]], stress=1.0)
    (tip,) = find_crack_tips(results.points, results.cells)
    with pytest.raises(
        ValueError, match=r"radius = 21 mm: at most 20 mm are clear around the tip at \(20, 40\)"
    ):
        stress_intensities(results, tip, 21.0, STEEL)
    with pytest.raises(ValueError, match="radius = 21 mm"):
        j_vector(results, forces_of(results), tip, 21.0, STEEL)


def test_stress_intensities_of_two_loads_add_up():
    crack = [[30.0, 36.0], [50.0, 44.0]]
    loads = (
        {"strain": (0.001, 0.002, 0.0)},
        {"strain": (0.0, 0.001, 0.003)},
        {"strain": (0.001, 0.003, 0.003)},
    )
    K = []
    for load in loads:
        results = plate_results(crack, **load)
        K.append(
            [
                stress_intensities(results, t, 5.0, results.elasticity[0])
                for t in find_crack_tips(results.points, results.cells)
            ]
        )
    np.testing.assert_allclose(np.add(K[0], K[1]), K[2], rtol=1e-9)
