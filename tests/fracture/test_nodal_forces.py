"""Configurational forces on the nodes of a model: sums of its elements', on interfaces, in rings and within radii."""

import numpy as np
import pytest
from random_elements import neo_hooke
from scipy.optimize import brentq

from slmm.fracture.configurational_forces import (
    compute_CS,
    forces_in_rings,
    forces_within,
    nodal_configurational_forces,
)


def test_forces_of_mixed_elements_are_the_sums_of_their_blocks():
    """A square of a quadrilateral and two triangles, uniformly strained: homogeneous, so inner nodes feel nothing."""
    points = np.array([[0, 0], [1, 0], [2.2, 0], [2, 1], [1.1, 1.3], [0, 1]], dtype=float)
    cells = {"CPE4": np.array([[0, 1, 4, 5]]), "CPE3": np.array([[1, 2, 3], [1, 3, 4]])}
    strain = np.array([[0.02, 0.01], [0.03, -0.01]])
    F = np.eye(2) + strain
    density, S = neo_hooke(F[None])
    stress = {"CPE4": np.tile(S, (1, 4, 1, 1)), "CPE3": np.tile(S, (2, 1, 1, 1))}
    energy = {"CPE4": np.full((1, 4), density[0]), "CPE3": np.full((2, 1), density[0])}
    u = points @ strain.T
    forces = nodal_configurational_forces(points, cells, u, stress, energy, thickness=2.0)
    assert np.abs(forces.sum(axis=0)).max() < 1e-12
    once = nodal_configurational_forces(points, cells, u, stress, energy)
    np.testing.assert_allclose(forces, 2 * once)
    # the boundary integral of the configurational stress along the upper right edge and so on: its ends only
    CS = compute_CS(points[cells["CPE3"]], u[cells["CPE3"]], stress["CPE3"], energy["CPE3"], "CPE3")[0, 0]
    edge = points[3] - points[2]
    normal = np.array([edge[1], -edge[0]])
    below = points[2] - points[1]
    expected = CS @ (normal + np.array([below[1], -below[0]])) / 2
    np.testing.assert_allclose(once[2], expected)


def two_phase_bar(cauchy_and_energy):
    """Force on the interface of the bar of Paper B, Fig. 4: 20 mm x 10 mm, 0.1 mm longer, no transverse strain."""
    modulus, length, height = np.array([210e3, 105e3]), 10.0, 10.0
    points = np.array([[x, y] for y in (0, height) for x in (0, length, 2 * length)])
    cells = {"CPE4": np.array([[0, 1, 4, 3], [1, 2, 5, 4]])}
    # both parts carry the same force: find the first one's elongation
    first = brentq(
        lambda x: np.subtract(
            *(cauchy_and_energy(E, e / length)[0] for E, e in zip(modulus, (x, 0.1 - x), strict=True))
        ),
        0.0,
        0.1,
    )
    found = [cauchy_and_energy(E, e / length) for E, e in zip(modulus, (first, 0.1 - first), strict=True)]
    u = np.zeros_like(points)
    u[:, 0] = np.where(points[:, 0] == length, first, np.where(points[:, 0] > length, 0.1, 0.0))
    S, energy = np.zeros((2, 4, 2, 2)), np.zeros((2, 4))
    for k, (sigma, density) in enumerate(found):
        S[k, :, 0, 0], energy[k] = sigma, density
    forces = nodal_configurational_forces(points, cells, u, {"CPE4": S}, {"CPE4": energy})
    return forces[points[:, 0] == length].sum(axis=0)


def test_two_phase_bar_has_the_exact_and_the_published_interface_force():
    def linear(E, strain):
        return E * strain, E * strain**2 / 2

    def logarithmic(E, strain):
        """As Abaqus reports it with large displacements: half the stress times the logarithmic strain."""
        log = np.log(1 + strain)
        return E * log, E * log**2 / 2

    assert two_phase_bar(linear) == pytest.approx([35 / 3, 0.0], rel=1e-9, abs=1e-9)
    assert two_phase_bar(logarithmic)[0] == pytest.approx(11.718, abs=5e-4)


def test_sums_in_contours_add_one_layer_of_elements_after_another():
    cells = {"CPE4": np.array([[0, 1, 5, 4], [1, 2, 6, 5]]), "CPE3": np.array([[2, 3, 6], [3, 7, 6]])}
    forces = np.random.default_rng(1).normal(size=(8, 2))
    found = forces_in_rings(cells, forces, [0, 4], 4)
    for k in range(4):
        columns = [i for i in range(8) if i % 4 <= k]
        np.testing.assert_allclose(found[k], forces[columns].sum(axis=0))
    with pytest.raises(ValueError, match="forces has 7 nodes: cells names node 7"):
        forces_in_rings(cells, forces[:7], [0, 4], 4)


def test_sums_within_radii_and_missing_blocks():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 3.0]])
    assert forces_within(points, np.ones((3, 2)), [0, 0], [0.5, 1.0, 5.0]).tolist() == [
        [1, 1],
        [2, 2],
        [3, 3],
    ]
    with pytest.raises(ValueError, match=r"radii = \[0.5\] mm: the nearest node lies 1 mm away"):
        forces_within(points, np.ones((3, 2)), [0, -1], 0.5)
    cells = {"CPE3": [[0, 1, 2]]}
    with pytest.raises(ValueError, match="energy has no values of CPE3, of which there are 1 elements"):
        nodal_configurational_forces(points, cells, points, {"CPE3": np.zeros((1, 1, 2, 2))}, {})
    with pytest.raises(ValueError, match="names node 7: there are 3"):
        nodal_configurational_forces(
            points,
            {"CPE3": [[0, 1, 7]]},
            points,
            {"CPE3": np.zeros((1, 1, 2, 2))},
            {"CPE3": np.zeros((1, 1))},
        )
