"""T from domains around tips: made fields, and finite elements against boundary integrals."""

import numpy as np
import pytest

from slmm.boundary.model import BoundaryModel
from slmm.criteria.distances import point_distance
from slmm.fem.plate_model import PlateModel
from slmm.fracture.fem_engine import FemEngine
from slmm.fracture.fem_mesh import crack_mesh
from slmm.fracture.fem_tips import tip_t_stresses
from slmm.fracture.t_stress import force_gradients
from slmm.mechanics.elasticity import Elasticity
from slmm.scene.gallery import tensile_plate

STEEL = Elasticity(210e3, 0.3)


def test_the_field_of_a_force_is_in_equilibrium_with_it_and_leaves_the_faces_free():
    angle = np.linspace(-np.pi, np.pi, 400, endpoint=False) + np.pi / 400
    normal = np.column_stack([np.cos(angle), np.sin(angle)])
    stress = STEEL.stress(force_gradients(2.5 * normal, STEEL))[:, 0]
    traction = np.einsum("aij,aj->ai", stress, normal)
    assert traction.sum(axis=0) * 2.5 * 2 * np.pi / 400 == pytest.approx([-1.0, 0.0], abs=1e-12)
    along = np.column_stack([-normal[:, 1], normal[:, 0]])
    assert np.einsum("aij,aj->ai", stress, along) == pytest.approx(np.zeros((400, 2)), abs=1e-15)


def test_its_gradients_are_those_of_a_displacement():
    """Curl-free: the derivative of each component along x and y, by differences."""
    h, at = 1e-5, np.array([1.3, -0.8])

    def gradient(dx, dy):
        return force_gradients(at + np.array([dx, dy]), STEEL)[0]

    by_y = (gradient(0, h) - gradient(0, -h))[:, 0]
    by_x = (gradient(h, 0) - gradient(-h, 0))[:, 1]
    assert by_x == pytest.approx(by_y, rel=1e-6)


@pytest.mark.parametrize(
    "cracks",
    [[[[0.0, 40.0], [20.0, 40.0]]], [[[30.0, 35.0], [50.0, 45.0]]]],
    ids=["edge crack", "inclined crack, two tips"],
)
def test_finite_elements_find_the_T_of_boundary_integrals_and_converge(cracks):
    pytest.importorskip("netgen")
    scene = tensile_plate([(44.0, 60.0, 8.0)], cracks=[{"points": points} for points in cracks])
    exact = BoundaryModel(scene.part, scene.material, scene.loading, 10, 10)
    size = np.abs(exact.t_stresses()).max()
    coarse = crack_mesh(scene.part, scene.loading, point_distance(scene.material), fineness=4.0)
    states = [
        PlateModel(mesh, scene.material, scene.loading, scene.part.thickness)
        for mesh in (coarse, coarse.refined())
    ]
    states.append(FemEngine(scene.material, scene.loading, 0.01).solve(scene.part).model)
    off = [np.abs(tip_t_stresses(model, scene.part) - exact.t_stresses()).max() / size for model in states]
    assert off[1] < 0.7 * off[0], off
    assert off[2] < 1e-3, off
