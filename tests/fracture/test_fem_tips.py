"""Tips in body-fitted models: their faces, and K of cracks that are closed."""

import numpy as np
import pytest

from slmm.fem.plate_model import PlateModel
from slmm.fracture.configurational_forces import nodal_configurational_forces
from slmm.fracture.contour_integrals import j_vector, stress_intensities
from slmm.fracture.face_traction import loaded_faces
from slmm.fracture.fem_mesh import crack_mesh
from slmm.fracture.fem_tips import tip_stress_intensities, tips_in
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading

pytest.importorskip("netgen")

PMMA = Material.from_name("PMMA")
SIDE, HALF = 400.0, 5.0


def inclined(degrees, stress, fineness=1.0):
    along = HALF * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    middle = np.array([SIDE / 2, SIDE / 2])
    part = Part.plate(SIDE, SIDE, cracks=[[middle - along, middle + along]])
    loading = plate_loading(SIDE, SIDE, stress=stress)
    return part, PlateModel(crack_mesh(part, loading, 0.1, fineness), PMMA, loading, contact=True)


@pytest.fixture(scope="module")
def closed():
    return inclined(30, -1.0)


#: shear on the crack times sqrt(pi a); the plate is forty times as wide as the crack is long
K_II = -np.sqrt(np.pi * HALF) * np.sin(np.pi / 6) * np.cos(np.pi / 6)


def test_a_closed_crack_slides_without_friction_in_mode_II_alone(closed):
    part, model = closed
    assert model.touching.mean() > 0.9
    K = tip_stress_intensities(model, part)
    assert K[:, 0].tolist() == [0.0, 0.0]
    assert K[:, 1] == pytest.approx(K_II, rel=5e-3)


def test_the_pressure_between_the_faces_is_what_leaves_no_mode_I(closed):
    """Without it the integral has its share of them, as if they were free; with it only what elements leave."""
    part, model = closed
    (elasticity,) = model.results.elasticity
    for tip in tips_in(model, part):
        faces = loaded_faces(model.results, tip, model.internal_forces)
        with_it, without = (
            stress_intensities(model.results, tip, tip.clear, elasticity, each)[0] for each in (faces, None)
        )
        assert without < -0.3 * abs(K_II) and abs(with_it) < 0.05 * abs(K_II)


def test_configurational_forces_around_a_closed_tip_have_the_energy_of_mode_II(closed):
    """J along the crack: where faces slide on each other the pressure does no work, and is none of it."""
    part, model = closed
    (elasticity,) = model.results.elasticity
    r = model.results
    forces = nodal_configurational_forces(r.points, r.cells, r.u, r.stress, r.energy, r.method, r.thickness)
    for tip in tips_in(model, part):
        faces = loaded_faces(r, tip, model.internal_forces)
        for radius in (0.5 * tip.clear, tip.clear):
            for each in (faces, None):
                J = j_vector(r, forces, tip, radius, elasticity, each)[0]
                assert elasticity.E_prime * J == pytest.approx(K_II**2, rel=0.01)


def test_an_open_crack_has_the_K_of_both_modes():
    part, model = inclined(30, 1.0)
    assert not model.touching.any()
    K_I = np.sqrt(np.pi * HALF) * np.cos(np.pi / 6) ** 2
    for K in tip_stress_intensities(model, part):
        assert K.tolist() == pytest.approx([K_I, -K_II], rel=5e-3)


def test_faces_lie_on_their_sides_of_the_way_to_a_tip(closed):
    part, model = closed
    middle = model.points[model.triangles[:, :3]].mean(axis=1)
    for tip, line in zip(tips_in(model, part), part.tips, strict=True):
        assert tip.position.tolist() == line[-1].tolist()
        assert tip.upper[0, 0] == tip.lower[0, 0] == tip.nodes[0]
        assert np.linalg.norm(model.points[tip.upper[-1, 1]] - line[-1]) == pytest.approx(2 * HALF)
        for face, side in ((tip.upper, 1), (tip.lower, -1)):
            for start, _, node in face:
                [beside] = np.flatnonzero((model.triangles == node).any(axis=1))
                offset = (middle[beside] - model.points[start]) @ tip.axes.T
                assert side * offset[1] > 0
