"""Elements: shape functions and integration rules are what every finite element text says."""

import numpy as np
import pytest

from slmm.mechanics.elements import ALIASES, ELEMENTS, element_named

VOLUME = {"CPE3": 0.5, "CPE6": 0.5, "C3D4": 1 / 6, "C3D10": 1 / 6, "C3D6": 0.5, "C3D15": 0.5, "WEDGE18": 0.5}
#: highest total degree that the rule integrates exactly
DEGREE = {"CPE3": 1, "CPE4R": 1, "C3D4": 1, "C3D8R": 1, "C3D6": 1, "CPE6": 2, "C3D10": 2, "C3D15": 2}
DEGREE |= {
    "CPE4": 3,
    "CPE8R": 3,
    "C3D8": 3,
    "C3D20R": 3,
    "CPE8": 5,
    "C3D20": 5,
    "QUAD9": 5,
    "HEX27": 5,
    "WEDGE18": 2,
}


@pytest.mark.parametrize("name", ELEMENTS)
def test_shape_functions_are_one_at_their_node_and_nothing_at_others(name):
    element = ELEMENTS[name]
    np.testing.assert_allclose(element.shape(element.nodes), np.eye(len(element.nodes)), atol=1e-13)


@pytest.mark.parametrize("name", ELEMENTS)
def test_shape_functions_add_up_to_one_and_carry_linear_fields(name):
    element = ELEMENTS[name]
    inside = np.random.default_rng(0).uniform(0.05, 0.3, (20, element.dimension))
    assert element.shape(inside).sum(axis=1) == pytest.approx(1.0)
    np.testing.assert_allclose(element.shape(inside) @ element.nodes, inside, atol=1e-13)


@pytest.mark.parametrize("name", ELEMENTS)
def test_gradients_are_those_of_the_shape_functions(name):
    element, step = ELEMENTS[name], 1e-5
    at = np.random.default_rng(1).uniform(0.1, 0.3, (5, element.dimension))
    for i, gradient in enumerate(np.moveaxis(element.gradient(at), -1, 0)):
        moved = [element.shape(at + sign * step * np.eye(element.dimension)[i]) for sign in (1, -1)]
        np.testing.assert_allclose(gradient, (moved[0] - moved[1]) / (2 * step), atol=1e-9)


@pytest.mark.parametrize("name", ELEMENTS)
def test_rules_integrate_what_they_should(name):
    element = ELEMENTS[name]
    assert element.weights.sum() == pytest.approx(VOLUME.get(name, 2.0**element.dimension))
    finer = {2: "CPE8", 3: "C3D20"}[element.dimension]
    on_brick = VOLUME.get(name) is None
    if on_brick:
        for powers in np.ndindex(*(DEGREE[name] + 1,) * element.dimension):
            if sum(powers) <= DEGREE[name]:
                ours, exact = (
                    e.weights @ np.prod(e.points ** np.array(powers), axis=1)
                    for e in (element, ELEMENTS[finer])
                )
                assert ours == pytest.approx(exact, abs=1e-13)
    else:  # the moments of a simplex, and of a wedge over a unit length
        linear = element.weights @ element.points / element.weights.sum()
        centre = {"C3D4": 0.25, "C3D10": 0.25}.get(name, 1 / 3)
        expected = [centre] * element.dimension
        if name in ("C3D6", "C3D15", "WEDGE18"):
            expected[2] = 0.5
        np.testing.assert_allclose(linear, expected)
        if DEGREE[name] >= 2:
            second = element.weights @ element.points[:, 0] ** 2 / element.weights.sum()
            assert second == pytest.approx({"C3D10": 0.1}.get(name, 1 / 6))


def test_first_coordinate_of_the_points_runs_fastest():
    points = ELEMENTS["C3D8"].points
    assert np.all(np.diff(points[:2, 0]) > 0) and np.all(points[:2, 1:] == points[0, 1:])
    assert len(points) == 8  # the thesis prints 4


def test_names_are_found_in_any_case_and_unknown_ones_are_listed():
    assert element_named("c3d20r") is ELEMENTS["C3D20R"]
    assert all(element_named(alias) is ELEMENTS[name] for alias, name in ALIASES.items())
    with pytest.raises(ValueError, match=r"element_type = 'S4R': unknown; known are CPE3, .*C3D20RH"):
        element_named("S4R")


def test_edges_of_plane_elements_run_around_them_with_their_midside_nodes():
    for name, element in ELEMENTS.items():
        if element.dimension == 3:
            with pytest.raises(ValueError, match=f"{name} is no plane element"):
                _ = element.edges
            continue
        edges = element.nodes[element.edges]
        np.testing.assert_array_equal(edges[:, 1], np.roll(edges[:, 0], -1, axis=0))
        if edges.shape[1] == 3:
            np.testing.assert_allclose(edges[:, 2], edges[:, :2].mean(axis=1))
        x, y = edges[:, 0].T
        assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0  # anticlockwise


@pytest.mark.parametrize(
    ("name", "inside"),
    [("QUAD9", [(0.3, -0.7)]), ("HEX27", [(0.3, -0.7, 0.2)]), ("WEDGE18", [(0.3, 0.2, 0.7)])],
)
def test_lagrange_elements_carry_what_is_quadratic_in_each_coordinate(name, inside):
    element = ELEMENTS[name]
    at = np.array(inside)

    def field(x):
        triangle = x[:, 0] ** 2 - x[:, 0] * x[:, 1] + 2 * x[:, 1] ** 2
        square = triangle + 3 * (x[:, 0] * x[:, 1]) ** 2
        along = 1 + x[:, 2] ** 2 if element.dimension == 3 else 1
        return along * (triangle if name == "WEDGE18" else square)

    assert element.shape(at) @ field(element.nodes) == pytest.approx(field(at))


@pytest.mark.parametrize("name", [name for name in ELEMENTS if ELEMENTS[name].dimension == 2])
def test_edges_run_anticlockwise_with_their_middles(name):
    element = ELEMENTS[name]
    ends = element.nodes[element.edges]
    assert len(ends) == element.corners == (3 if name in ("CPE3", "CPE6") else 4)
    if ends.shape[1] == 3:
        np.testing.assert_allclose(ends[:, 2], (ends[:, 0] + ends[:, 1]) / 2)
    x, y = ends[:, 0].T
    assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0
