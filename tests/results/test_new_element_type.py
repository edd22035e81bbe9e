"""A new element type is one entry in the table: every reader, forces and output know it then.

Modules are imported anew after the entry is made, as when it stands in the file.
"""

import sys
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from exodus_file import write

#: nodes of a cubic triangle, in VTK's order: corners, two on each edge, centre
CUBIC = np.array([[0, 0], [3, 0], [0, 3], [1, 0], [2, 0], [2, 1], [1, 2], [0, 2], [0, 1], [1, 1]]) / 3
#: Dunavant's rule of degree 4 on the triangle: barycentric coordinate and share of the area, of three points each
DUNAVANT = (0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322)


def rule():
    """Points and weights that integrate the energies of cubic triangles better than any in the table."""
    points = [p for a, _ in DUNAVANT for p in ([a, a], [1 - 2 * a, a], [a, 1 - 2 * a])]
    return np.array(points), np.repeat([share for _, share in DUNAVANT], 3) / 2


def up_to(degree):
    return np.array([[p, q] for p in range(degree + 1) for q in range(degree + 1 - p)])


#: what the tests call, by its module
CALLED = {
    "linear_elastic": "slmm.mechanics.element_results",
    "nodal_configurational_forces": "slmm.fracture.configurational_forces",
    "boundary_edges": "slmm.results.boundary_edges",
    "read_element_results": "slmm.results.read_results",
    "read_displacements": "slmm.results.results",
    "write_vtu": "slmm.results.vtu",
}


def ours():
    return {name: module for name, module in sys.modules.items() if name.split(".")[0] == "slmm"}


@pytest.fixture
def with_entry():
    """The package with one entry more in its table."""
    before = ours()

    def add(make):
        for name in ours():
            del sys.modules[name]
        types = import_module("slmm.mechanics.element_types")
        known = make(types, import_module("slmm.mechanics.element").Element)
        types.ELEMENT_TYPES[known.kind] = known
        steel = import_module("slmm.mechanics.elasticity").Elasticity(210e3, 0.3)
        functions = {name: getattr(import_module(module), name) for name, module in CALLED.items()}
        return SimpleNamespace(known=known, steel=steel, **functions)

    yield add
    for name in ours():
        del sys.modules[name]
    sys.modules.update(before)


def bubble(types, Element):
    """A triangle of seven nodes, the last in its middle, with x^2 y as its seventh monomial: made up."""
    nodes = np.array([*types.ELEMENT_TYPES["triangle6"].element.nodes, [1 / 3, 1 / 3]])
    powers = np.array([*up_to(2), [2, 1]])
    return types.ElementType(
        "bubble",
        Element("CPE7", 3, nodes, powers, *rule()),
        aliases=("CPS7", "CPE7I"),
        plane_stress=("CPS7",),
        incompatible=("CPE7I",),
        # some other order, so that it matters
        frd=types.Numbered(13, order=(6, 0, 1, 2, 3, 4, 5)),
        vtk=(types.Numbered(34),),
        exodus=types.Named(("TRI",)),
    )


def cubic(types, Element):
    """The cubic triangle: VTK's Lagrange triangle of 10 nodes."""
    return types.ElementType(
        "cubic",
        Element("CPE10", 3, CUBIC, up_to(3), *rule()),
        frd=types.Numbered(14),
        vtk=(types.Numbered(69),),
        exodus=types.Named(("TRI",)),
    )


def renamed(types, Element):
    """Quadrilaterals of nine nodes under a name and numbers of their own, which begin like nobody else's."""
    nine = types.ELEMENT_TYPES["quad9"].element
    return types.ElementType(
        "lagrange-nine",
        Element("NINE", nine.corners, nine.nodes, nine.exponents, nine.points, nine.weights),
        frd=types.Numbered(15),
        vtk=(types.Numbered(99),),
        exodus=types.Named(("NINE",)),
    )


ENTRIES = (bubble, cubic, renamed)


def one(known):
    """Nodes and displacements of an element of a type, quadratic ones, stretched and sheared."""
    points = known.element.nodes @ np.array([[2.0, -0.2], [0.3, 1.5]])
    x, y = points.T
    return points, 1e-3 * np.stack([x + 0.4 * y + 0.1 * x * y, -0.3 * y + 0.2 * y * y], axis=1)


def in_file(known, order):
    """The nodes of the element as a file has them."""
    return np.arange(known.count) if order is None else np.argsort(order)


def text_of(values):
    return " ".join(map(repr, np.ravel(values).tolist()))


def write_vtu_file(folder, known):
    path = folder / "one.vtu"
    points, u = (np.pad(values, ((0, 0), (0, 1))) for values in one(known))
    cell = known.vtk[0]
    nodes = in_file(known, cell.order)
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="2.2" byte_order="LittleEndian"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="1"><Points>'
        f'<DataArray type="Float64" NumberOfComponents="3" format="ascii">{text_of(points)}</DataArray></Points>'
        f'<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{text_of(nodes)}</DataArray>'
        f'<DataArray type="Int64" Name="offsets" format="ascii">{len(nodes)}</DataArray>'
        f'<DataArray type="UInt8" Name="types" format="ascii">{cell.number}</DataArray></Cells>'
        f'<PointData><DataArray type="Float64" Name="u" NumberOfComponents="3" format="ascii">{text_of(u)}'
        "</DataArray></PointData></Piece></UnstructuredGrid></VTKFile>"
    )
    return path


def write_frd_file(folder, known):
    path = folder / "one.frd"
    points, u = (np.pad(values, ((0, 0), (0, 1))) for values in one(known))

    def rows(values):
        return [f" -1{n:10d}" + "".join(f"{v:12.5E}" for v in row) for n, row in enumerate(values, 1)]

    nodes = "".join(f"{n + 1:10d}" for n in in_file(known, known.frd.order))
    count = f"{len(points):12d}"
    lines = [
        "    1C",
        "    2C" + " " * 18 + count + f"{1:38d}",
        *rows(points),
        " -3",
        "    3C" + " " * 18 + f"{1:12d}" + f"{1:38d}",
        f" -1{1:10d}{known.frd.number:5d}{0:5d}{1:5d}",
        f" -2{nodes}",
        " -3",
        f"  100CL  101{1.0:12.9f}{count}{0:22d}{1:5d}{1:12d}",
        " -4  DISP        4    1",
        *(f" -5  D{k}          1    2    {k}    0" for k in (1, 2, 3)),
        " -5  ALL         1    2    0    0    1ALL",
        *rows(u),
        " -3",
        " 9999",
    ]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_inp_file(folder, known, called):
    points, _ = one(known)
    nodes = [f"{n}, {x!r}, {y!r}" for n, (x, y) in enumerate(points.tolist(), 1)]
    own = ", ".join(str(n + 1) for n in range(known.count))
    (folder / "one.inp").write_text(
        "*NODE\n" + "\n".join(nodes) + f"\n*ELEMENT, TYPE={called}, ELSET=ALL\n1, {own}\n"
        "*MATERIAL, NAME=M\n*ELASTIC\n210000, 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n2\n"
    )


def write_exodus_file(folder, known):
    points, u = one(known)
    nodes = in_file(known, known.exodus.order)[None] + 1
    return write(folder / "one.e", f"{known.exodus.beginnings[0]}{known.count}", points, [u], [nodes])


def forces_of(new, results):
    return new.nodal_configurational_forces(
        results.points,
        results.cells,
        results.u,
        results.stress,
        results.energy,
        results.method,
        results.thickness,
    )


def energy_of(new, points, u):
    """Strain energy of one element, by its own rule."""
    element = new.known.element
    results = new.linear_elastic(points, {element.name: np.arange(len(points))[None]}, u, new.steel)
    volume = np.linalg.det(np.einsum("ni,qnj->qij", points, element.gradient_at_points))
    return float(results.energy[element.name][0] * volume @ element.weights)


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("write_file", [write_vtu_file, write_frd_file, write_exodus_file])
def test_files_with_the_new_type_give_its_forces(entry, write_file, with_entry, tmp_path):
    new = with_entry(entry)
    element = new.known.element
    path = write_file(tmp_path, new.known)
    results = new.read_element_results(path, elasticity=new.steel)
    points, u = one(new.known)
    assert {name: nodes.tolist() for name, nodes in results.cells.items()} == {
        element.name: [list(range(len(points)))]
    }
    assert results.points == pytest.approx(points, abs=1e-5) and results.u == pytest.approx(u, abs=1e-8)
    forces = forces_of(new, results)
    step = 1e-5
    for node, axis in ((0, 0), (len(points) - 1, 1)):
        moved = np.zeros_like(points)
        moved[node, axis] = step
        change = energy_of(new, points + moved, u) - energy_of(new, points - moved, u)
        # a .frd file has six digits
        assert forces[node, axis] == pytest.approx(change / (2 * step), rel=1e-3, abs=1e-5)


@pytest.mark.parametrize("entry", ENTRIES)
def test_what_is_written_of_the_new_type_is_read(entry, with_entry, tmp_path):
    new = with_entry(entry)
    results = new.read_element_results(write_vtu_file(tmp_path, new.known), elasticity=new.steel)
    new.write_vtu(tmp_path / "again.vtu", results, forces_of(new, results))
    again = new.read_element_results(tmp_path / "again.vtu", elasticity=new.steel)
    assert np.array_equal(forces_of(new, again), forces_of(new, results))


@pytest.mark.parametrize("called", ["CPE7", "CPS7", "CPE7I"])
def test_names_in_the_input_file_say_what_they_say_in_the_entry(called, with_entry, tmp_path):
    new = with_entry(bubble)
    path = write_frd_file(tmp_path, new.known)
    write_inp_file(tmp_path, new.known, called)
    if called == "CPE7I":
        with pytest.raises(ValueError, match="CPE7I have incompatible modes"):
            new.read_element_results(path)
        return
    results = new.read_element_results(path)
    assert [*results.cells] == [called] and results.thickness == 2.0
    assert results.elasticity[0].state == ("plane stress" if called == "CPS7" else "plane strain")


@pytest.mark.parametrize("entry", [bubble, renamed])
def test_field_and_boundary_of_the_new_type_follow_its_corners_and_edges(entry, with_entry, tmp_path):
    new = with_entry(entry)
    element = new.known.element
    path = write_vtu_file(tmp_path, new.known)
    results = new.read_element_results(path, elasticity=new.steel)
    edges = new.boundary_edges(results.points, results.cells)
    assert edges.tolist() == [
        [k, (k + 1) % element.corners, element.corners + k] for k in range(element.corners)
    ]
    field = new.read_displacements(path)
    points, u = one(new.known)
    assert field.area() == pytest.approx(3.06 * (0.5 if element.corners == 3 else 4))
    inside = element.shape(element.points)
    assert field.displacement(inside @ points) == pytest.approx(inside @ u, abs=1e-12)


def test_edges_with_two_nodes_between_their_ends_are_refused_where_they_are_followed(with_entry, tmp_path):
    new = with_entry(cubic)
    assert new.known.element.edges.tolist() == [[0, 1, 3, 4], [1, 2, 5, 6], [2, 0, 7, 8]]
    path = write_vtu_file(tmp_path, new.known)
    results = new.read_element_results(path, elasticity=new.steel)
    with pytest.raises(ValueError, match="edges of CPE10 have 4 nodes"):
        new.boundary_edges(results.points, results.cells)
    with pytest.raises(ValueError, match="elements of type cubic: a plane model of triangle"):
        new.read_displacements(path)
