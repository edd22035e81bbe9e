"""The user's own displacements: as good as a local model of ours, and refused when they are of another plate."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from skfem import (
    Basis,
    ElementQuad1,
    ElementTriP1,
    ElementVector,
    MeshQuad,
    MeshTri,
    condense,
    solve,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

from slmm import Scene, failure_indices
from slmm.initiation.body_fitted import solve_body_fitted
from slmm.initiation.given_field import given_field
from slmm.initiation.methods import METHODS, ON_DISPLACEMENTS
from slmm.initiation.positions import find_positions
from slmm.initiation.settings import DEFAULT
from slmm.results.field import DisplacementField
from slmm.results.results import read_displacements

DATA = Path(__file__).parents[1] / "data"
RADIUS, SIDE = 2.0, 20.0


def plate(holes=None, **changes):
    """The plate of tests/data/README.md."""
    holes = [{"shape": "circle", "center": [10.0, 10.0], "radius": RADIUS}] if holes is None else holes
    return Scene.from_dict(
        {
            "plate": {"width": SIDE, "height": SIDE},
            "holes": holes,
            "material": {"name": "PMMA"},
            "load": {"strain": [0.0, 0.01, 0.0]},
            "analysis": {"positions": 24},
        }
    ).with_(**changes)


def circle(x, y, radius):
    return {"shape": "circle", "center": [x, y], "radius": radius}


@pytest.fixture(scope="module")
def calculix():
    return read_displacements(DATA / "plate_2d.frd")


@pytest.fixture(scope="module")
def ours():
    return {method: failure_indices(plate(), method).failure_index.values for method in ON_DISPLACEMENTS}


@pytest.mark.parametrize("name", ["plate_2d.frd", "plate_expanded.frd", "plate.vtu"])
@pytest.mark.parametrize("method", ["slmm+ac", "rankine"])
def test_calculix_results_give_the_failure_indices_of_our_own_model(ours, name, method):
    expected = ours[method]
    result = failure_indices(plate(), method, displacements=DATA / name)
    assert (result.status == "ok").all()
    assert result.attrs["displacements"] == name
    found = result.failure_index.values
    critical = int(np.argmax(expected))
    assert found[critical] == pytest.approx(expected[critical], rel=0.01)
    upper = expected > expected.max() / 2
    assert upper.sum() >= 8
    np.testing.assert_allclose(found[upper], expected[upper], rtol=0.02)


@pytest.mark.parametrize("method", ON_DISPLACEMENTS)
def test_all_methods_on_displacements_agree_with_our_own_model(ours, calculix, method):
    found = failure_indices(plate(), method, displacements=calculix).failure_index.values
    assert found.max() == pytest.approx(ours[method].max(), rel=0.01)


def test_our_own_body_fitted_model_can_be_handed_in():
    scene = plate(analysis={"local_model": "body-fitted"})
    model = solve_body_fitted(scene).fine
    arrays = model.points, {"triangle6": model.triangles}, model.u
    # cells of the same size: they start from the elements' size, which is measured in another way there
    settings = replace(DEFAULT, height=1.6)
    expected = failure_indices(scene, "slmm+ac", settings=settings).failure_index
    for displacements in (arrays, list(arrays), DisplacementField(*arrays)):
        found = failure_indices(plate(), "slmm+ac", settings=settings, displacements=displacements)
        np.testing.assert_allclose(found.failure_index, expected, rtol=1e-6)


@hypothesis_settings(max_examples=5)
@given(factor=st.floats(0.1, 10.0), own_load=st.floats(0.001, 0.1))
def test_the_load_is_that_of_the_displacements(calculix, factor, own_load):
    scaled = DisplacementField(calculix.points, calculix.cells, factor * calculix.u)
    scene = plate(load={"strain": [0.0, own_load, 0.0]})
    once = failure_indices(plate(), "slmm+ac", displacements=calculix).load_factor
    found = failure_indices(scene, "slmm+ac", displacements=scaled).load_factor
    np.testing.assert_allclose(found, once / factor, rtol=1e-9)


@hypothesis_settings(max_examples=5)
@given(turn=st.floats(-1e-3, 1e-3), dx=st.floats(-10.0, 10.0), dy=st.floats(-10.0, 10.0))
def test_rigid_motions_change_nothing(calculix, turn, dx, dy):
    motion = [dx, dy] + turn * calculix.points[:, ::-1] * [-1, 1]
    moved = DisplacementField(calculix.points, calculix.cells, calculix.u + motion)
    expected = failure_indices(plate(), "slmm+ac", displacements=calculix).failure_index
    found = failure_indices(plate(), "slmm+ac", displacements=moved).failure_index
    np.testing.assert_allclose(found, expected, atol=1e-9 * float(expected.max()))


def rings(around, across, growth):
    """Nodes and four-node elements from the hole to the edges of the plate, growing with the distance."""
    depth = np.concatenate([[0.0], np.cumsum(growth ** np.arange(across))])
    side, t = np.divmod((np.arange(around) + around / 8) % around, around / 4)
    t = 2 * t / (around / 4) - 1
    turns = np.pi / 2 * side
    on_hole = RADIUS * np.stack([np.cos(turns + np.pi / 4 * t), np.sin(turns + np.pi / 4 * t)], axis=1)
    on_edge = SIDE / 2 * np.stack([np.cos(turns) - t * np.sin(turns), np.sin(turns) + t * np.cos(turns)], 1)
    part = (depth / depth[-1])[:, None, None]
    points = SIDE / 2 + ((1 - part) * on_hole + part * on_edge).reshape(-1, 2)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(around), np.arange(across)))
    right = (i + 1) % around
    return points, np.stack([i, i + around, right + around, right], axis=1) + (j * around)[:, None]


def solved(mesh, element):
    """Displacements (n, 2) at the nodes of a mesh of linear elements, the edges of the plate strained."""
    E, nu = plate().material.plane_stress_equivalent
    lam, mu = lame_parameters(E, nu)
    basis = Basis(mesh, ElementVector(element))
    K = linear_elasticity(2 * lam * mu / (lam + 2 * mu), mu).assemble(basis)
    on_edge = np.flatnonzero(np.abs(mesh.p - SIDE / 2).max(axis=0) > SIDE / 2 - 1e-9)
    u = np.zeros(basis.N)
    u[basis.nodal_dofs[1, on_edge]] = 0.01 * mesh.p[1, on_edge]
    held = basis.nodal_dofs[:, on_edge].ravel()
    u = solve(*condense(K, x=u, D=held))
    return u[basis.nodal_dofs].T


@pytest.mark.parametrize(
    "kind, around, across, growth",
    [("quad", 56, 12, 1.22), ("triangle", 64, 14, 1.2)],
    ids=["quad", "triangle"],
)
def test_linear_elements_as_coarse_as_cells_take_them(ours, kind, around, across, growth):
    """Edges of 0.13 radii: the critical index is within 3 % of our own."""
    points, nodes = rings(around, across, growth)
    mesh, element = MeshQuad, ElementQuad1()
    if kind == "triangle":
        nodes = np.concatenate([nodes[:, [0, 1, 2]], nodes[:, [0, 2, 3]]])
        mesh, element = MeshTri, ElementTriP1()
    u = solved(mesh(points.T.copy(), nodes.T.copy()), element)
    given = given_field((points, {kind: nodes}, u), plate(), find_positions(plate()))
    edge = float(given.edge_length(np.array([[12.0, 10.0]]))[0])
    assert 0.12 < edge / RADIUS < 0.15
    result = failure_indices(plate(), "slmm+ac", displacements=given.field)
    critical = int(np.argmax(ours["slmm+ac"]))
    assert result.failure_index[critical] == pytest.approx(ours["slmm+ac"][critical], rel=0.03)


def test_elements_too_coarse_for_cells_give_no_values():
    points, quads = rings(32, 8, 1.35)
    u = solved(MeshQuad(points.T.copy(), quads.T.copy()), ElementQuad1())
    result = failure_indices(plate(), "slmm+ac", displacements=(points, {"quad": quads}, u))
    assert all(status.startswith("no cell") for status in result.status.values)


def square(kind, n=2, side=1.0):
    """A field on n x n squares."""
    x, y = np.meshgrid(np.arange(n + 1) * side, np.arange(n + 1) * side)
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(n), np.arange(n)))
    first = i + j * (n + 1)
    nodes = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1)
    if kind == "triangle":
        nodes = np.concatenate([nodes[:, :3], nodes[:, [0, 2, 3]]])
    return DisplacementField(points, {kind: nodes}, 0 * points)


@pytest.mark.parametrize("kind, longest", [("quad", 5.0), ("triangle", 5.0 * np.sqrt(2))])
def test_resolution_is_that_of_the_longest_edge(kind, longest):
    empty = plate(cracks=[{"points": [[0.0, 10.0], [5.0, 10.0]]}], holes=[])
    given = given_field(square(kind, 4, 5.0), empty, find_positions(empty))
    assert given.resolution(np.array([[1.0, 2.0], [12.0, 7.0]])) == pytest.approx([longest] * 2)


def test_quadratic_elements_resolve_four_times_as_well(calculix):
    given = given_field(calculix, plate(), find_positions(plate()))
    at = plate().outlines[0].points([0.1, 3.0])
    np.testing.assert_allclose(given.resolution(at), given.edge_length(at) / 4)
    chord = 2 * RADIUS * np.sin(np.pi / 32)
    assert np.all(given.edge_length(at) >= chord)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda points: points / 1000, "in metres"),
        (lambda points: points / 25.4, "in inches"),
        (lambda points: points - 10, r"move the model by \(10, 10\) mm"),
        (lambda points: points * [0.5, 1.0], r"to \(10, 20\).*whole plate"),
    ],
)
def test_a_model_with_another_box_is_refused(calculix, change, message):
    displacements = change(calculix.points), calculix.cells, calculix.u
    with pytest.raises(ValueError, match=message):
        failure_indices(plate(), "slmm+ac", displacements=displacements)


@pytest.mark.parametrize(
    ("holes", "message"),
    [
        ([circle(10.0, 10.0, 2.1)], r"area is 387.434 mm2.*386.146 mm2"),
        ([circle(10.05, 10.0, 2.0)], "of 24 positions are not on the model's surface.*no element"),
        (
            [circle(10.0, 10.0, 2.0), circle(5.0, 10.0, 0.3)],
            "24 of 48 positions.*first one at.*goes on into the notch",
        ),
    ],
    ids=["larger", "shifted", "one more"],
)
def test_a_model_with_other_notches_is_refused(holes, message):
    with pytest.raises(ValueError, match=message):
        failure_indices(plate(holes), "slmm+ac", displacements=DATA / "plate.vtu")


def test_a_model_with_a_hole_that_the_scene_does_not_have_is_refused():
    scene = plate([circle(0.0, 10.0, 3.0)])
    with pytest.raises(ValueError, match="area"):
        failure_indices(scene, "slmm+ac", displacements=DATA / "plate.vtu")


def test_chords_of_a_round_notch_are_accepted():
    """Straight edges of 0.39 radii cut 0.02 radii off the material."""
    points, quads = rings(16, 6, 1.5)
    given = given_field((points, {"quad": quads}, 0 * points), plate(), find_positions(plate(), 50))
    assert given.field.area() > plate_area() + 0.2


def plate_area():
    return SIDE**2 - np.pi * RADIUS**2


def test_mouths_of_an_edge_notch_are_on_its_surface():
    """There, a step along the normal leads out of the plate."""
    scene = plate([circle(1.0, 10.0, 4.0)])
    model = solve_body_fitted(scene).coarse
    displacements = model.points, {"triangle6": model.triangles}, model.u
    result = failure_indices(scene, "slmm+ac", positions=60, displacements=displacements)
    assert (result.status == "ok").any()


@pytest.mark.parametrize("method", sorted(set(METHODS) - set(ON_DISPLACEMENTS)))
def test_methods_without_use_for_displacements_refuse_them(calculix, method):
    with pytest.raises(ValueError, match=f"method = '{method}'.*slmm\\+ac"):
        failure_indices(plate(), method, displacements=calculix)


@pytest.mark.parametrize(
    ("displacements", "message"),
    [
        (3.0, "are a float: must be a path"),
        ((np.zeros((3, 2)), np.zeros((3, 2))), "are a tuple: must be"),
        ((np.zeros((3, 2)), [[0, 1, 2]], np.zeros((3, 2))), "cells are a list"),
    ],
)
def test_what_displacements_can_be_is_said(displacements, message):
    with pytest.raises(ValueError, match=message):
        failure_indices(plate(), "slmm+ac", displacements=displacements)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(OSError, match=r"none\.vtu"):
        failure_indices(plate(), "slmm+ac", displacements=tmp_path / "none.vtu")
