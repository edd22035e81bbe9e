"""Faces of cracks that hold each other in a body-fitted model: pressed parts are as stiff as without cracks."""

import numpy as np
import pytest

from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import plate_loading

pytest.importorskip("netgen")

PMMA = Material.from_name("PMMA")
WIDTH, HEIGHT = 40.0, 60.0


def solved(cracks, stress, contact=True):
    part = Part.plate(WIDTH, HEIGHT, cracks=cracks)
    loading = plate_loading(WIDTH, HEIGHT, stress=stress)
    return PlateModel(plate_mesh(part), PMMA, loading, contact=contact)


def gap_and_force(model):
    """Opening of the pairs of nodes, mm, and the force that presses the left ones away from the right ones, N."""
    gap = model.pairs.openings(len(model.points)) @ model.u.ravel()
    return gap, (model.internal_forces[model.pairs.nodes[:, 1]] * model.pairs.across).sum(axis=1)


@pytest.mark.parametrize(
    "cracks",
    [
        [[(10, 30), (30, 30)]],
        [[(0, 30), (25, 30)]],
        [[(5, 30), (35, 30)], [(20, 30), (20, 45)]],
        [[(5, 30), (35, 30)], [(20, 15), (20, 45)]],
        [[(5, 20), (20, 20), (20, 40), (35, 40)]],
    ],
    ids=["inside", "edge", "branch", "cross", "steps"],
)
def test_a_plate_pressed_across_or_along_its_cracks_is_as_without_them(cracks):
    """Uniform stress: what is pressed carries all of it, and what lies along it carries nothing."""
    model = solved(cracks, -10.0)
    x, y = model.points.T
    E, nu = PMMA.plane_stress_equivalent
    strain = -10.0 / E
    exact = np.column_stack([-nu * strain * x, strain * y])
    motion = model.u - exact
    assert np.ptp(motion[:, 0]) < 1e-9 * np.abs(exact).max() > np.ptp(motion[:, 1])
    across = np.abs(model.pairs.across[:, 1]) > 0.5
    assert model.touching[across].all()
    _, force = gap_and_force(model)
    alone = ~np.isin(model.pairs.nodes, model.pairs.nodes[~across]).any(axis=1) & across
    assert force[alone] == pytest.approx(10.0 * model.pairs.length[alone], rel=1e-6)


KINKED = [[(10, 25), (18, 30), (24, 29), (31, 36)], [(24, 29), (27, 18)]]


def test_nothing_overlaps_and_no_face_pulls():
    free, held = solved(KINKED, -10.0, contact=False), solved(KINKED, -10.0)
    gap, force = gap_and_force(held)
    scale = np.abs(free.opening).max()
    assert gap_and_force(free)[0].min() < -0.1 * scale < -1e-6 * scale < gap.min()
    assert 0 < held.touching.sum() < len(held.touching)
    assert np.abs(gap[held.touching]).max() < 1e-9 * scale
    # of nodes with two directions across the force has a share in both
    single = (held.pairs.nodes[:, None] == held.pairs.nodes).any(axis=-1).sum(axis=1) == 1
    assert force[single & held.touching].min() > 0
    assert np.abs(force[single & ~held.touching]).max() < 1e-6 * force.max()


def test_contact_costs_compliance():
    """Of all displacements without overlap the true ones have the least energy: free faces yield more."""
    free, held = (solved(KINKED, -10.0, contact) for contact in (False, True))
    uncracked = solved([], -10.0)
    free, held, uncracked = (float(np.sum(m.load.force * m.u)) for m in (free, held, uncracked))
    assert uncracked < held < free


def test_where_all_is_open_contact_changes_no_bit():
    free, held = (solved(KINKED[:1], 10.0, contact) for contact in (False, True))
    assert np.array_equal(free.u, held.u) and not held.touching.any()


def test_pieces_that_the_load_carries_away_are_not_held():
    with pytest.raises(ValueError, match="none can be held by contact"):
        solved([[(0, 30), (40, 30)]], 10.0)
