"""Curves through nodes: lines and arcs are what they were, others converge, and their curvature has no waves."""

import numpy as np
import pytest

from slmm.results.smooth_curve import curve_through


def ellipse(n, a=2.0, b=1.0):
    t = 2 * np.pi * np.arange(n) / n
    return np.column_stack([a * np.cos(t), b * np.sin(t)])


def off(at, a=2.0, b=1.0):
    """How far points lie beside an ellipse, about."""
    level = np.hypot(at[:, 0] / a, at[:, 1] / b) - 1
    return np.abs(level / np.hypot(at[:, 0] / a**2, at[:, 1] / b**2)).max()


def test_unequal_steps_on_a_circle_give_the_circle():
    angle = np.sort(np.random.default_rng(3).uniform(0, 2 * np.pi, 25))
    at = curve_through(np.column_stack([np.cos(angle), np.sin(angle)]), closed=True)
    assert np.abs(np.hypot(*at.T) - 1).max() < 1e-3 * np.diff(angle).max() ** 4


def test_an_ellipse_converges_with_the_fourth_power():
    errors = [off(curve_through(ellipse(n), closed=True)) for n in (16, 32, 64)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (rates > 3.5).all(), rates


def test_curvature_has_no_waves():
    """From the end of an ellipse's long axis to that of its short one it falls, on the curve as it should."""
    at = curve_through(ellipse(40), closed=True)
    quarter = at[(at[:, 0] > 0.02) & (at[:, 1] > 0.02)]
    step = np.diff(quarter, axis=0)
    length = np.hypot(*step.T)
    turn = np.diff(np.unwrap(np.arctan2(step[:, 1], step[:, 0])))
    bend = turn / (0.5 * (length[1:] + length[:-1]))
    assert (np.diff(bend) < 0.01 * bend.max()).all()


def test_a_line_stays_straight_beside_an_arc():
    """A half circle between two lines; nodes where they meet."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 9)
    arc = np.column_stack([np.cos(angle), np.sin(angle)])
    x = -np.linspace(2.0, 0.5, 4)[:, None]
    nodes = np.vstack([np.hstack([x, -np.ones_like(x)]), arc, np.hstack([x[::-1], np.ones_like(x)])])
    at = curve_through(nodes, closed=False)
    on_lines = np.abs(np.abs(at[at[:, 0] < 0, 1]) - 1)
    on_arc = np.abs(np.hypot(*at[at[:, 0] > 0].T) - 1)
    assert on_lines.max() < 1e-12 and on_arc.max() < 1e-12


@pytest.mark.parametrize("n", [2, 3])
def test_few_nodes(n):
    nodes = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.5]])[:n]
    at = curve_through(nodes, closed=False)
    assert (at[0] == nodes[0]).all() and (at[-1] == nodes[-1]).all()
    assert np.isfinite(at).all()
