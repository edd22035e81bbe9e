"""Where forces act on a model: in balance with what loads it, nothing at free edges, whatever its elements."""

import numpy as np
import pytest

from slmm import Material
from slmm.results.field import DisplacementField
from slmm.results.outlines import mesh_outlines
from slmm.results.results import read_displacements
from slmm.results.surface_forces import surface_forces
from tests.solved_plates import SIDE, ring, stretched, triangles, with_middles

PMMA = Material.from_name("PMMA")


def nodes_of(field):
    return np.concatenate([outline.nodes for outline in mesh_outlines(field)])


@pytest.mark.parametrize("kind", ["triangle", "quad", "quad8", "quad8R"])
def test_forces_act_where_the_plate_is_held(kind):
    points, quads = ring(16, 3)
    cells = {"triangle": triangles(quads)} if kind == "triangle" else {"quad": quads}
    if kind.startswith("quad8"):
        points, nodes = with_middles(points, quads, 2.0)
        cells = {"quad8": nodes}
    field = stretched(points, cells, PMMA, reduced=kind == "quad8R")
    found = surface_forces(field, PMMA, nodes_of(field))
    held = np.isin(points[:, 1], (0.0, SIDE))
    assert found.noise < 1e-9
    assert (found.acts[:, 1] == held).all() and not found.acts[:, 0].any()
    top = points[:, 1] == SIDE
    assert found.forces[top, 1].sum() == pytest.approx(-found.forces[points[:, 1] == 0.0, 1].sum(), rel=1e-9)
    # about what the plate would take without a hole
    assert 0.8 < found.forces[top, 1].sum() / (PMMA.E * 0.05) < 1.0


def test_digits_of_a_file_are_noise():
    """Six digits of CalculiX: forces on the moved edges stand out, those on the hole do not."""
    field = read_displacements("tests/data/plate_2d.frd")
    hole, outer = mesh_outlines(field)
    found = surface_forces(field, PMMA, nodes_of(field))
    assert 1e-6 < found.noise < 0.02
    assert not found.acts[hole.nodes].any()
    assert found.acts[outer.nodes].any(axis=1).all()


def test_a_rigid_motion_changes_nothing():
    points, quads = ring(16, 3)
    field = stretched(points, {"quad": quads}, PMMA)
    turned = field.u + 0.3 + 1e-3 * np.column_stack([-points[:, 1], points[:, 0]])
    one, other = (
        surface_forces(each, PMMA, nodes_of(each)).forces
        for each in (field, DisplacementField(points, field.cells, turned))
    )
    assert np.abs(one - other).max() < 1e-9 * np.abs(one).max()


def test_another_poissons_ratio_shows_inside():
    points, quads = ring(16, 3)
    field = stretched(points, {"quad": quads}, PMMA)
    wrong = surface_forces(field, Material(PMMA.E, 0.1, PMMA.sigma_c, PMMA.G_c), nodes_of(field))
    assert wrong.noise > 1e-3
