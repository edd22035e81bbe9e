"""Rigid bodies on a part's surface: uniform motion, beams, superposition, cracks, and agreement with a mesh."""

import numpy as np
import pytest
from stiff_scenes import HEIGHT, LENGTH, THICKNESS, bar

from slmm.boundary.model import BoundaryModel
from slmm.scene.scene import Scene


def solved(scene, p=10):
    return BoundaryModel(scene.part, scene.material, scene.loading, p)


def ends(placed):
    return placed((LENGTH, 0.5), (LENGTH, 5.0), (LENGTH, 9.5))


def test_under_a_force_it_moves_as_by_the_displacement_with_that_resultant():
    scene, placed = bar(force=[400.0, 0.0])
    model = solved(scene)
    u = model.displacement(ends(placed))
    np.testing.assert_allclose(u, np.tile(u[:1], (3, 1)), atol=1e-8 * abs(u[0, 0]))
    given = [
        {"from": [0, HEIGHT], "to": [0, 0], "displacement": [0.0, 0.0]},
        {"from": [LENGTH, 0], "to": [LENGTH, HEIGHT], "displacement": u[1].tolist()},
    ]
    moved = solved(scene.with_(boundary=given))
    force = moved.reaction(moved.body.loading.conditions[1])
    np.testing.assert_allclose(force, [400.0 / THICKNESS, 0.0], atol=1e-5)
    np.testing.assert_allclose(model.hoop, moved.hoop, atol=1e-6 * np.abs(moved.hoop).max())


def test_under_a_moment_it_turns_as_a_beam():
    """Pure bending; the clamped end stiffens less than a percent of a bar six times as long as high."""
    moment = 500.0
    scene, placed = bar(force=[0.0, 0.0], moment=moment)
    (low, middle, high) = solved(scene).displacement(ends(placed))
    beam = moment / (scene.material.E * THICKNESS * HEIGHT**3 / 12)
    assert (low[0] - high[0]) / 9.0 == pytest.approx(beam * LENGTH, rel=1e-2)
    assert middle[1] == pytest.approx(beam * LENGTH**2 / 2, rel=1e-2)


def test_an_eccentric_force_is_a_force_and_its_moment():
    """Superposition: also of a rotation that is given, and of both stretches' motions."""
    whole, by_force, by_moment = (
        solved(bar(hole=True, **acts)[0])
        for acts in (
            {"force": [300.0, 50.0], "moment": -700.0},
            {"force": [300.0, 50.0]},
            {"force": [0.0, 0.0], "moment": -700.0},
        )
    )
    np.testing.assert_allclose(
        whole.hoop, by_force.hoop + by_moment.hoop, atol=1e-8 * np.abs(whole.hoop).max()
    )


def test_turned_it_is_the_same():
    (one, _), (other, _) = bar(hole=True, force=[0.0, 80.0]), bar(np.pi / 2, hole=True, force=[-80.0, 0.0])
    largest = np.abs(solved(one).hoop).max()
    assert np.abs(solved(other).hoop).max() == pytest.approx(largest, rel=1e-8)


def test_a_rotation_that_is_given_needs_its_moment_and_no_force():
    scene, placed = bar(displacement=[0.0, "free"], rotation=0.5)
    model = solved(scene)
    low, _, high = model.displacement(ends(placed))
    assert (low[0] - high[0]) / 9.0 == pytest.approx(np.radians(0.5), rel=1e-8)
    assert abs(model.reaction(scene.loading.conditions[1])[1]) < 1e-8


def test_a_crack_that_opens_lets_it_turn():
    """K of an edge crack in a strip between a wall and a bar that is pulled; held straight it is lower."""
    tables = {
        "plate": {"width": 20.0, "height": 60.0},
        "cracks": [{"points": [[0.0, 30.0], [8.0, 30.0]]}],
        "material": {"name": "PMMA"},
    }
    bottom = {"on": "bottom", "displacement": [0.0, 0.0]}
    free, straight = (
        solved(
            Scene.from_dict(
                {**tables, "boundary": [bottom, {"on": "top", "stiff": True, "force": [0.0, 200.0], **more}]}
            )
        )
        for more in ({}, {"rotation": 0.0})
    )
    K, held = free.stress_intensities()[0, 0], straight.stress_intensities()[0, 0]
    # Tada's strip in tension whose ends turn freely
    x = 0.4
    F = 1.122 - 0.231 * x + 10.55 * x**2 - 21.71 * x**3 + 30.382 * x**4
    assert pytest.approx(10.0 * np.sqrt(np.pi * 8.0) * F, rel=0.01) == K
    assert held < 0.95 * K
    grown = free.with_cracks_of(free.part.grown(0, (9.0, 30.0)))
    fresh = BoundaryModel(grown.part, grown.body.material, grown.body.loading, 10)
    np.testing.assert_allclose(grown.stress_intensities(), fresh.stress_intensities(), rtol=1e-9)


@pytest.mark.parametrize(
    "acts", [{"force": [300.0, 100.0], "moment": 500.0}, {"displacement": [0.1, "free"]}]
)
def test_a_body_fitted_mesh_agrees(acts):
    pytest.importorskip("netgen")
    from slmm.fem.mesh import plate_mesh
    from slmm.fem.plate_model import PlateModel

    scene, placed = bar(0.4, True, 30.0, **acts)
    model = solved(scene)
    mesh = PlateModel(
        plate_mesh(scene.part, nodes_at=scene.loading.ends).refined(), scene.material, scene.loading
    )
    points = placed((30.0, 1.0), (30.0, 9.0), (15.0, 8.0), (10.0, 4.0))
    u = model.displacement(points)
    np.testing.assert_allclose(mesh.displacement(points), u, atol=2e-3 * np.abs(u).max())
    pulled = scene.loading.conditions[1]
    np.testing.assert_allclose(mesh.reaction(pulled), model.reaction(pulled), atol=0.1)
