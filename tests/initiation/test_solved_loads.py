"""What acts on a solved part: displacements where it was moved, the forces' own resultants where it was pulled."""

import numpy as np
import pytest

from slmm import Material
from slmm.initiation.solved_loads import solved_loads
from slmm.results.outlines import mesh_outlines
from slmm.results.surface_forces import surface_forces
from tests.solved_plates import SIDE, ring, solved, stretched, triangles, with_middles

PMMA = Material.from_name("PMMA")


def conditions(field):
    rings = mesh_outlines(field)
    nodes = np.concatenate([each.nodes for each in rings])
    return solved_loads(field, rings, surface_forces(field, PMMA, nodes))


def resultant(condition):
    at, traction, weight = condition.rule
    moment = at[:, 0] * traction[:, 1] - at[:, 1] * traction[:, 0]
    return np.array([*(weight @ traction), weight @ moment])


def plate(kind, around=16):
    points, quads = ring(around, 3)
    if kind == "quad8":
        points, nodes = with_middles(points, quads, 2.0)
        return points, {"quad8": nodes}
    return points, {kind: triangles(quads) if kind == "triangle" else quads}


def pulled(points, cells, traction):
    """Under tractions that are functions of x along the top edge, held by three displacements without forces below."""
    force = np.zeros_like(points)
    top = np.flatnonzero(points[:, 1] == SIDE)
    top = top[np.argsort(points[top, 0])]
    step = 2 if "quad8" in cells else 1
    for k in range(0, len(top) - 1, step):
        own = top[[k, k + step]] if step == 1 else top[[k, k + 2, k + 1]]
        length = points[own[1], 0] - points[own[0], 0]
        xi, w = np.polynomial.legendre.leggauss(4)
        shape = [0.5 * (1 - xi), 0.5 * (1 + xi)]
        if step == 2:
            shape = [0.5 * xi * (xi - 1), 0.5 * xi * (xi + 1), 1 - xi**2]
        x = points[own[0], 0] + 0.5 * (1 + xi) * length
        for node, values in zip(own, shape, strict=True):
            force[node] += 0.5 * length * (w * values) @ np.column_stack(traction(x))
    bottom = np.flatnonzero(points[:, 1] == 0)
    held = np.concatenate([2 * bottom, 2 * bottom + 1])
    return solved(points, cells, PMMA, held, np.zeros(len(held)), force), force


def test_edges_that_are_moved_are_moved():
    points, cells = plate("quad")
    found = conditions(stretched(points, cells, PMMA))
    assert sorted((c.start[1], c.is_held, c.is_loaded) for c in found) == [
        (0.0, (False, True), False),
        (SIDE, (False, True), False),
    ]


@pytest.mark.parametrize("kind", ["triangle", "quad", "quad8"])
def test_a_uniform_traction_is_uniform_whatever_the_elements(kind):
    points, cells = plate(kind)
    field, _ = pulled(points, cells, lambda x: (0 * x + 2.0, 0 * x + 5.0))
    top, bottom = sorted(conditions(field), key=lambda c: -c.start[1])
    assert top.is_held == (False, False) and bottom.is_held == (True, True)
    at = np.column_stack([np.linspace(0.5, 19.5, 30), np.full(30, SIDE)])
    assert np.abs(top.tractions(at, top.outward(at)) - [2.0, 5.0]).max() < 1e-6


@pytest.mark.parametrize("kind", ["triangle", "quad8"])
def test_resultants_are_those_of_the_forces(kind):
    """A traction that rises as a parabola, and moments with it."""
    points, cells = plate(kind)
    field, force = pulled(points, cells, lambda x: (0.1 * x, (x / SIDE) ** 2))
    top = max(conditions(field), key=lambda c: c.start[1])
    wanted = [*force.sum(axis=0), (points[:, 0] * force[:, 1] - points[:, 1] * force[:, 0]).sum()]
    assert resultant(top) == pytest.approx(wanted, rel=1e-3)


def test_a_force_on_one_node_is_spread_over_the_edges_beside_it():
    points, cells = plate("quad8")
    force = np.zeros_like(points)
    node = int(np.argmin(np.hypot(*(points - [10.0, SIDE]).T)))
    force[node] = [3.0, -7.0]
    bottom = np.flatnonzero(points[:, 1] == 0)
    held = np.concatenate([2 * bottom, 2 * bottom + 1])
    field = solved(points, cells, PMMA, held, np.zeros(len(held)), force)
    top = max(conditions(field), key=lambda c: c.start[1])
    assert resultant(top)[:2] == pytest.approx([3.0, -7.0], rel=1e-4)
    assert top.length == pytest.approx(0.5 * SIDE)  # two edges of 5 mm


def test_loads_that_nothing_holds_balance():
    """A plate that is pulled at both ends, but for six digits of its displacements."""
    points, cells = plate("quad8")
    force = np.zeros_like(points)
    for y, sign in ((0.0, -1), (SIDE, 1)):
        edge = np.flatnonzero(points[:, 1] == y)
        edge = edge[np.argsort(points[edge, 0])]
        length = np.diff(points[edge[::2], 0])
        force[edge[:-1:2], 1] += sign * length / 6
        force[edge[2::2], 1] += sign * length / 6
        force[edge[1::2], 1] += sign * length * 4 / 6
    left = int(np.argmin(np.hypot(*points.T)))
    right = int(np.argmin(np.hypot(*(points - [SIDE, 0]).T)))
    field = solved(points, cells, PMMA, np.array([2 * left, 2 * left + 1, 2 * right + 1]), np.zeros(3), force)
    rounded = type(field)(
        field.points, field.cells, np.array([[float(f"{v:.5e}") for v in row] for row in field.u])
    )
    found = conditions(rounded)
    assert len(found) == 2 and not any(any(c.is_held) for c in found)
    assert np.abs(sum(resultant(c) for c in found)).max() < 1e-9 * SIDE**2
    assert abs(resultant(found[0])[1]) == pytest.approx(SIDE, rel=1e-3)
