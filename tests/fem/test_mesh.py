import sys

import numpy as np
import pytest
import shapely

from slmm.fem.element_size import SIZE_GROWTH, SizePolicy
from slmm.fem.mesh import PlateMesh, plate_mesh
from slmm.fem.triangulation import MesherError, triangulated
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle, ellipse, rectangle

pytest.importorskip("netgen")


def hole(center, radius):
    return Outline.through(circle(center, radius))


def areas(mesh: PlateMesh) -> np.ndarray:
    corner = mesh.vertices[mesh.triangles]
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2


def path_from(start, direction, depths):
    return np.asarray(start, dtype=float) + np.asarray(depths)[:, None] * np.asarray(direction, dtype=float)


def test_refining_brings_the_mesh_to_the_true_area():
    mesh = plate_mesh(Part.plate(100.0, 80.0, [hole((50, 40), 20)]))
    true = 100 * 80 - np.pi * 20**2
    errors = []
    for _ in range(3):
        assert np.all(areas(mesh) > 0)
        errors.append(areas(mesh).sum() - true)
        mesh = mesh.refined()
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.05)


def test_refined_notch_vertices_lie_on_the_curve():
    mesh = plate_mesh(Part.plate(100.0, 80.0, [hole((50, 40), 20)])).refined().refined()
    on_edge = np.linalg.norm(mesh.vertices[mesh.edges] - (50, 40), axis=-1)
    assert on_edge == pytest.approx(20, abs=1e-6)
    assert np.linalg.norm(mesh.edge_midpoints() - (50, 40), axis=-1) == pytest.approx(20, abs=1e-6)


def test_path_nodes_are_vertices_and_edges_of_the_mesh():
    depths = np.concatenate([np.linspace(0, 0.1, 9)[:-1], np.geomspace(0.1, 10, 30)])
    path = path_from((70, 40), (1, 0), depths)
    mesh = plate_mesh(Part.plate(100.0, 80.0, [hole((50, 40), 20)]), path)
    assert np.array_equal(mesh.vertices[mesh.path], path)
    corner_pairs = {
        frozenset(map(int, t[[i, j]])) for t in mesh.triangles for i, j in ((0, 1), (1, 2), (2, 0))
    }
    assert all(
        frozenset((int(i), int(j))) in corner_pairs for i, j in zip(mesh.path, mesh.path[1:], strict=False)
    )
    fine = mesh.refined()
    assert np.array_equal(fine.vertices[fine.path[::2]], path)
    assert np.allclose(fine.vertices[fine.path[1::2]], (path[1:] + path[:-1]) / 2)


@pytest.mark.parametrize("s_share", [0.0, 0.13, 0.41, 0.77])
def test_path_may_start_anywhere_on_an_ellipse(s_share):
    outline = Outline.through(ellipse((50, 50), (20, 5), 30.0))
    s = s_share * outline.length
    path = path_from(outline.points(s), outline.normals(s), np.geomspace(1, 3, 12) - 1)
    mesh = plate_mesh(Part.plate(100.0, 100.0, [outline]), path)
    assert np.allclose(mesh.vertices[mesh.path], path, atol=1e-9)


@pytest.mark.parametrize(
    "outlines",
    [
        [hole((0, 30), 25)],
        [hole((0, 0), 30), hole((100, 80), 30)],
        [hole((40, 40), 15), hole((60, 45), 15)],
        [hole((50, 40), 15), hole((81, 40), 15.5)],
        [Outline.through(rectangle((10, 40), (60, 8), 3.0)), hole((70, 82), 20)],
    ],
    ids=["edge notch", "corners", "holes that overlap", "half a millimetre apart", "long edge notch"],
)
def test_outlines_may_cut_edges_and_each_other(outlines):
    body = shapely.box(0, 0, 100, 80).difference(
        shapely.union_all([shapely.Polygon(outline.polygon(4000)) for outline in outlines])
    )
    mesh = plate_mesh(Part.plate(100.0, 80.0, outlines))
    for _ in range(3):
        mesh = mesh.refined()
    assert np.all(areas(mesh) > 0)
    assert areas(mesh).sum() == pytest.approx(body.area, rel=1e-4)


def test_path_from_the_mouth_of_an_edge_notch():
    outline = hole((0, 30), 25)
    path = path_from((25, 30), (1, 0), np.linspace(0, 5, 11))
    mesh = plate_mesh(Part.plate(100.0, 80.0, [outline]), path)
    assert np.allclose(mesh.vertices[mesh.path], path, atol=1e-9)


def test_a_crack_inside_the_plate_has_all_its_points_in_the_mesh_and_both_tips_fine():
    crack = np.array([[30.0, 20.0], [50.0, 30.0], [60.0, 50.0]])
    mesh = plate_mesh(Part.plate(100.0, 70.0, cracks=[crack]))
    (line,) = mesh.cracks
    points = mesh.vertices[line]
    for point in crack:
        assert np.linalg.norm(points - point, axis=1).min() < 1e-9
    # vertices of its own at both ends, and edges that are short there
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert max(step[0], step[-1]) < 0.02 * step.max()
    assert areas(mesh).sum() == pytest.approx(7000.0)


@pytest.mark.parametrize("radius", [5.0, 0.3466, 0.2955, 0.05, 0.0122, 0.005501])
@pytest.mark.parametrize("angle_max", [0.12, 0.18])
def test_elements_around_a_hole_grow_as_they_should_whatever_its_radius(radius, angle_max):
    """Left to itself the mesher lets them grow up to ten times too fast, for some of these radii."""
    mesh = plate_mesh(Part.plate(100.0, 100.0, [hole((30, 60), radius)]), policy=SizePolicy(turn=angle_max))
    corner = mesh.vertices[mesh.triangles]
    longest = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=-1).max(axis=1)
    away = np.linalg.norm(corner.mean(axis=1) - (30, 60), axis=1) - radius
    wanted = np.minimum(100 / 12, angle_max * radius + SIZE_GROWTH * np.maximum(away, 0.0))
    assert np.max(longest / wanted) < 3.0
    squares = ((corner - np.roll(corner, 1, axis=1)) ** 2).sum(axis=(1, 2))
    assert np.min(4 * np.sqrt(3) * areas(mesh) / squares) > 0.4  # 1 is equilateral


def test_a_path_much_coarser_than_its_hole_keeps_its_nodes_and_gets_more():
    outline = hole((50, 40), 0.005)
    path = path_from(outline.points(0.0), outline.normals(0.0), [0.0, 0.05, 0.06, 0.072, 0.0864, 0.1])
    mesh = plate_mesh(Part.plate(100.0, 80.0, [outline]), path)
    points = mesh.vertices[mesh.path]
    for point in path:
        assert np.linalg.norm(points - point, axis=1).min() == 0
    assert len(points) > 2 * len(path)


def test_the_mesher_is_asked_again_with_a_turned_body_and_the_nodes_stay_exact(monkeypatch):
    asked = []

    def moody(points, segments, n_boundary, size, turn):
        asked.append(turn)
        if len(asked) < 3:
            raise MesherError("the mesher failed: meshing failed")
        return triangulated(points, segments, n_boundary, size, turn)

    monkeypatch.setattr("slmm.fem.mesh.triangulated", moody)
    path = path_from((70, 40), (1, 0), np.linspace(0, 5, 11))
    mesh = plate_mesh(Part.plate(100.0, 80.0, [hole((50, 40), 20)]), path)
    assert len(set(asked)) == 3 and asked[0] == 0
    assert np.array_equal(mesh.vertices[mesh.path], path)
    corners = [(0, 0), (100, 0), (100, 80), (0, 80)]
    assert all((mesh.vertices == corner).all(axis=1).any() for corner in corners)
    assert np.all(areas(mesh) > 0)


def test_a_mesher_that_never_succeeds_is_named(monkeypatch):
    def never(*_):
        raise MesherError("the mesher failed: meshing failed")

    monkeypatch.setattr("slmm.fem.mesh.triangulated", never)
    with pytest.raises(MesherError, match="also of the body turned in 7 ways"):
        plate_mesh(Part.plate(10.0, 10.0))


def test_what_cannot_be_meshed_is_refused_by_name():
    outline = hole((50, 40), 20)
    with pytest.raises(ValueError, match="leaves 2 pieces"):
        plate_mesh(Part.plate(30.0, 30.0, [Outline.through(rectangle((15, 15), (40, 4), 1.0))]))
    with pytest.raises(ValueError, match="outside the material"):
        plate_mesh(Part.plate(100.0, 80.0, [outline]), path_from((70, 40), (-1, 0), [0.0, 1.0, 2.0]))
    with pytest.raises(ValueError, match=r"path\[0\] = \[71.0, 40.0\]"):
        plate_mesh(Part.plate(100.0, 80.0, [outline]), path_from((71, 40), (1, 0), [0.0, 1.0, 2.0]))


def test_without_netgen_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "netgen.geom2d", None)
    with pytest.raises(ImportError, match=r"pip install slmm\[fea\]"):
        plate_mesh(Part.plate(10.0, 10.0))
