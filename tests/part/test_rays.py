"""Rays end where a general library says, and points lie where it says."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from slmm.part.rays import Lines, are_inside, distances_along


def drawn(seed):
    """Some wavy closed lines, and rays through them."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * np.pi, rng.integers(5, 60), endpoint=False)
    rings = []
    for _ in range(rng.integers(1, 6)):
        r = rng.uniform(0.2, 1.5) * (1 + 0.3 * np.cos(rng.integers(2, 5) * t + rng.uniform(0, 6)))
        rings.append(rng.uniform(-4, 4, 2) + np.column_stack([r * np.cos(t), r * np.sin(t)]))
    angle = rng.uniform(0, 2 * np.pi, 40)
    return rings, rng.uniform(-5, 5, (40, 2)), np.column_stack([np.cos(angle), np.sin(angle)])


@given(st.integers(0, 10**6), st.floats(0, 3))
def test_rays_end_at_the_nearest_line(seed, beyond):
    rings, start, direction = drawn(seed)
    found = distances_along(start, direction, Lines.of(rings, closed=True), beyond)
    lines = shapely.union_all([shapely.LinearRing(ring) for ring in rings])
    for at, way, distance in zip(start, direction, found, strict=True):
        ray = shapely.LineString([at + beyond * way, at + 30 * way])
        met = shapely.intersection(ray, lines)
        wanted = np.inf if met.is_empty else beyond + shapely.distance(shapely.Point(at + beyond * way), met)
        assert distance == pytest.approx(wanted, abs=1e-9)


@given(st.integers(0, 10**6))
def test_points_lie_inside_or_outside(seed):
    rings, points, _ = drawn(seed)
    area = shapely.union_all([shapely.Polygon(ring) for ring in rings])
    assert np.array_equal(
        are_inside(points, Lines.of(rings, closed=True)), shapely.contains_xy(area, *points.T)
    )


def test_open_lines_corners_and_no_lines():
    crack = Lines.of([np.array([[1.0, -1.0], [1.0, 0.0], [2.0, 0.0]])])
    start, right = np.zeros((1, 2)), np.array([[1.0, 0.0]])
    assert distances_along(start, right, crack) == pytest.approx([1.0])  # its corner, then along it
    assert distances_along(start, -right, crack) == [np.inf]
    assert distances_along(start, right, Lines.of([])) == [np.inf]
    assert not are_inside(start, Lines.of([])).any()
