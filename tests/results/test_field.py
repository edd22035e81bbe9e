"""A displacement field says the same as the model it was made from, wherever it is asked."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from slmm.results.field import DisplacementField
from slmm.results.plane_elements import PLANE_ELEMENTS

KINDS = sorted(PLANE_ELEMENTS)
QUADRATIC = ["triangle6", "quad8", "quad9"]


def square_mesh(kind: str, n: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """The unit square in n x n elements, or twice as many triangles."""
    m = 2 * n + 1
    X, Y = np.meshgrid(np.linspace(0, 1, m), np.linspace(0, 1, m))
    a, b = (2 * v.ravel() for v in np.meshgrid(np.arange(n), np.arange(n)))
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
    quad9 = np.column_stack([(b + db) * m + a + da for da, db in around])
    triangle6 = np.concatenate([quad9[:, [0, 1, 2, 4, 5, 8]], quad9[:, [0, 2, 3, 8, 6, 7]]])
    nodes = triangle6 if kind.startswith("triangle") else quad9
    return np.column_stack([X.ravel(), Y.ravel()]), {kind: nodes[:, : len(PLANE_ELEMENTS[kind].nodes)]}


def warped(points: np.ndarray) -> np.ndarray:
    """A map that bends every edge and folds nothing."""
    x, y = points.T
    return points + 0.06 * np.column_stack([np.sin(5 * x + 3 * y), np.cos(4 * y - 3 * x)])


def ring_mesh(kind: str, n: int, inner: float = 1.0, outer: float = 3.0):
    """A ring of 8 n elements around and n across, with all nodes on circles."""
    points, cells = square_mesh(kind, 8 * n)
    radius, angle = inner + (outer - inner) * 8 * points[:, 1], 2 * np.pi * points[:, 0]
    in_ring = {kind: nodes[(points[nodes, 1] < 0.125 + 1e-9).all(axis=1)] for kind, nodes in cells.items()}
    # the seam closes: nodes at the right edge are those at the left
    m = 16 * n + 1
    number = np.arange(len(points))
    number[m - 1 :: m] = number[::m]
    in_ring = {kind: number[nodes] for kind, nodes in in_ring.items()}
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), in_ring


coefficients = arrays(float, (2, 3), elements=st.floats(-1, 1))
everywhere = arrays(float, (20, 2), elements=st.floats(-0.5, 1.5))


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=40)
@given(linear=coefficients, points=everywhere)
def test_a_linear_displacement_is_reproduced_exactly_inside_curved_elements_and_beside_them(
    kind, linear, points
):
    nodes, cells = square_mesh(kind, 3)
    nodes = warped(nodes)
    field = DisplacementField(nodes, cells, linear[:, 0] + nodes @ linear[:, 1:].T)
    assert field.displacement(points) == pytest.approx(linear[:, 0] + points @ linear[:, 1:].T, abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=40)
@given(seed=st.integers(0, 2**32 - 1))
def test_in_elements_of_any_shape_a_point_of_known_local_coordinates_has_their_displacement(kind, seed):
    rng = np.random.default_rng(seed)
    reference = PLANE_ELEMENTS[kind]
    nodes = reference.nodes + rng.uniform(-0.15, 0.15, reference.nodes.shape) * np.ptp(reference.nodes) / 2
    u = rng.uniform(-1, 1, nodes.shape)
    xi = reference.clipped(rng.uniform(*reference.nodes[[0, 2], 1], (50, 2)))
    N = reference.shape(xi)
    field = DisplacementField(nodes, {kind: np.arange(len(nodes))[None]}, u)
    assert field.displacement(N @ nodes) == pytest.approx(N @ u, abs=1e-6)
    assert field.covers(N @ nodes, tolerance=1e-6).all()


@pytest.mark.parametrize("kind", QUADRATIC)
def test_the_field_of_curved_elements_is_exact_at_their_nodes(kind):
    nodes, cells = ring_mesh(kind, 2)
    used = np.unique(cells[kind])
    u = np.random.default_rng(1).uniform(-1, 1, nodes.shape)
    field = DisplacementField(nodes, cells, u)
    assert field.displacement(nodes[used]) == pytest.approx(u[used], abs=1e-7)


@pytest.mark.parametrize("kind", QUADRATIC)
def test_a_quadratic_displacement_is_reproduced_exactly_by_straight_quadratic_elements(kind):
    nodes, cells = square_mesh(kind, 2)
    shear = np.array([[2.0, 0.7], [0.3, 1.0]])

    def u(points):
        x, y = points.T
        return np.column_stack([x * x - x * y + y, 2 * y * y + x * y - 1])

    nodes = nodes @ shear
    points = np.random.default_rng(2).uniform(0, 1, (100, 2)) @ shear
    assert DisplacementField(nodes, cells, u(nodes)).displacement(points) == pytest.approx(
        u(points), abs=1e-12
    )


@pytest.mark.parametrize("kind", KINDS)
def test_the_field_is_continuous_across_edges(kind):
    nodes, cells = square_mesh(kind, 4)
    nodes = warped(nodes)
    field = DisplacementField(nodes, cells, np.random.default_rng(3).uniform(-1, 1, nodes.shape))
    line = np.linspace((0.1, 0.3), (0.9, 0.8), 20001)
    step = np.linalg.norm(np.diff(field.displacement(line), axis=0), axis=1)
    # the line crosses elements of size 1/4 with random nodal values in -1..1: the slope stays finite
    assert step.max() < 200 * np.linalg.norm(line[1] - line[0])


def test_elements_of_different_types_share_an_edge_without_a_jump():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1.1, 0.5], [0.5, 1], [0, 0.5]], dtype=float)
    points = np.concatenate([points, [[2, 0.5], [1.5, 0.2], [1.5, 0.8]]])
    cells = {"quad8": np.arange(8)[None], "triangle6": np.array([[1, 8, 2, 9, 10, 5]])}
    u = np.random.default_rng(4).uniform(-1, 1, points.shape)
    together = DisplacementField(points, cells, u)
    y = np.linspace(0, 1, 41)
    shared = np.column_stack([1 + 0.4 * y * (1 - y), y])
    for kind, nodes in cells.items():
        alone = DisplacementField(points, {kind: nodes}, u)
        assert alone.displacement(shared) == pytest.approx(together.displacement(shared), abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=40)
@given(angle=st.floats(-3, 3), shift=arrays(float, 2, elements=st.floats(-100, 100)))
def test_turning_and_moving_the_model_turns_the_field(kind, angle, shift):
    nodes, cells = square_mesh(kind, 2)
    nodes, u = warped(nodes), np.random.default_rng(5).uniform(-1, 1, nodes.shape)
    points = np.random.default_rng(6).uniform(-0.2, 1.2, (30, 2))
    Q = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    before = DisplacementField(nodes, cells, u)
    after = DisplacementField(nodes @ Q + shift, cells, u @ Q)
    assert after.displacement(points @ Q + shift) == pytest.approx(before.displacement(points) @ Q, abs=1e-5)
    assert after.area() == pytest.approx(before.area())


def test_area_of_a_round_ring_is_that_of_curved_edges():
    true = np.pi * (3**2 - 1**2)
    error = {
        kind: [abs(DisplacementField(*ring, np.zeros_like(ring[0])).area() - true) for ring in rings]
        for kind in KINDS
        for rings in [[ring_mesh(kind, n) for n in (1, 2, 4)]]
    }
    for kind in ("triangle", "quad"):
        assert error[kind][1] / error[kind][2] == pytest.approx(4, rel=0.05)
    for kind in QUADRATIC:
        assert error[kind][1] / error[kind][2] == pytest.approx(16, rel=0.1)
        assert error[kind][2] < 1e-3


@pytest.mark.parametrize("kind", KINDS)
def test_element_sizes_are_those_of_the_elements_asked(kind):
    coarse, fine = square_mesh(kind, 2), square_mesh(kind, 8)
    cells = np.concatenate([coarse[1][kind], fine[1][kind] + len(coarse[0])])
    points = np.concatenate([coarse[0], fine[0] + (2.0, 0.0)])
    field = DisplacementField(points, {kind: cells}, np.zeros_like(points))
    triangles = 2 if kind.startswith("triangle") else 1
    size = field.element_size(np.array([[0.3, 0.4], [2.3, 0.4], [3.5, 0.5], [-3.0, 0.5]]))
    assert size == pytest.approx(np.array([0.5, 0.125, 0.125, 0.5]) / np.sqrt(triangles))
    assert field.area() == pytest.approx(2.0)


@pytest.mark.parametrize("kind", KINDS)
def test_points_of_a_round_notch_are_covered_and_points_in_it_are_not(kind):
    nodes, cells = ring_mesh(kind, 2)
    field = DisplacementField(nodes, cells, np.zeros_like(nodes))
    angle = np.linspace(0, 2 * np.pi, 301)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    for radius, covered in ((0.0, False), (0.9, False), (1.0, True), (2.0, True), (2.9, True), (3.2, False)):
        assert field.covers(radius * circle).tolist() == [covered] * len(circle)


@pytest.mark.parametrize(("kind", "rate"), [("triangle", 4), ("quad", 4), ("triangle6", 8), ("quad8", 8)])
def test_on_a_round_notch_the_error_falls_as_fast_as_that_of_the_elements(kind, rate):
    angle = np.linspace(0, 2 * np.pi, 1001)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])

    def u(points):
        return np.column_stack([np.exp(points[:, 0] / 2), np.sin(points[:, 0]) * points[:, 1]])

    errors = []
    for n in (2, 4):
        nodes, cells = ring_mesh(kind, n)
        errors.append(
            np.abs(DisplacementField(nodes, cells, u(nodes)).displacement(circle) - u(circle)).max()
        )
    assert errors[0] / errors[1] > 0.8 * rate


@pytest.mark.parametrize("kind", KINDS)
def test_clockwise_elements_are_turned_around(kind):
    nodes, cells = square_mesh(kind, 2)
    u = np.random.default_rng(7).uniform(-1, 1, nodes.shape)
    points = np.random.default_rng(8).uniform(-0.1, 1.1, (50, 2))
    mirror = np.array([-1.0, 1.0])
    straight = DisplacementField(warped(nodes), cells, u)
    clockwise = DisplacementField(warped(nodes) * mirror, cells, u)
    assert clockwise.area() == pytest.approx(straight.area()) and straight.area() > 0
    assert clockwise.displacement(points * mirror) == pytest.approx(straight.displacement(points), abs=1e-9)


def test_elements_around_a_crack_tip_are_understood():
    # eight-node elements with one side collapsed to the tip and the nodes beside it at the quarter points
    angle = np.linspace(0, np.pi / 2, 5)
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.concatenate([[[0.0, 0.0]], 0.25 * direction, direction])
    elements = np.array([[0, 6 + k, 8 + k, 0, 1 + k, 7 + k, 3 + k, 0] for k in (0, 2)])
    radius = np.linalg.norm(points, axis=1)
    field = DisplacementField(points, {"quad8": elements}, np.column_stack([np.sqrt(radius), radius]))
    r = np.linspace(0, 1, 21)
    for k in (0, 2, 4):
        along = field.displacement(r[:, None] * direction[k])
        assert along == pytest.approx(np.column_stack([np.sqrt(r), r]), abs=1e-5)
    assert field.displacement(np.array([[-0.1, -0.1]])) == pytest.approx(np.zeros((1, 2)), abs=0.5)


def test_a_constant_third_coordinate_is_dropped_and_unused_nodes_are_ignored():
    nodes, cells = square_mesh("quad", 1)
    solid = np.column_stack([nodes, np.full(len(nodes), 7.0)])
    field = DisplacementField(solid, cells, 0.1 * nodes)
    assert field.displacement(np.array([[0.3, 0.6]])) == pytest.approx(np.array([[0.03, 0.06]]))
    spare = np.concatenate([solid, [[np.nan, np.nan, 9.0]]])
    u = np.concatenate([0.1 * nodes, [[np.nan, np.nan]]])
    assert DisplacementField(spare, cells, u).area() == pytest.approx(1.0)


def test_no_point_gives_no_displacement():
    nodes, cells = square_mesh("triangle", 1)
    field = DisplacementField(nodes, cells, nodes)
    nowhere = np.empty((0, 2))
    assert field.displacement(nowhere).shape == (0, 2)
    assert field.covers(nowhere).shape == field.element_size(nowhere).shape == (0,)


UNIT = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
QUAD = {"quad": np.array([[0, 1, 2, 3]])}


@pytest.mark.parametrize(
    ("points", "cells", "u", "message"),
    [
        (UNIT.ravel(), QUAD, UNIT, r"points have shape \(8,\)"),
        (UNIT, QUAD, UNIT[:3], r"u has shape \(3, 2\): must be \(4, 2\)"),
        (UNIT, {}, UNIT, "no element"),
        (UNIT, {"quad": np.zeros((0, 4), dtype=int)}, UNIT, "no element"),
        (UNIT, {"tetra": np.array([[0, 1, 2, 3]])}, UNIT, "'tetra': plane elements are triangle"),
        (UNIT, {"quad": np.array([[0, 1, 2]])}, UNIT, r"shape \(1, 3\) .* \(m, 4\)"),
        (UNIT, {"quad": np.array([[0.0, 1.0, 2.0, 3.0]])}, UNIT, "float64"),
        (UNIT, {"quad": np.array([[0, 1, 2, 4]])}, UNIT, "quad 0 has node 4: .* from 0 to 3"),
        (UNIT, QUAD, np.where(UNIT > 0, np.nan, UNIT), r"u\[1\] = \[nan, 0.0\]"),
        (np.where(UNIT > 0, np.inf, UNIT), QUAD, UNIT, r"points\[1\] = \[inf, 0.0\]"),
        (np.column_stack([UNIT, [0, 0, 0, 0.1]]), QUAD, UNIT, "z varies from 0 to 0.1"),
        (
            UNIT,
            {"triangle": np.array([[0, 1, 2], [0, 1, 1]])},
            UNIT,
            r"triangle 1 \(nodes \[0, 1, 1\]\) has no",
        ),
        (UNIT, {"quad": np.array([[0, 1, 3, 2]])}, UNIT, r"quad 0 \(nodes \[0, 1, 3, 2\]\) has no area"),
        (UNIT - [[0, 0], [0, 0], [1.5, 0], [0, 0]], QUAD, UNIT, "quad 0 .* is folded over"),
    ],
)
def test_what_is_no_plane_model_is_refused_by_name(points, cells, u, message):
    with pytest.raises(ValueError, match=message):
        DisplacementField(points, cells, u)


def test_points_that_are_none_are_refused():
    field = DisplacementField(UNIT, QUAD, UNIT)
    with pytest.raises(ValueError, match=r"points\[1\] = \[nan, 0.5\]"):
        field.displacement(np.array([[0.5, 0.5], [np.nan, 0.5]]))
    with pytest.raises(ValueError, match=r"points have shape \(2,\)"):
        field.covers(np.array([0.5, 0.5]))
