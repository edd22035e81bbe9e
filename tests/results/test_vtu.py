"""A .vtu file holds the elements, displacements and forces that were put into it, for every type of element."""

import base64
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
from element_forces import STEEL, distorted, forces_of

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import linear_elastic
from slmm.mechanics.elements import ELEMENTS, type_named
from slmm.results.read_results import read_element_results
from slmm.results.vtu import write_vtu

DATA = Path(__file__).parents[1] / "data"
RNG = np.random.default_rng(0)


def one_element(name):
    """Results of an element, each node moved somewhere."""
    points = distorted(ELEMENTS[name])
    u = 1e-3 * RNG.standard_normal(points.shape)
    return linear_elastic(points, {name: np.arange(len(points))[None]}, u, STEEL)


@pytest.fixture
def meshio_with_wedges(monkeypatch):
    """What meshio lacks to read wedges of 15 nodes."""
    monkeypatch.setitem(meshio._mesh.topological_dimension, "wedge15", 3)


@pytest.mark.parametrize("name", ELEMENTS)
def test_elements_and_vectors_come_back_as_they_were(name, tmp_path, meshio_with_wedges):
    results = one_element(name)
    forces = forces_of(results)
    write_vtu(tmp_path / "one.vtu", results, forces)
    mesh = meshio.read(tmp_path / "one.vtu")
    ((kind, nodes),) = mesh.cells_dict.items()
    assert kind == type_named(name).kind
    assert np.array_equal(nodes, results.cells[name])
    d = forces.shape[1]
    for written, expected in (
        (mesh.points, results.points),
        (mesh.point_data["displacement"], results.u),
        (mesh.point_data["configurational_force"], forces),
    ):
        assert written.shape == (len(nodes[0]), 3)
        assert np.array_equal(written[:, :d], expected) and not written[:, d:].any()


@pytest.mark.parametrize("name", sorted(set(ELEMENTS) - {"C3D15"}))
def test_what_is_written_is_read_again(name, tmp_path):
    results = one_element(name)
    write_vtu(tmp_path / "one.vtu", results, forces_of(results))
    again = read_element_results(
        tmp_path / "one.vtu", elasticity=results.elasticity, reduced=name.endswith("R")
    )
    assert np.array_equal(again.cells[name], results.cells[name])
    assert forces_of(again) == pytest.approx(forces_of(results))


def test_elements_of_several_types_and_materials_stay_apart(tmp_path, meshio_with_wedges):
    results = read_element_results(DATA / "bar_3d.frd")
    write_vtu(tmp_path / "bar.vtu", results, forces_of(results))
    mesh = meshio.read(tmp_path / "bar.vtu")
    assert np.array_equal(mesh.cells_dict["hexahedron20"], results.cells["C3D20R"])
    assert np.array_equal(mesh.cells_dict["wedge15"], results.cells["C3D15"])
    assert {kind: set(own.tolist()) for kind, own in mesh.cell_data_dict["region"].items()} == {
        "hexahedron20": {0},
        "wedge15": {1},
    }
    for kind, E in (("hexahedron20", 210e3), ("wedge15", 70e3)):
        energy = mesh.cell_data_dict["energy"][kind]
        assert energy == pytest.approx(np.full(energy.shape, 100**2 / (2 * E)), rel=1e-4)


def test_the_energy_of_an_element_is_its_mean_over_the_volume(tmp_path):
    # a trapezoid 2 high, 3 wide below and 1 above, with the energy density y: its centroid lies at 5/6
    points = np.array([[0.0, 0], [3, 0], [2, 2], [1, 2]])
    results = linear_elastic(points, {"CPE4": np.arange(4)[None]}, 0 * points, Elasticity(1.0, 0.0))
    y = ELEMENTS["CPE4"].shape(ELEMENTS["CPE4"].points) @ points[:, 1]
    write_vtu(tmp_path / "mean.vtu", replace(results, energy={"CPE4": y[None]}), 0 * points)
    assert meshio.read(tmp_path / "mean.vtu").cell_data["energy"][0] == pytest.approx([5 / 6])


def test_forces_of_another_model_are_refused(tmp_path):
    results = one_element("CPE4")
    with pytest.raises(ValueError, match=r"forces have the shape \(5, 2\): there are nodes \(4, 2\)"):
        write_vtu(tmp_path / "none.vtu", results, np.zeros((5, 2)))
    assert not (tmp_path / "none.vtu").exists()


def test_the_first_triangle_of_a_linear_wedge_faces_outwards_as_vtk_has_it(tmp_path):
    results = one_element("C3D6")
    write_vtu(tmp_path / "wedge.vtu", results, 0 * results.points)
    array = ElementTree.parse(tmp_path / "wedge.vtu").find(".//DataArray[@Name='connectivity']")
    assert array is not None and array.text is not None
    nodes = np.frombuffer(base64.b64decode(array.text)[8:], dtype="<i8")
    a, b, c, opposite = results.points[nodes[:4]]
    assert np.cross(b - a, c - a) @ (opposite - a) < 0


@pytest.mark.parametrize("name", ["CPE8", "QUAD9", "C3D15", "WEDGE18", "C3D20", "HEX27"])
def test_what_is_written_is_read(name, tmp_path):
    results = one_element(name)
    write_vtu(tmp_path / "one.vtu", results, forces_of(results))
    again = read_element_results(tmp_path / "one.vtu", elasticity=STEEL)
    assert np.array_equal(again.points, results.points) and np.array_equal(again.u, results.u)
    assert np.array_equal(again.cells[name], results.cells[name])
    assert again.stress[name] == pytest.approx(results.stress[name])
