"""Cells on the outline: curvature, constraints, and fits of fields that the modes hold exactly."""

import numpy as np
import pytest

from slmm.initiation.local_model import LocalModel
from slmm.initiation.placement import (
    STOPPED,
    Constraints,
    boundary_point,
    boundary_points,
    fit_cells,
    grow_cells,
)
from slmm.part.outline import Outline
from slmm.part.shapes import circle, ellipse

PAPER = Constraints(11, False, 0.01, 0.1, np.inf, 28, 2)
LOCAL = Constraints(21, True, np.inf, 0.0, 0.005, 84, 2)
POWERS = np.array([[1, 0], [0, 1], [1, 1], [2, 0], [0, 2]])


def plate(n=200, size=100.0, radius=20.0):
    """Density of a plate with a circular hole, and its voxel size."""
    h = size / n
    x = (np.arange(n) + 0.5) * h - size / 2
    return np.where(np.hypot(x[:, None], x) > radius, 1.0, 0.0), h, h


def grow(outline, s, rule, first=5.0, largest=200.0, grid=None):
    grid = plate() if grid is None else grid
    first = np.full(np.size(s), first)
    return grow_cells(
        outline.breaks, outline.coefficients, np.atleast_1d(s), first, largest, rule, -1.0, 0.5, *grid
    )


def curvature(outline, s, height, rule):
    at, heights = np.atleast_1d(s), np.full(np.size(s), height)
    return boundary_points(outline.breaks, outline.coefficients, at, heights, rule)[0]


def test_parabola_and_quartic_see_the_circle():
    outline = Outline.through(circle((50, 50), 20.0))
    fitted = curvature(outline, 0.0, 38.7, PAPER)
    # by hand: least squares of 20 (cos t - 1) by (20 sin t)^2 over the arc
    t = np.linspace(-1, 1, 11) * 38.7 / 2 / 20
    xi, eta = 20 * np.sin(t), 20 * (np.cos(t) - 1)
    assert fitted[0] == pytest.approx((eta * xi**2).sum() / (xi**4).sum(), rel=1e-4)
    local = curvature(outline, 0.0, 20.0, LOCAL)
    assert local[0] == pytest.approx(-1 / 40, rel=0.01)  # the curvature at the mouth


def test_the_cell_grows_until_a_constraint_stops_it():
    outline = Outline.through(circle((50, 50), 20.0))
    height, _, stopped = grow(outline, 0.0, PAPER)
    # the edge of the plate or the table's curvature, never the intrusion into the hole
    assert STOPPED[stopped[0]] in ("leaves the plate", "curvature outside the table")
    small, _, reason = grow(outline, 0.0, LOCAL)
    assert small[0] < height[0]
    assert STOPPED[reason[0]] == "outline is no parabola"


def test_cell_at_the_edge_of_the_plate_has_no_room():
    outline = Outline.through(circle((78, 50), 20.0))
    x = (np.arange(200) + 0.5) * 0.5
    density = np.where(np.hypot(x - 78, x[:, None] - 50) > 20, 1.0, 0.0)
    height, _, stopped = grow(outline, 0.0, LOCAL, grid=(density, 0.5, 0.5))
    assert np.isnan(height[0]) and STOPPED[stopped[0]] == "leaves the plate"


def test_another_notch_in_the_way_stops_the_cell():
    density, h, _ = plate()
    density[:, 150:] = 0.0  # a wide slot 5 mm away from the hole
    outline = Outline.through(circle((50, 50), 20.0))
    height, _, _ = grow(outline, 0.0, LOCAL, first=4.0, grid=(density, h, h))
    free, _, _ = grow(outline, 0.0, LOCAL, first=4.0)
    assert not height[0] >= free[0]


def test_undercut_is_refused():
    outline = Outline.through(ellipse((50, 50), (20.0, 1.5)))
    _, _, stopped = grow(outline, 0.0, LOCAL._replace(deviation=np.inf), first=9.0)
    assert STOPPED[stopped[0]] in ("undercut", "curvature outside the table")


@pytest.mark.parametrize("s", [0.0, 17.0, 60.0])
def test_affine_displacements_are_fitted_exactly_in_turned_axes(s):
    outline = Outline.through(circle((50, 50), 20.0))
    y, x = np.mgrid[0:101, 0:101] * 1.0
    gradient = np.array([[0.01, 0.004], [-0.002, 0.03]])
    u = np.stack([gradient[0, 0] * x + gradient[0, 1] * y, gradient[1, 0] * x + gradient[1, 1] * y], axis=-1)
    local = LocalModel(u, 1.0, 1.0, 100, 100, np.ones((100, 100)), 0, 0.0)
    at, height = np.array([s]), np.array([15.0])
    c, points = boundary_points(outline.breaks, outline.coefficients, at, height, LOCAL)
    there = local.displacement(points[0])[None]
    modes, misfit = fit_cells(outline.breaks, outline.coefficients, at, height, c, POWERS, POWERS, there)
    tangent, normal = outline.tangents(s), outline.normals(s)
    expected_xi = [tangent @ gradient @ tangent, tangent @ gradient @ normal, 0, 0, 0]
    expected_eta = [normal @ gradient @ tangent, normal @ gradient @ normal, 0, 0, 0]
    np.testing.assert_allclose(modes[0], expected_xi + expected_eta, atol=1e-12)
    assert misfit[0] < 1e-10


def test_boundary_points_lie_on_the_three_straight_edges():
    points = np.array([boundary_point(i, 28, -0.6, 1.4) for i in range(28)])
    on_side = np.isclose(np.abs(points[:, 0]), 1.0)
    on_back = np.isclose(points[:, 1], 1.4)
    assert np.all(on_side | on_back)
    assert on_side.sum() > on_back.sum() > 0
    np.testing.assert_allclose(np.sort(points[:, 0]), np.sort(-points[:, 0]), atol=1e-12)  # mirror image
