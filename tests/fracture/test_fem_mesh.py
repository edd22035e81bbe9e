"""Meshes for cracks that grow: fine at tips, found at once, and tried with other sizes where the mesher fails."""

import numpy as np
import pytest

import slmm.fem.mesh
from slmm.fem.triangulation import MesherError
from slmm.fracture import fem_mesh
from slmm.fracture.fem_mesh import APART, AT_TIP, SMALL, clear_radii, crack_mesh
from slmm.scene.gallery import tensile_plate

pytest.importorskip("netgen")

DEPTH = 0.123
#: a crack after some increments of 2 mm, the last of them close above a hole
BENT = [[0, 40], [10, 40], [12, 40.4], [14, 41.2], [16, 42.1], [18, 42.6], [20, 42.8], [22, 42.9]]


def test_what_is_clear_ends_at_surfaces_kinks_and_other_cracks():
    plate = tensile_plate([(24.0, 38.0, 4.0)], cracks=[{"points": BENT}]).part
    assert clear_radii(plate) == pytest.approx([np.hypot(2.0, 4.9) - 4.0], abs=1e-4)
    straight = [{"points": [[0, 40], [10, 40], [12, 40], [14, 40]]}]
    assert clear_radii(tensile_plate(cracks=straight).part) == pytest.approx([14.0])
    two = [{"points": [[20, 40], [30, 40]]}, {"points": [[33, 44], [33, 60]]}]
    assert clear_radii(tensile_plate(cracks=two).part) == pytest.approx([10.0, 5.0, 5.0, 16.0])


def test_elements_at_a_tip_are_a_share_of_what_is_clear():
    scene = tensile_plate([(24.0, 38.0, 4.0)], cracks=[{"points": BENT}])
    for fineness in (1.0, 0.5):
        mesh = crack_mesh(scene.part, scene.loading, DEPTH, fineness)
        tip = np.linalg.norm(mesh.vertices - BENT[-1], axis=1).argmin()
        around = mesh.vertices[mesh.triangles[(mesh.triangles == tip).any(axis=1)]]
        edges = np.linalg.norm(around - np.roll(around, 1, axis=1), axis=-1)
        wanted = fineness * min(clear_radii(scene.part)[0] / AT_TIP, 80.0 / SMALL)
        assert 0.5 < edges.mean() / wanted < 2.0


def test_edges_of_cracks_differ_little_from_their_neighbours_and_are_not_cut(monkeypatch):
    calls, triangulated = [], slmm.fem.mesh.triangulated

    def counted(*arguments):
        calls.append(arguments)
        return triangulated(*arguments)

    monkeypatch.setattr(slmm.fem.mesh, "triangulated", counted)
    for n in range(3, len(BENT) + 1):
        scene = tensile_plate([(24.0, 38.0, 4.0)], cracks=[{"points": BENT[:n]}])
        mesh = crack_mesh(scene.part, scene.loading, DEPTH)
        step = np.linalg.norm(np.diff(mesh.vertices[mesh.cracks[0]], axis=0), axis=1)
        assert (np.maximum(step[1:], step[:-1]) / np.minimum(step[1:], step[:-1])).max() < 1.1 * APART
    assert len(calls) == len(BENT) - 2


def test_a_crack_that_runs_along_a_hole_has_elements_as_small_as_the_gap():
    along = [[0, 40], [10, 43], [20, 44.5], [24, 44.5], [34, 44.5]]
    scene = tensile_plate([(24.0, 40.0, 4.0)], cracks=[{"points": along}])
    mesh = crack_mesh(scene.part, scene.loading, DEPTH)
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    between = (np.abs(middle[:, 0] - 24) < 1) & (middle[:, 1] > 44) & (middle[:, 1] < 44.5)
    a, b, c = mesh.vertices[mesh.triangles[between]].swapaxes(0, 1)
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert np.sqrt(area.max()) < 0.5


def test_other_sizes_are_tried_where_the_mesher_fails(monkeypatch):
    scene, largest, plate_mesh = tensile_plate(), [], slmm.fem.mesh.plate_mesh

    def fails_twice(part, path, policy, fine_at, nodes_at):
        largest.append(policy.largest)
        if len(largest) < 3:
            raise MesherError("the mesher failed: no reason")
        return plate_mesh(part, path, policy, fine_at, nodes_at)

    monkeypatch.setattr(fem_mesh, "plate_mesh", fails_twice)
    assert len(crack_mesh(scene.part, scene.loading, DEPTH).triangles)
    assert len(set(largest)) == 3

    def fails(*arguments):
        raise MesherError("the mesher failed: no reason")

    monkeypatch.setattr(fem_mesh, "plate_mesh", fails)
    with pytest.raises(MesherError, match=r"no reason, nor with elements 0.8, 1.25, 0.6 times as large"):
        crack_mesh(scene.part, scene.loading, DEPTH)


def test_cracks_that_cross_where_their_nearness_is_sampled_have_a_mesh():
    lines = [[[0, 40], [20.1, 40]], [[20, 33], [20, 49]]]
    scene = tensile_plate(cracks=[{"points": line} for line in lines])
    mesh = crack_mesh(scene.part, scene.loading, DEPTH)
    assert np.linalg.norm(mesh.vertices - [20.0, 40.0], axis=1).min() < 1e-9
    assert len(mesh.vertices) < 10_000
