"""Areas, outlines and local coordinates of plane elements belong to the shape functions of the table."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.mechanics.quadrature import gauss_rule
from slmm.results.curved_edges import nearest_on_edge, on_edge
from slmm.results.plane_elements import PLANE_ELEMENTS

seeds = st.integers(0, 2**32 - 1)


def distorted(kind, seed):
    """Nodes (1, k, 2) of an element whose corners and other nodes lie a little off their places."""
    rng, nodes = np.random.default_rng(seed), PLANE_ELEMENTS[kind].nodes
    return (nodes + rng.uniform(-0.12, 0.12, nodes.shape) * np.ptp(nodes) / 2)[None]


@pytest.mark.parametrize("kind", PLANE_ELEMENTS)
def test_shape_functions_are_those_of_the_table(kind):
    element = ELEMENT_TYPES[kind].element
    at = np.random.default_rng(0).uniform(0, 1, (50, 2))
    assert PLANE_ELEMENTS[kind].shape(at) == pytest.approx(element.shape(at), abs=1e-14)


@pytest.mark.parametrize("kind", PLANE_ELEMENTS)
@settings(max_examples=20)
@given(seed=seeds)
def test_the_area_is_the_integral_of_the_determinant(kind, seed):
    element, nodes = PLANE_ELEMENTS[kind], distorted(kind, seed)
    points, weights = gauss_rule(4, 2)
    if element.corners == 3:
        # the square collapsed to a triangle
        x, y = (1 + points.T) / 2
        points, weights = np.stack([x, y * (1 - x)], axis=1), weights / 4 * (1 - x)
    determinant = np.linalg.det(element.derivatives(points, nodes))
    assert element.areas(nodes)[0] == pytest.approx(weights @ determinant)
    assert element.areas(nodes[:, element.turned[0]])[0] == pytest.approx(-element.areas(nodes)[0])


@pytest.mark.parametrize("kind", PLANE_ELEMENTS)
@settings(max_examples=20)
@given(seed=seeds)
def test_edges_lie_within_their_control_polygon(kind, seed):
    element, nodes = PLANE_ELEMENTS[kind], distorted(kind, seed)
    start, end = (element.nodes[element.edges[:, i]] for i in (0, 1))
    s = np.linspace(0, 1, 11)[:, None, None]
    on_edges = element.shape((start + s * (end - start)).reshape(-1, 2)) @ nodes[0]
    hull = element.hull(nodes)[0]
    assert (on_edges >= hull.min(axis=0) - 1e-12).all() and (on_edges <= hull.max(axis=0) + 1e-12).all()


@pytest.mark.parametrize("kind", PLANE_ELEMENTS)
@settings(max_examples=20)
@given(seed=seeds)
def test_local_coordinates_are_found_again(kind, seed):
    element, nodes = PLANE_ELEMENTS[kind], distorted(kind, seed)
    xi = element.inner_points
    points = element.shape(xi) @ nodes[0]
    found, off = element.local_coordinates(np.repeat(nodes, len(xi), axis=0), points, element.middle)
    assert found == pytest.approx(xi, abs=1e-9) and off == pytest.approx(0, abs=1e-12)


@settings(max_examples=50)
@given(seed=seeds)
def test_no_point_of_an_edge_is_nearer_than_the_nearest(seed):
    rng = np.random.default_rng(seed)
    curve = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]) + rng.uniform(-0.3, 0.3, (3, 2))
    point = rng.uniform(-1, 3, (1, 2))
    _, nearest = nearest_on_edge(curve[None], point)
    others = on_edge(curve, np.linspace(0, 1, 1001))[0]
    assert np.linalg.norm(nearest - point) <= np.linalg.norm(others - point, axis=1).min() + 1e-9
