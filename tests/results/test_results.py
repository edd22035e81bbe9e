"""Displacements from files are those that the finite element program computed; nothing else passes for them."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from slmm.results.frd import read_frd
from slmm.results.results import FACES, read_displacements

DATA = Path(__file__).parents[1] / "data"
PLATE, EXPANDED, VTU = DATA / "plate_2d.frd", DATA / "plate_expanded.frd", DATA / "plate.vtu"
E, NU, CENTRE, RADIUS = 2960.0, 0.35, np.array([10.0, 10.0]), 2.0
RNG = np.random.default_rng(0)
IN_PLATE = RNG.uniform(0, 20, (500, 2))


def affine(points):
    """The displacements of the files mixed_*.frd."""
    x, y = points.T
    return np.column_stack([0.0005 + 0.001 * x + 0.002 * y, -0.0003 * x + 0.0015 * y])


@pytest.mark.parametrize("other", [EXPANDED, VTU])
def test_plane_output_expanded_output_and_vtu_give_the_same_field(other):
    plane, field = read_displacements(PLATE), read_displacements(other)
    assert field.displacement(IN_PLATE) == pytest.approx(plane.displacement(IN_PLATE), abs=1e-9)
    assert field.area() == pytest.approx(plane.area())
    assert plane.area() == pytest.approx(20**2 - np.pi * RADIUS**2, rel=1e-6)


@pytest.mark.parametrize("name", ["mixed_2d.frd", "mixed_expanded.frd"])
def test_every_plane_element_of_calculix_reproduces_a_linear_displacement(name):
    field = read_displacements(DATA / name)
    assert {kind: len(nodes) for kind, nodes in field.cells.items()} == {
        "quad8": 1,
        "triangle6": 2,
        "quad": 1,
        "triangle": 2,
    }
    points = RNG.uniform((0, 0), (7, 1), (200, 2))
    assert field.displacement(points) == pytest.approx(affine(points), abs=1e-8)
    assert field.covers(points).any() and not field.covers(points).all()  # there are gaps between the squares


def test_prescribed_displacements_come_back_on_the_edges():
    s = np.linspace(0, 20, 101)
    edges = np.concatenate(
        [np.column_stack(p) for p in ((s, 0 * s), (s, 0 * s + 20), (0 * s, s), (0 * s + 20, s))]
    )
    u = read_displacements(PLATE).displacement(edges)
    assert u == pytest.approx(np.column_stack([0 * edges[:, 0], 0.01 * edges[:, 1]]), abs=1e-6)


def test_a_round_hole_opens_as_kirsch_says():
    # tension S along y: +3 S r/E at the poles, -S r/E at the equator; 32 elements around give 0.7 %
    field = read_displacements(PLATE, step=0)
    unit = 1.0 * RADIUS / E
    poles, equator = (
        CENTRE + np.array([[0, RADIUS], [0, -RADIUS]]),
        CENTRE + np.array([[RADIUS, 0], [-RADIUS, 0]]),
    )
    assert np.diff(field.displacement(poles)[::-1, 1]) / 2 == pytest.approx(3 * unit, rel=0.007)
    assert np.diff(field.displacement(equator)[::-1, 0]) / 2 == pytest.approx(-unit, rel=0.007)


def test_the_rim_of_a_round_hole_carries_three_times_the_stress():
    # the rim is in uniaxial stress: E times its stretch
    field = read_displacements(PLATE, step=0)
    for angle, concentration in ((0.0, 3.0), (np.pi / 2, -1.0), (np.pi / 6, 2.0)):
        ends = angle + np.array([-0.05, 0.05])
        rim = CENTRE + RADIUS * np.column_stack([np.cos(ends), np.sin(ends)])
        (chord,), (stretch,) = np.diff(rim, axis=0), np.diff(field.displacement(rim), axis=0)
        assert E * (stretch @ chord) / (chord @ chord) == pytest.approx(concentration, abs=0.03)


def test_stress_and_energy_density_of_calculix_belong_together():
    result = read_frd(PLATE)
    (stress,), (energy,) = result.fields["STRESS"], result.fields["ENER"]
    assert stress.components == ("SXX", "SYY", "SZZ", "SXY", "SYZ", "SZX")
    assert (stress.step, stress.value, energy.components) == (2, 2.0, ("ENER",))
    s_xx, s_yy, _, s_xy, _, _ = stress.values.T
    density = (s_xx**2 + s_yy**2 - 2 * NU * s_xx * s_yy) / (2 * E) + (1 + NU) / E * s_xy**2
    # nodal values are means of extrapolated ones: compare where the field is smooth
    smooth = np.linalg.norm(result.nodes[:, :2] - CENTRE, axis=1) > 2.5 * RADIUS
    assert density[smooth] == pytest.approx(energy.values[smooth, 0], rel=0.01)


def test_a_step_is_chosen_by_its_place():
    first, last = read_displacements(PLATE, 0), read_displacements(PLATE, 1)
    top = np.array([[10.0, 20.0]])
    assert read_displacements(PLATE).displacement(top) == pytest.approx(last.displacement(top))
    assert read_displacements(PLATE, -2).displacement(top) == pytest.approx(first.displacement(top))
    assert first.displacement(top)[0, 1] < 0.01 < 0.19 < last.displacement(top)[0, 1]
    for step in (2, -3):
        with pytest.raises(ValueError, match=f"step = {step}: steps with displacements: 2"):
            read_displacements(PLATE, step)


@pytest.mark.parametrize("kind", ["hexahedron", "hexahedron20", "wedge"])
@pytest.mark.parametrize("turn", range(3))
def test_a_layer_of_solid_elements_is_taken_from_its_lower_side(kind, turn, tmp_path):
    corner = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (2, 0), (2, 1), (0, 1))], dtype=float)
    ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    points = np.concatenate([corner, corner[ends].mean(axis=1)])
    nodes = {"hexahedron": [*range(8)], "hexahedron20": [*range(20)], "wedge": [0, 1, 2, 4, 5, 6]}[kind]
    if kind != "wedge":
        # the same element with its first face on another side
        face, opposite = FACES[kind][2 * turn]
        order = np.empty(len(nodes), dtype=int)
        order[face], order[opposite] = FACES[kind][0][0], FACES[kind][0][1]
        rest = np.setdiff1d(np.arange(len(nodes)), [*face, *opposite])
        order[rest] = np.setdiff1d(np.arange(len(nodes)), order[[*face, *opposite]])
        nodes = order.tolist()
    path = tmp_path / "solid.vtu"
    u = np.column_stack([affine(points[:, :2]), points[:, 2]])
    meshio.write_points_cells(path, points + np.array([0, 0, 5]), {kind: np.array([nodes])}, {"u": u})
    field = read_displacements(path)
    assert field.area() == pytest.approx(1 if kind == "wedge" else 2)
    inside = np.array([[1.0, 0.3], [1.7, 0.6]])
    assert field.displacement(inside) == pytest.approx(affine(inside))


SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
CUBE = np.concatenate([SQUARE, SQUARE + np.array([0, 0, 1])])
TOWER = np.concatenate([CUBE, SQUARE + np.array([0, 0, 2])])
HEXAHEDRON = np.arange(8)[None]
PLANE = {"quad": np.array([[0, 1, 2, 3]])}


@pytest.mark.parametrize(
    ("points", "cells", "data", "message"),
    [
        (
            SQUARE,
            PLANE,
            {"T": np.ones(4), "S": np.ones((4, 3))},
            "displacement, displacements, disp, u and the like, or be named .--field.; there are T, S",
        ),
        (SQUARE, PLANE, {}, "there are none"),
        (SQUARE, PLANE, {"u": np.ones(4)}, "2 or 3 components"),
        (
            SQUARE,
            PLANE,
            {"u": SQUARE, "U": 2 * SQUARE},
            "several .* may be the displacements: u, U; name the right",
        ),
        (SQUARE, PLANE, {"u": SQUARE * np.nan}, r"u\[0\] = \[nan, nan\]"),
        (SQUARE, {"line": np.array([[0, 1]])}, {"u": SQUARE}, "no element"),
        (SQUARE + SQUARE[:, [2, 2, 0]], PLANE, {"u": SQUARE}, "z varies from 0 to 1"),
        (CUBE, {"tetra": np.array([[0, 1, 2, 4]])}, {"u": CUBE}, "elements of type tetra"),
        (
            TOWER,
            {"hexahedron": np.array([range(8), range(4, 12)])},
            {"u": TOWER},
            "hexahedron 0 does not reach",
        ),
        (CUBE, {"hexahedron": HEXAHEDRON}, {"u": CUBE[:, [2, 1, 0]]}, "differ by up to 1 mm"),
    ],
)
def test_files_without_plane_displacements_are_refused_with_the_reason(
    points, cells, data, message, tmp_path
):
    path = tmp_path / "model.vtu"
    meshio.write_points_cells(path, points, cells, data)
    with pytest.raises(ValueError, match=message) as refusal:
        read_displacements(path)
    assert str(path) in str(refusal.value)


def test_a_missing_file_is_named(tmp_path):
    for name in ("none.frd", "none.vtu"):
        with pytest.raises(FileNotFoundError, match=name):
            read_displacements(tmp_path / name)
