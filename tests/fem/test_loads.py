"""Conditions on the nodes of a mesh: supports where motions are free, pieces that drift away, reactions."""

import numpy as np
import pytest

pytest.importorskip("netgen")

from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.mechanics.material import Material
from slmm.part.part import Part
from slmm.scene.loading import Affine, Condition, Loading, plate_edges, plate_loading

PMMA = Material.from_name("PMMA")
BOTTOM, RIGHT, TOP, LEFT = plate_edges(40.0, 20.0)
PULL = (Condition(*BOTTOM, traction=(0.0, -1.0)), Condition(*TOP, traction=(0.0, 1.0)))


def solved(loading, *cracks):
    return PlateModel(
        plate_mesh(Part.plate(40.0, 20.0, cracks=cracks), policy=SizePolicy(largest=4.0)), PMMA, loading
    )


@pytest.mark.parametrize(
    ("conditions", "supports"),
    [
        (PULL, 3),
        ((Condition(*LEFT, (Affine(), None)), *PULL), 1),
        ((Condition(*LEFT, (Affine(), Affine())), *PULL), 0),
        ((Condition(*BOTTOM, (None, Affine())), PULL[1]), 1),
    ],
)
def test_what_is_free_gets_a_support_and_no_more(conditions, supports):
    model = solved(Loading(conditions))
    assert model.load.supports.sum() == supports
    residual = (model.K @ model.u.ravel()).reshape(-1, 2) - model.load.force
    assert np.abs(residual[model.load.supports]).max(initial=0.0) < 1e-9 * np.abs(model.load.force).sum()


def test_symmetry_on_two_edges_is_uniform_tension():
    loading = Loading((Condition(*LEFT, (Affine(), None)), Condition(*BOTTOM, (None, Affine())), PULL[1]))
    model = solved(loading)
    assert not model.load.supports.any()
    assert model.nodal_stress == pytest.approx(np.tile([0.0, 1.0, 0.0], (len(model.points), 1)), abs=1e-9)


def test_a_reaction_is_the_force_on_the_part():
    loading = plate_loading(40.0, 20.0, displacement=0.02)
    bottom, top = loading
    model = solved(loading)
    assert model.reaction(top) == pytest.approx([0.0, PMMA.E * 0.001 * 40.0], rel=1e-9, abs=1e-6)
    assert model.reaction(bottom) == pytest.approx(-model.reaction(top), abs=1e-6)
    pulled = solved(Loading(PULL))
    assert pulled.reaction(PULL[1]) == pytest.approx([0.0, 40.0])


def test_forces_that_do_not_balance_are_refused_with_what_is_left():
    with pytest.raises(ValueError, match=r"does not balance: forces of \(0, 40\) N"):
        solved(Loading(PULL[1:]))


def test_a_piece_that_nothing_loads_stays_where_it_is():
    corner = [(0, 15), (5, 20)]
    model = solved(plate_loading(40.0, 20.0, strain=(0.0, 0.0, 0.0)), corner)
    assert not model.is_carried_away and np.abs(model.u).max() == 0.0
    # a chip out of the free side
    chip = [(0, 12), (5, 10)], [(5, 10), (0, 8)]
    model = solved(plate_loading(40.0, 20.0, displacement=0.02), *chip)
    assert not model.is_carried_away and np.isfinite(model.u).all()
    inside = np.array([[1.0, 10.0]])
    assert np.abs(model.stress(inside)).max() < 1e-9
    assert solved(plate_loading(40.0, 20.0, displacement=0.02)).stress(inside)[0, 1] > 1.0


def test_a_piece_that_the_load_carries_away_has_no_displacements():
    model = solved(Loading(PULL), [(0, 10), (40, 10)])
    assert model.is_carried_away and np.isnan(model.u).all()
