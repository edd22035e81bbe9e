"""What is read from the mesh and the data of any file gives the forces of the elements that were written."""

import meshio
import numpy as np
import pytest
from element_forces import STEEL, distorted, forces_of
from hypothesis import given
from hypothesis import strategies as st

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import linear_elastic
from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.results.read_results import read_element_results

RNG = np.random.default_rng(0)

#: meshio 5.3 writes no wedges of 15 and 18 nodes
KINDS = sorted(set(ELEMENT_TYPES) - {"wedge15", "wedge18"})


def one_element(kind):
    """Distorted, in the x-y plane or space; its nodes."""
    return distorted(ELEMENT_TYPES[kind].element) + 1


def written(path, kind, points, nodes, **data):
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    cell_data = {name: [values] for name, values in data.pop("cell_data", {}).items()}
    meshio.Mesh(points, {kind: nodes}, data, cell_data).write(path)
    return path


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("suffix", ["vtu", "vtk", "xdmf"])
def test_every_element_keeps_its_nodes_and_order_through_a_file(kind, suffix, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the writer of XDMF puts its data there
    points = one_element(kind)
    u = 1e-3 * RNG.standard_normal((len(points), points.shape[1]))
    nodes = np.arange(len(points))[None]
    in_space = np.pad(u, ((0, 0), (0, 3 - u.shape[1])))
    path = written(tmp_path / f"one.{suffix}", kind, points, nodes, displacement=in_space)
    results = read_element_results(path, elasticity=STEEL)
    expected = linear_elastic(points, {ELEMENT_TYPES[kind].element.name: nodes}, u, STEEL)
    assert list(results.cells) == [ELEMENT_TYPES[kind].element.name]
    assert forces_of(results) == pytest.approx(forces_of(expected))


@pytest.mark.parametrize("kind", KINDS)
def test_elements_that_run_the_other_way_round_are_turned(kind, tmp_path):
    points = one_element(kind)
    u = 1e-3 * RNG.standard_normal((len(points), points.shape[1]))
    mirror = np.eye(points.shape[1])
    mirror[0, 0] = -1
    nodes = np.arange(len(points))[None]
    in_space = np.pad(u @ mirror, ((0, 0), (0, 3 - u.shape[1])))
    path = written(tmp_path / "mirrored.vtu", kind, points @ mirror, nodes, u=in_space)
    expected = linear_elastic(points, {ELEMENT_TYPES[kind].element.name: nodes}, u, STEEL)
    results = read_element_results(path, elasticity=STEEL)
    assert forces_of(results) == pytest.approx(forces_of(expected) @ mirror)


PLANE_STRESS = np.array([[3.0, 1.0, 0], [1, 2, 0], [0, 0, 0.5]])


@pytest.mark.parametrize("where", ["nodes", "elements"])
@pytest.mark.parametrize(
    ("name", "components"),
    [
        ("stress", lambda s: [s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[1, 2], s[2, 0]]),
        ("S", lambda s: [s[0, 0], s[1, 1], s[2, 2], s[0, 1]]),
        ("Sigma", lambda s: [s[0, 0], s[1, 1], s[0, 1]]),
        ("STRESSES", lambda s: s.ravel()),
    ],
)
@pytest.mark.parametrize("energy", ["energy", "ENER", "sener", "Energy_Density"])
def test_stresses_have_six_four_three_or_nine_components(where, name, components, energy, tmp_path):
    points = one_element("quad8")
    nodes = np.arange(8)[None]
    count = len(points) if where == "nodes" else 1
    fields = {name: np.tile(components(PLANE_STRESS), (count, 1)), energy: np.full(count, 0.25)}
    data = fields if where == "nodes" else {"cell_data": fields}
    path = written(tmp_path / "stress.vtu", "quad8", points, nodes, u=0 * points, **data)
    results = read_element_results(path)
    assert results.stress["CPE8"] == pytest.approx(np.full((1, 9, 2, 2), PLANE_STRESS[:2, :2]))
    assert results.energy["CPE8"] == pytest.approx(np.full((1, 9), 0.25))
    assert results.method == "dbf" and results.elasticity == ()
    assert results.source == f"{name} of the {where}" + (", interpolated" if where == "nodes" else "") + (
        f"; {energy} of the {where}" + (", interpolated" if where == "nodes" else "")
    )


@given(values=st.lists(st.floats(-5, 5), min_size=6, max_size=6))
def test_six_components_in_space_are_xx_yy_zz_xy_yz_zx(values, tmp_path_factory):
    points = one_element("tetra")
    path = tmp_path_factory.getbasetemp() / "six.vtu"
    fields = {"stress": np.tile(values, (4, 1)), "energy": np.ones(4)}
    results = read_element_results(written(path, "tetra", points, np.arange(4)[None], u=0 * points, **fields))
    xx, yy, zz, xy, yz, zx = values
    tensor = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    assert results.stress["C3D4"][0, 0] == pytest.approx(tensor)


def test_regions_are_the_sorted_values_of_the_data(tmp_path):
    points = np.array([[x, y] for y in (0, 1) for x in range(4)], dtype=float)
    nodes = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]])
    path = written(
        tmp_path / "regions.vtu",
        "quad",
        points,
        nodes,
        u=1e-3 * points * [1, 0],
        cell_data={"gmsh:physical": np.array([7, 3, 7])},
    )
    soft, stiff = Elasticity(1e3, 0.0), Elasticity(4e3, 0.0)
    results = read_element_results(path, elasticity=[soft, stiff])
    assert results.region["CPE4"].tolist() == [1, 0, 1]
    assert results.stress["CPE4"][:, 0, 0, 0] == pytest.approx([4, 1, 4])
    with pytest.raises(
        ValueError, match="3 materials: 2 are needed, for gmsh:physical = 3, gmsh:physical = 7"
    ):
        read_element_results(path, elasticity=[soft] * 3)


def test_surfaces_lines_and_loose_nodes_are_left_out(tmp_path):
    points = np.concatenate([[[9.0, 9, 9]], one_element("tetra")])
    u = np.concatenate([[[np.nan] * 3], 1e-3 * RNG.standard_normal((4, 3))])
    cells = [
        ("line", np.array([[1, 2]])),
        ("tetra", np.array([[1, 2, 3, 4]])),
        ("triangle", np.array([[1, 2, 3], [1, 2, 4]])),
    ]
    meshio.Mesh(points, cells, {"u": u}).write(tmp_path / "solid.vtu")
    results = read_element_results(tmp_path / "solid.vtu", elasticity=STEEL)
    assert list(results.cells) == ["C3D4"]
    assert np.array_equal(results.points, points[1:]) and np.array_equal(results.u, u[1:])


def test_steps_of_med_files_keep_stresses_and_displacements_together(tmp_path):
    points = one_element("quad")
    data = {f"U[{k}] - {k}": (k + 1) * points for k in (0, 1)}
    data |= {f"S[{k}] - {k}": np.full((4, 4), 10.0 * (k + 1)) for k in (0, 1)}
    data |= {f"ENER[{k}] - {k}": np.full(4, 0.5 * (k + 1)) for k in (0, 1)}
    meshio.write_points_cells(tmp_path / "series.med", points, {"quad": np.arange(4)[None]}, data)
    for step in (0, 1):
        results = read_element_results(tmp_path / "series.med", step=step)
        assert results.u == pytest.approx((step + 1) * points)
        assert results.stress["CPE4"][0, 0, 0, 0] == pytest.approx(10 * (step + 1))
        assert results.energy["CPE4"] == pytest.approx(np.full((1, 4), 0.5 * (step + 1)))


def test_stresses_of_one_step_are_not_those_of_another(tmp_path):
    points = one_element("quad")
    data = {f"U[{k}] - {k}": (k + 1) * points for k in (0, 1)} | {"S": np.ones((4, 4)), "ENER": np.ones(4)}
    meshio.write_points_cells(tmp_path / "series.med", points, {"quad": np.arange(4)[None]}, data)
    with pytest.raises(ValueError, match="stress and energy not known at this step"):
        read_element_results(tmp_path / "series.med")


def test_steps_of_xdmf_files_keep_stresses_and_displacements_together(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the writer puts its data there
    points = np.pad(one_element("quad"), ((0, 0), (0, 1)))
    with meshio.xdmf.TimeSeriesWriter("series.xdmf") as writer:
        writer.write_points_cells(points, {"quad": np.arange(4)[None]})
        for k in (0, 1):
            data = {"stress": [np.full((1, 6), 10.0 * (k + 1))], "energy": [np.full(1, 0.5)]}
            writer.write_data(k, point_data={"U": (k + 1) * points}, cell_data=data)
    for step in (0, 1, -1):
        results = read_element_results("series.xdmf", step)
        assert results.u[:, 0] == pytest.approx((step % 2 + 1) * points[:, 0])
        assert results.stress["CPE4"][0, 0, 0, 0] == pytest.approx(10 * (step % 2 + 1))


SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
QUAD = {"quad": np.array([[0, 1, 2, 3]])}
TETRA = {"tetra": np.array([[0, 1, 2, 3]])}
CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


@pytest.mark.parametrize(
    ("points", "cells", "data", "cell_data", "elasticity", "message"),
    [
        (SQUARE, QUAD, {"T": np.ones(4)}, {}, STEEL, "holds no displacements"),
        (
            SQUARE,
            QUAD,
            {"u": SQUARE},
            {},
            None,
            "stress and energy not known at this step: give elasticity, or data",
        ),
        (SQUARE, QUAD, {"u": SQUARE, "S": np.ones((4, 6))}, {}, None, "energy not known at this step"),
        (SQUARE, QUAD, {"u": SQUARE, "energy": np.ones(4)}, {}, None, "stress not known at this step"),
        (
            SQUARE,
            QUAD,
            {"u": SQUARE, "S": np.ones((4, 5)), "energy": np.ones(4)},
            {},
            None,
            r"S has the shape \(4, 5",
        ),
        (
            SQUARE,
            QUAD,
            {"u": SQUARE, "S": np.ones((4, 6)), "energy": SQUARE},
            {},
            None,
            r"energy has the shape \(4, 3",
        ),
        (
            SQUARE,
            QUAD,
            {"u": SQUARE, "S": np.tile(np.arange(9.0), (4, 1)), "energy": np.ones(4)},
            {},
            None,
            "S is not symmetric, by up to 4: Cauchy",
        ),
        (
            SQUARE,
            QUAD,
            {"u": SQUARE, "S": np.ones((4, 6)) * np.nan, "energy": np.ones(4)},
            {},
            None,
            "S is not known, or not finite, in 1 of 1 elements CPE4",
        ),
        (
            CORNER,
            TETRA,
            {"u": CORNER, "S": np.ones((4, 4)), "energy": np.ones(4)},
            {},
            None,
            "S has components in the plane only",
        ),
        (
            SQUARE,
            QUAD,
            {"u": SQUARE * [1, np.nan, 1]},
            {},
            STEEL,
            r"displacements of node 0.* are \[0.0, nan\]",
        ),
        (SQUARE, QUAD, {"u": np.ones(4)}, {}, STEEL, "2 or 3 components"),
        (CORNER, TETRA, {"u": CORNER[:, :2]}, {}, STEEL, "2 components: solid elements need 3"),
        (SQUARE + SQUARE[:, [2, 2, 0]], QUAD, {"u": SQUARE}, {}, STEEL, "z varies from 0 to 1 mm"),
        (SQUARE, {"line": np.array([[0, 1]])}, {"u": SQUARE}, {}, STEEL, "no plane or solid elements"),
        (
            SQUARE[[0, 1, 3, 2]],
            QUAD,
            {"u": SQUARE},
            {},
            STEEL,
            r"element 0 \(CPE4\) is degenerate or folded over",
        ),
        (
            SQUARE * [1, 0, 1],
            QUAD,
            {"u": SQUARE},
            {},
            STEEL,
            r"element 0 \(CPE4\) is degenerate or folded over",
        ),
        (
            np.concatenate([SQUARE, SQUARE[:1] + 0.5]),
            {"pyramid": np.array([[0, 1, 2, 3, 4]])},
            {"u": np.zeros((5, 3))},
            {},
            STEEL,
            r"cell 0 is a pyramid \(VTK's type 14\) of 5 nodes: known are hexahedron",
        ),
        (SQUARE, QUAD, {"u": SQUARE}, {"region": [np.array([np.nan])]}, STEEL, "region is not finite"),
        (SQUARE, QUAD, {"u": SQUARE}, {"region": [np.ones((1, 3))]}, STEEL, r"region has the shape \(1, 3\)"),
    ],
)
def test_what_a_file_lacks_is_named_with_the_file(
    points, cells, data, cell_data, elasticity, message, tmp_path
):
    path = tmp_path / "model.vtu"
    meshio.Mesh(points, cells, data, cell_data).write(path)
    with pytest.raises(ValueError, match=message) as refusal:
        read_element_results(path, elasticity=elasticity)
    assert str(path) in str(refusal.value)
