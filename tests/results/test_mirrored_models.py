"""Halves and quarters of a model become the whole one, and what is none of them is refused."""

import numpy as np
import pytest

from slmm import Material
from slmm.results.field import DisplacementField
from slmm.results.mirrored import mirrored
from slmm.results.outlines import mesh_outlines
from tests.solved_plates import SIDE, ring, stretched, with_middles

PMMA = Material.from_name("PMMA")
MIDDLE = 0.5 * SIDE


def quarter():
    """The upper right quarter of a plate with a hole that is stretched about its middle."""
    points, nodes = with_middles(*ring(16, 4), 2.0)
    field = stretched(points, {"quad8": nodes}, PMMA)
    u = field.u - field.displacement(np.array([[MIDDLE, 0.0]]))[0] * [1, 0] - [0.0, 0.025]
    at = points[nodes].mean(axis=1)
    keep = (at > MIDDLE - 1e-9).all(axis=1)
    return field, DisplacementField(points, {"quad8": nodes[keep]}, u), u


def test_a_quarter_becomes_the_whole_plate():
    whole, part, u = quarter()
    found = mirrored(part, ["left", "bottom"])
    assert found.area() == pytest.approx(whole.area(), rel=1e-12)
    rings = mesh_outlines(found)
    assert [len(ring.edges) for ring in rings] == [16, 16]
    assert [len(ring.outline.corners) for ring in rings] == [0, 4]
    at = np.array([[4.0, 6.0], [15.0, 3.0], [5.0, 17.0]])
    moved = DisplacementField(whole.points, whole.cells, u).displacement(at)
    assert found.displacement(at) == pytest.approx(moved, abs=1e-9)


@pytest.mark.parametrize(("side", "says"), [("above", "must be one of left"), ("right", "stays plane")])
def test_what_is_no_plane_of_symmetry_is_refused(side, says):
    _, part, _ = quarter()
    with pytest.raises(ValueError, match=says):
        mirrored(part, [side])
