"""A dipole of dislocations beside a free surface: it obeys elasticity, and the surface is free."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.initiation.dipole import (
    OPENING,
    SLIDING,
    dipole_field,
    dipoles_on_boundary,
    mirror_stress,
)

E, NU = 1000.0, 0.3
MU, KAPPA = E / (2 * (1 + NU)), (3 - NU) / (1 + NU)

DEPTHS = st.floats(0.05, 20.0)
RADII = st.one_of(st.floats(0.05, 50.0), st.just(np.inf))
DIRECTIONS = st.sampled_from([OPENING, SLIDING])
ANGLES = st.floats(-3.1, 3.1)


def field(points, depth, direction, R):
    """Stress xx, yy, xy and displacement x, y (n, 5) at points (n, 2)."""
    return np.array(
        [dipole_field(x, y, depth, direction, R, MU, KAPPA) for x, y in np.reshape(points, (-1, 2))]
    )


def slopes(f, points, h):
    """Derivatives (n, ...) of f by x and y by central differences of fourth order."""
    result = []
    for step in (np.array([h, 0.0]), np.array([0.0, h])):
        result.append(
            (8 * (f(points + step) - f(points - step)) - f(points + 2 * step) + f(points - 2 * step))
            / (12 * h)
        )
    return result


def around(depth, R, n=24):
    """Points of the material, none nearer to the dipole than half its depth or to the surface than a fifth."""
    random = np.random.default_rng(1)
    scale = min(R, depth) if np.isfinite(R) else depth
    r, angle = scale * random.uniform(0.5, 3.0, n), random.uniform(-np.pi, np.pi, n)
    points = np.column_stack([depth + r * np.cos(angle), r * np.sin(angle)])
    below = points[:, 0] if np.isinf(R) else np.hypot(points[:, 0] + R, points[:, 1]) - R
    return points[below > 0.2 * scale]


@given(depth=DEPTHS, R=st.floats(0.05, 50.0), direction=DIRECTIONS, angle=ANGLES)
def test_a_hole_is_free_of_tractions(depth, R, direction, angle):
    n = np.array([np.cos(angle), np.sin(angle)])
    (xx, yy, xy, *_), *_ = field([R * n - [R, 0.0]], depth, direction, R)
    traction = np.array([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]])
    # beside what the dipole would do there in the unbounded plane
    distance = np.hypot(*(R * n - [R + depth, 0.0]))
    assert np.abs(traction).max() < 1e-9 * MU / distance**2


@given(depth=DEPTHS, direction=DIRECTIONS, y=st.floats(-50.0, 50.0))
def test_a_straight_edge_is_free_of_tractions(depth, direction, y):
    (xx, _, xy, *_), *_ = field([[0.0, y]], depth, direction, np.inf)
    assert max(abs(xx), abs(xy)) < 1e-9 * MU / (depth**2 + y**2)


@given(depth=DEPTHS, R=RADII, direction=DIRECTIONS)
def test_forces_balance_everywhere(depth, R, direction):
    points = around(depth, R)
    h = 1e-3 * min(R, depth)
    by_x, by_y = slopes(lambda p: field(p, depth, direction, R), points, h)
    scale = np.maximum(np.abs(by_x), np.abs(by_y))[:, :3].max()
    assert np.abs(by_x[:, 0] + by_y[:, 2]).max() < 1e-6 * scale
    assert np.abs(by_x[:, 2] + by_y[:, 1]).max() < 1e-6 * scale


@given(depth=DEPTHS, R=RADII, direction=DIRECTIONS)
def test_stress_is_that_of_the_displacements(depth, R, direction):
    """Hooke's law in plane stress; a stress with displacements is compatible."""
    points = around(depth, R)
    by_x, by_y = slopes(lambda p: field(p, depth, direction, R), points, 1e-3 * min(R, depth))
    e_xx, e_yy, g_xy = by_x[:, 3], by_y[:, 4], by_x[:, 4] + by_y[:, 3]
    factor = E / (1 - NU**2)
    expected = np.column_stack([factor * (e_xx + NU * e_yy), factor * (e_yy + NU * e_xx), MU * g_xy])
    stress = field(points, depth, direction, R)[:, :3]
    assert np.abs(stress - expected).max() < 1e-6 * np.abs(stress).max()


@given(R=st.floats(0.05, 50.0), share=st.floats(0.2, 5.0), direction=DIRECTIONS)
def test_displacements_close_around_the_dipole_and_around_the_hole(R, share, direction):
    """Two dislocations of opposite sign leave no jump behind: displacements that close fit the stress all the way."""
    depth = share * R
    angle = np.linspace(0, 2 * np.pi, 512, endpoint=False)
    tx, ty = -np.sin(angle), np.cos(angle)
    number = np.fft.fftfreq(512, 1 / 512)[:, None]
    for centre, radius in ((depth, 0.5 * depth), (-R, R), (-R, R + 0.5 * depth), (-R, R + 2 * depth)):
        values = field([centre, 0.0] + radius * np.column_stack([ty, -tx]), depth, direction, R)
        xx, yy, xy = values[:, :3].T
        stretch = ((xx - NU * yy) * tx**2 + (yy - NU * xx) * ty**2) / E + xy * tx * ty / MU
        # the derivative of a periodic function: a jump would ring
        by_angle = np.fft.ifft(1j * number * np.fft.fft(values[:, 3:], axis=0), axis=0).real
        found = (by_angle[:, 0] * tx + by_angle[:, 1] * ty) / radius
        assert np.abs(found - stretch).max() < 1e-6 * np.abs(stretch).max()


@given(R=RADII, depth=DEPTHS, direction=DIRECTIONS)
def test_no_force_is_enclosed(R, depth, direction):
    """The tractions on a circle around the dipole balance: it is a jump, not a load."""
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    out = np.column_stack([np.cos(angle), np.sin(angle)])
    xx, yy, xy = field([depth, 0.0] + 0.5 * depth * out, depth, direction, R)[:, :3].T
    traction = np.column_stack([xx * out[:, 0] + xy * out[:, 1], xy * out[:, 0] + yy * out[:, 1]])
    assert np.abs(traction.mean(axis=0)).max() < 1e-8 * np.abs(traction).max()
    moment = out[:, 0] * traction[:, 1] - out[:, 1] * traction[:, 0]
    assert abs(moment.mean()) < 1e-8 * np.abs(traction).max()


@pytest.mark.parametrize("direction", [OPENING, SLIDING])
def test_a_large_hole_is_a_straight_edge(direction):
    points = np.array([[0.5, 0.3], [2.0, -1.0], [1.0, 4.0], [0.0, 0.7]])
    edge = field(points, 1.0, direction, np.inf)[:, :3]
    differences = [np.abs(field(points, 1.0, direction, R)[:, :3] - edge).max() for R in (1e2, 1e3, 1e4)]
    assert differences[0] < 0.05 * np.abs(edge).max()
    assert differences[0] / differences[1] == pytest.approx(10, rel=0.2)
    assert differences[1] / differences[2] == pytest.approx(10, rel=0.2)


@pytest.mark.parametrize("R", [0.5, 2.0, np.inf])
@pytest.mark.parametrize("direction", [OPENING, SLIDING])
def test_far_stress_decays_with_the_square_of_the_distance(direction, R):
    far = np.array([[300.0, 100.0], [50.0, 400.0], [500.0, -20.0]])
    near, ten_times = (np.abs(field(k * far, 1.0, direction, R)[:, :3]).max() for k in (1, 10))
    if direction == SLIDING and np.isinf(R):
        # shear on a free edge: what is left is the next term
        assert near / ten_times == pytest.approx(1000, rel=0.05)
    else:
        assert near / ten_times == pytest.approx(100, rel=0.05)


@given(depth=DEPTHS, other=DEPTHS, R=RADII)
def test_two_dipoles_act_alike_on_each_other(depth, other, R):
    """Reciprocity: the stress that opens one piece by the other's jump, both ways."""
    if abs(depth - other) < 0.05 * depth:
        return
    for direction, component in ((OPENING, 1), (SLIDING, 2)):
        there = field([[other, 0.0]], depth, direction, R)[0, component]
        back = field([[depth, 0.0]], other, direction, R)[0, component]
        assert there == pytest.approx(back, rel=1e-8)


@given(depth=DEPTHS, R=RADII)
def test_an_opening_piece_shears_nothing_on_its_own_path(depth, R):
    points = np.column_stack([depth * np.array([0.2, 0.5, 1.5, 3.0]), np.zeros(4)])
    xx, yy, xy = field(points, depth, OPENING, R)[:, :3].T
    assert np.abs(xy).max() < 1e-12 * np.abs(yy).max()
    _, _, xy = field(points, depth, SLIDING, R)[:, :3].T
    assert np.abs(field(points, depth, SLIDING, R)[:, :2]).max() < 1e-12 * np.abs(xy).max()
    assert np.all(np.isfinite(xx))


@given(depth=DEPTHS, R=RADII, factor=st.floats(0.01, 100.0), direction=DIRECTIONS)
def test_in_another_size_the_stress_goes_with_the_square(depth, R, factor, direction):
    points = around(depth, R)[:4]
    one = field(points, depth, direction, R)
    other = field(factor * points, factor * depth, direction, factor * R)
    scale = np.abs(one[:, :3]).max()
    assert other[:, :3] * factor**2 == pytest.approx(one[:, :3], rel=1e-8, abs=1e-9 * scale)
    assert other[:, 3:] * factor == pytest.approx(one[:, 3:], rel=1e-8, abs=1e-9 * np.abs(one[:, 3:]).max())


def test_a_row_of_dipoles_is_an_edge_dislocation():
    """Its stress in the unbounded plane is E b/(4 pi r); a deep one feels no surface."""
    depth = np.arange(0.0005, 20.0, 0.001) + 1e4  # from here to the tip at 1e4 + 20
    r = 5.0
    s_yy = sum(dipole_field(1e4 + 20 + r, 0.0, d, OPENING, np.inf, MU, KAPPA)[1] for d in depth) * 0.001
    assert s_yy == pytest.approx(E / (4 * np.pi) * (1 / r - 1 / (20 + r)), rel=1e-3)


def test_mirror_stress_is_what_the_surface_adds():
    at, depths = np.array([0.3, 1.7, 4.0]), np.array([0.5, 2.5])
    for R in (1.5, np.inf):
        added = mirror_stress(at, depths, R, MU, KAPPA)
        for direction, component in ((OPENING, 1), (SLIDING, 2)):
            for i, x in enumerate(at):
                for j, d in enumerate(depths):
                    # an unbounded plane is one whose surface is far away
                    alone = field([[1e7 + x, 0.0]], 1e7 + d, direction, np.inf)[0, component]
                    whole = field([[x, 0.0]], d, direction, R)[0, component]
                    assert added[direction, i, j] == pytest.approx(whole - alone, rel=1e-6)


@given(angle=ANGLES, R=RADII)
def test_tractions_and_displacements_turn_with_the_path(angle, R):
    along, origin = np.array([np.cos(angle), np.sin(angle)]), np.array([3.0, -2.0])
    turn = np.column_stack([along, [-along[1], along[0]]])
    local = np.array([[2.0, 0.5], [0.7, -1.0], [3.0, 2.0]])
    normals = np.array([[1.0, 0.2], [0.1, -0.4], [0.0, 2.0]])
    depths = np.array([0.6, 1.3])
    points = np.ascontiguousarray(origin + local @ turn.T)
    traction, u = dipoles_on_boundary(
        points, np.ascontiguousarray(normals @ turn.T), points, origin, along, depths, R, MU, KAPPA
    )
    for direction in (OPENING, SLIDING):
        for j, depth in enumerate(depths):
            values = field(local, depth, direction, R)
            xx, yy, xy = values[:, :3].T
            force = np.column_stack(
                [xx * normals[:, 0] + xy * normals[:, 1], xy * normals[:, 0] + yy * normals[:, 1]]
            )
            column = direction * len(depths) + j
            assert traction[:, :, column] == pytest.approx(force @ turn.T, abs=1e-9 * np.abs(force).max())
            assert u[:, :, column] == pytest.approx(values[:, 3:] @ turn.T, abs=1e-9)
