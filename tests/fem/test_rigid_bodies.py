"""Rigid bodies on body-fitted models: nodes that follow, and cracks that open beside them."""

import numpy as np
import pytest

from slmm.scene.scene import Scene

pytest.importorskip("netgen")

from slmm.boundary.model import BoundaryModel
from slmm.fem.element_size import SizePolicy
from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel, SlitModel


def strip(**moved):
    return Scene.from_dict(
        {
            "plate": {"width": 20.0, "height": 40.0},
            "material": {"name": "PMMA"},
            "boundary": [
                {"on": "bottom", "displacement": [0.0, 0.0]},
                {"on": "top", "stiff": True, **moved},
            ],
        }
    )


def test_its_nodes_move_as_one_body_and_its_reaction_is_the_force():
    scene = strip(force=[100.0, 400.0], moment=900.0)
    model = PlateModel(plate_mesh(scene.part), scene.material, scene.loading)
    top = model.points[:, 1] == 40.0
    x, u = model.points[top, 0], model.u[top]
    assert np.ptp(u[:, 0]) < 1e-12
    slope, start = np.polyfit(x, u[:, 1], 1)
    np.testing.assert_allclose(u[:, 1], start + slope * x, atol=1e-12)
    np.testing.assert_allclose(model.reaction(scene.loading.conditions[1]), [100.0, 400.0], rtol=1e-8)


def test_a_trial_crack_releases_what_the_work_of_the_force_says():
    """Half of what the force's work changes by, by boundary integrals; meshes converge to it in the first order."""
    scene = strip(force=[0.0, 400.0])
    line = np.array([[0.0, 20.0], [6.0, 20.0]])
    coarse, fine = (
        SlitModel(
            plate_mesh(scene.part, line, SizePolicy(size)), scene.material, scene.loading
        ).released_energy()[-1]
        for size in (1.0, 0.5)
    )
    cracked = scene.with_(cracks=[{"points": line.tolist()}])
    closed, opened = (BoundaryModel(each.part, each.material, each.loading).work for each in (scene, cracked))
    assert 2 * fine - coarse == pytest.approx(0.5 * (opened - closed), rel=5e-3)
