"""The uncracked part on voxels: stress at surfaces within its estimate, by conditions of all kinds."""

import numpy as np
import pytest

from slmm import Scene, failure_indices
from slmm.boundary.model import BoundaryModel
from slmm.initiation.part_voxels import COVERED, COVERED_CRACKED, solve_part


def pulled(**tables):
    return Scene.from_dict(
        {
            "plate": {"width": 40.0, "height": 40.0},
            "holes": [{"shape": "circle", "center": [18.0, 21.0], "radius": 6.0}],
            "material": {"name": "PMMA"},
            "boundary": [
                {"on": "bottom", "displacement": ["free", 0.0]},
                {"on": "top", "traction": [0.0, 5.0]},
            ],
            **tables,
        }
    )


def around(n, radius=6.0):
    t = np.linspace(0.0, 2 * np.pi, n, endpoint=False)
    return np.column_stack([18.0 + radius * np.cos(t), 21.0 + radius * np.sin(t)])


def test_stress_at_a_hole_is_within_its_estimate_and_converges():
    scene = pulled()
    exact = BoundaryModel(scene.part, scene.material, scene.loading, 12).stress(around(12))
    largest = np.abs(exact).max()
    gaps = []
    for voxels in (10_000, 40_000):
        stress, error = solve_part(scene, voxels, 1e-6).stress(around(12))
        gap = np.abs(stress - exact).max(axis=1)
        assert (gap <= error + 1e-3 * largest).all()
        gaps.append(gap.max() / largest)
    assert gaps[0] < 0.03
    assert gaps[1] < 0.5 * gaps[0]


def test_cracks_widen_the_estimate():
    cracked = pulled(cracks=[{"points": [[0.0, 10.0], [6.0, 12.0]]}])
    field, other = solve_part(cracked, 4_000, 1e-6), solve_part(pulled(), 4_000, 1e-6)
    assert (field.covered, other.covered) == (COVERED_CRACKED, COVERED)
    assert field.density.sum() < other.density.sum()


def test_displacements_are_those_of_the_nodes_wherever_the_part_lies():
    moved = Scene.from_dict(
        {
            "part": {"outline": {"shape": "rectangle", "center": [-50.0, 30.0], "size": [20.0, 10.0],
                                 "corner_radius": 0.0}},
            "material": {"name": "PMMA"},
            "boundary": [
                {"from": [-60.0, 35.0], "to": [-60.0, 25.0], "displacement": [0.0, "free"]},
                {"from": [-40.0, 25.0], "to": [-40.0, 35.0], "traction": [6.0, 0.0]},
            ],
        }
    )  # fmt: skip
    field = solve_part(moved, 2_000, 1e-6)
    x = np.array([[-55.0, 30.0], [-41.3, 27.1]])
    wanted = 6.0 / moved.material.E * (x[:, 0] + 60.0)
    np.testing.assert_allclose(field.displacement(x)[:, 0], wanted, rtol=1e-6)
    assert field.raster.origin == (-60.0, 25.0)


@pytest.mark.parametrize("criterion", ["rankine", "point"])
def test_indices_by_voxels_agree_with_those_by_boundary_integrals(criterion):
    scene = pulled(analysis={"points": around(4)[::2].tolist()})  # where it is pulled most
    lines, voxels = (
        failure_indices(scene.with_(analysis={"local_model": model}), criterion)
        for model in ("boundary", "voxels")
    )
    assert voxels.attrs["local_model"] == "voxels"
    gap = np.abs(lines.failure_index - voxels.failure_index)
    told = lines.failure_index_error + voxels.failure_index_error
    assert bool((gap <= told + 1e-3 * float(lines.failure_index.max())).all())
