"""Results of other programs as scenes: the failure index of the part itself, within what its mesh leaves open."""

import numpy as np
import pytest

from slmm import Material, Scene, failure_indices
from slmm.initiation.solved_scene import solved_scene
from slmm.results.field import DisplacementField
from tests.solved_plates import SIDE, ring, solved, stretched, triangles, with_middles

PMMA = Material.from_name("PMMA")
AT = {"analysis": {"points": [[12.0, 10.0]], "method": "boundary"}}


@pytest.fixture(scope="module")
def exact():
    """Failure index at the side of the hole of the plate that `stretched` moves."""
    hole = {"shape": "circle", "center": [10.0, 10.0], "radius": 2.0}
    plate = {"plate": {"width": SIDE, "height": SIDE}, "holes": [hole], "material": {"name": "PMMA"}}
    return float(
        failure_indices(Scene.from_dict({**plate, "load": {"displacement": 0.05}, **AT})).failure_index[0]
    )


def at_side(scene):
    return failure_indices(scene.with_(**AT))


@pytest.mark.parametrize(
    ("kind", "around", "within"), [("triangle", 16, 0.1), ("quad", 40, 0.02), ("quad8", 24, 2e-3)]
)
def test_the_index_of_a_moved_plate(kind, around, within, exact):
    """What moves it is known exactly: even of few linear elements hardly anything is lost at the hole."""
    points, quads = ring(around, 5)
    cells = {"triangle": triangles(quads)} if kind == "triangle" else {"quad": quads}
    if kind == "quad8":
        points, nodes = with_middles(points, quads, 2.0)
        cells = {"quad8": nodes}
    result = at_side(solved_scene(stretched(points, cells, PMMA), PMMA))
    value, error = float(result.failure_index[0]), float(result.failure_index_error[0])
    assert abs(value - exact) < error
    assert error < within * exact


def test_loads_are_where_the_plate_is_moved():
    points, quads = ring(16, 4)
    scene = solved_scene(stretched(points, {"quad": quads}, PMMA), PMMA)
    held = sorted((condition.start[1], condition.end[1], condition.is_held) for condition in scene.loading)
    assert held == [(0.0, 0.0, (False, True)), (SIDE, SIDE, (False, True))]
    _, upper = sorted(scene.loading, key=lambda condition: condition.start[1])
    at = np.array([[3.0, SIDE], [17.0, SIDE]])
    assert upper.displacement[1](at) == pytest.approx([0.05, 0.05], rel=1e-9)


def test_what_is_not_elastic_is_refused():
    points, quads = ring(16, 4)
    field = stretched(points, {"quad": quads}, PMMA)
    heated = DisplacementField(points, field.cells, field.u + 1e-3 * points * (points[:, 1:] / SIDE) ** 2)
    with pytest.raises(ValueError, match="act on nodes inside the part"):
        solved_scene(heated, PMMA)
    with pytest.raises(ValueError, match="there is no load"):
        solved_scene(DisplacementField(points, field.cells, np.full_like(points, 0.1)), PMMA)


@pytest.mark.parametrize("state", ["plane stress", "plane strain"])
def test_the_other_state_is_refused_with_the_right_one(state):
    right = Material.from_name("PMMA", state)
    (wrong,) = {"plane stress", "plane strain"} - {state}
    points, quads = ring(16, 4)
    field = stretched(points, {"quad": quads}, right)
    assert solved_scene(field, right).material.state == state
    with pytest.raises(ValueError, match=f"in balance in {state}.*give the material in {state}"):
        solved_scene(field, Material.from_name("PMMA", wrong))


def test_under_forces_coarse_triangles_lose_nothing():
    """Displacements are too small by what the mesh is too stiff, 5 %; the forces are those of the plate."""
    points, quads = ring(24, 4)
    cells = {"triangle": triangles(quads)}
    force = np.zeros_like(points)
    for y, sign in ((0.0, -10.0), (SIDE, 10.0)):
        edge = np.flatnonzero(np.abs(points[:, 1] - y) < 1e-9)
        edge = edge[np.argsort(points[edge, 0])]
        length = np.diff(points[edge, 0])
        force[edge[:-1], 1] += 0.5 * sign * length
        force[edge[1:], 1] += 0.5 * sign * length
    left, right = (int(np.argmin(np.hypot(*(points - [x, 0.0]).T))) for x in (0.0, SIDE))
    held = np.array([2 * left, 2 * left + 1, 2 * right + 1])
    result = at_side(solved_scene(solved(points, cells, PMMA, held, np.zeros(3), force), PMMA))
    hole = {"shape": "circle", "center": [10.0, 10.0], "radius": 2.0}
    plate = {"plate": {"width": SIDE, "height": SIDE}, "holes": [hole], "material": {"name": "PMMA"}}
    own = failure_indices(Scene.from_dict({**plate, "load": {"stress": 10.0}, **AT}))
    index, wanted = float(result.failure_index[0]), float(own.failure_index[0])
    assert float(result.model_error[0]) > 0.02
    assert abs(index - wanted) < 1e-3 * wanted


def test_gravity_is_refused_on_fine_meshes_too():
    """Each node inside bears little of it there; a plate that is held on top and nowhere moved takes no work at all."""
    points, quads = ring(40, 10)
    ends = points[quads[:, 2:]] - points[quads[:, :2]]
    weight = 0.5 * np.abs(ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 0, 1] * ends[:, 1, 0])
    force = np.zeros_like(points)
    np.add.at(force[:, 1], quads.ravel(), np.repeat(-0.25 * weight, 4))
    top = np.flatnonzero(points[:, 1] == SIDE)
    held = np.concatenate([2 * top, 2 * top + 1])
    hanging = solved(points, {"quad": quads}, PMMA, held, np.zeros(len(held)), force)
    with pytest.raises(ValueError, match="gravity"):
        at_side(solved_scene(hanging, PMMA))


def test_a_model_needs_its_material_and_no_scene():
    with pytest.raises(ValueError, match="a model needs its material"):
        failure_indices(model="tests/data/plate_2d.frd")
    with pytest.raises(ValueError, match="takes a scene or a model"):
        failure_indices()


def test_calculix():
    """The plate of tests/data/README.md against the scene itself; six digits of the file cost 1e-3."""
    hole = {"shape": "circle", "center": [10.0, 10.0], "radius": 2.0}
    plate = {"plate": {"width": SIDE, "height": SIDE}, "holes": [hole], "material": {"name": "PMMA"}}
    own = failure_indices(Scene.from_dict({**plate, "load": {"strain": [0.0, 0.01, 0.0]}, **AT}))
    result = at_side(solved_scene("tests/data/plate_2d.frd", "PMMA"))
    assert result.attrs["title"] == "plate_2d.frd"
    assert float(result.failure_index[0]) == pytest.approx(float(own.failure_index[0]), rel=1e-3)
    assert abs(float(result.failure_index[0] - own.failure_index[0])) < float(result.failure_index_error[0])
