"""Loads on a part that has been solved under others: sums of voxel models, and one factorised boundary."""

import numpy as np
import pytest

from slmm.initiation.boundary_field import solve_boundary
from slmm.initiation.load_cases import LoadCases
from slmm.initiation.local_model import solve_local_model
from slmm.scene import gallery
from slmm.scene.scene import Scene

VOXELS = 3600


def under(strain):
    return gallery.circular_hole(load={"strain": strain})


def with_voxels(*strains):
    cases = LoadCases()
    for strain in strains:
        cases.keep(under(strain), {"voxels": (VOXELS, solve_local_model(under(strain), VOXELS))})
    return cases


def test_a_load_in_the_span_of_others_is_their_sum():
    cases = with_voxels([0.01, 0.0, 0.0], [0.0, 0.02, 0.0])
    scene = under([-0.02, 0.03, 0.0])
    voxels, local = cases.under(scene)["voxels"]
    own = solve_local_model(scene, VOXELS)
    assert voxels == VOXELS
    np.testing.assert_allclose(local.u, own.u, atol=1e-6 * np.abs(own.u).max())


def test_models_on_other_voxels_are_not_summed():
    cases = with_voxels([0.01, 0.0, 0.0])
    finer, other = 6400, [0.0, 0.02, 0.0]
    cases.keep(under(other), {"voxels": (finer, solve_local_model(under(other), finer))})
    assert "voxels" not in cases.under(under([-0.02, 0.03, 0.0]))
    voxels, local = cases.under(under([0.0, -0.01, 0.0]))["voxels"]
    own = solve_local_model(under([0.0, -0.01, 0.0]), finer)
    assert voxels == finer
    np.testing.assert_allclose(local.u, own.u, atol=1e-6 * np.abs(own.u).max())


@pytest.mark.parametrize("strain", [[0.0, 0.01, 0.01], [0.0, 0.0, 0.01]])
def test_another_load_is_not(strain):
    assert "voxels" not in with_voxels([0.01, 0.0, 0.0], [0.0, 0.02, 0.0]).under(under(strain))


def test_nor_is_a_small_difference_of_large_loads():
    cases = with_voxels([0.01, 0.0, 0.0], [0.01, 1e-5, 0.0])
    assert "voxels" not in cases.under(under([0.0, 0.01, 0.0]))


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ({"strain": [0.0, 0.1, 0.0]}, {"strain": [0.02, 0.05, -0.03]}),
        ({"stress": 10.0}, {"stress": -3.0}),
        ({"displacement": 1.0}, {"displacement": -0.5}),
    ],
)
def test_the_factorised_part_serves_other_loads(before, after):
    cases = LoadCases()
    field = solve_boundary(gallery.circular_hole(load=before))
    cases.keep(gallery.circular_hole(load=before), {"boundary": field})
    scene = gallery.circular_hole(load=after)
    found, own = cases.under(scene)["boundary"], solve_boundary(scene)
    assert found.model.body.base.solver is field.model.body.base.solver
    points = np.array([[70.0, 50.0], [50.0, 70.0], [64.2, 64.2], [72.0, 50.0]])
    expected = own.stress(points)[0]
    np.testing.assert_allclose(found.stress(points)[0], expected, atol=1e-9 * np.abs(expected).max())


def test_loads_on_other_stretches_are_factorised_anew():
    field = solve_boundary(gallery.circular_hole(load={"stress": 10.0}))
    scene = gallery.circular_hole(load={"strain": [0.0, 0.1, 0.0]})
    other, own = field.under(scene.loading), solve_boundary(scene)
    assert other.model.body.base.solver is not field.model.body.base.solver
    np.testing.assert_allclose(other.model.hoop, own.model.hoop, rtol=1e-9, atol=1e-6)


def pinned(across):
    """A plate that is held below and pulled up by a pin in its hole, which pulls to the right as well."""
    return Scene.from_dict(
        {
            "plate": {"width": 100.0, "height": 100.0},
            "holes": [{"shape": "circle", "center": [50.0, 60.0], "radius": 15.0}],
            "material": {"name": "PMMA"},
            "boundary": [
                {"from": [0.0, 0.0], "to": [100.0, 0.0], "displacement": [0.0, 0.0]},
                {"on": "hole 0", "pin": [across, 100.0]},
            ],
        }
    )


def test_a_pin_that_presses_another_way_is_factorised_anew():
    """Its pressure ends elsewhere, and panels with it."""
    field, turned = solve_boundary(pinned(0.0)), pinned(0.5)
    other, own = field.under(turned.loading), solve_boundary(turned)
    assert other.model.body.base.solver is not field.model.body.base.solver
    np.testing.assert_allclose(other.model.hoop, own.model.hoop, atol=1e-9 * np.abs(own.model.hoop).max())
