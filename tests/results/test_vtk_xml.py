"""VTK's XML files give the mesh and the data that were put into them, in every form; what is damaged is named."""

import base64
import itertools
import lzma
import re
import zlib
from pathlib import Path

import lz4.block
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_types import ELEMENT_TYPES
from slmm.mechanics.elements import element_named
from slmm.results.mesh_step import mesh_displacements
from slmm.results.plane_elements import PLANE_ELEMENTS
from slmm.results.read_results import read_element_results
from slmm.results.results import FACES, read_displacements
from slmm.results.vtk_arrays import LARGEST
from slmm.results.vtk_cells import CELLS

DATA = Path(__file__).parents[1] / "data"
VTK, CASES = DATA / "vtk", Path(__file__).parents[3] / "shared" / "cases"
MATERIAL = Elasticity(1e3, 0.3)

PACK = {
    "": None,
    "vtkZLibDataCompressor": zlib.compress,
    "vtkLZ4DataCompressor": lambda block: lz4.block.compress(block, store_size=False),
    "vtkLZMADataCompressor": lzma.compress,
}
#: a square and what belongs to it: names, types, numbers
SQUARE = {
    "Points": ("Float64", 3, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
    "connectivity": ("Int64", 1, [0, 1, 2, 3]),
    "offsets": ("Int64", 1, [4]),
    "types": ("UInt8", 1, [9]),
    "u": ("Float64", 3, [[0, 0, 0], [1e-3, 0, 0], [1e-3, 0, 0], [0, 0, 0]]),
}
CODES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt8": "u1"}


def encoded(values, form, order, header, compressor, in_base64, block=16):
    """The bytes of an array as VTK writes them."""
    data = values.astype(values.dtype.newbyteorder(order)).tobytes()
    number = np.dtype({"UInt32": "u4", "UInt64": "u8"}[header]).newbyteorder(order)
    if not compressor:
        head, body = np.array([len(data)], number).tobytes(), data
        return base64.b64encode(head + body) if in_base64 else head + body
    blocks = [data[k : k + block] for k in range(0, len(data), block)]
    packed = [PACK[compressor](own) for own in blocks]
    last = len(data) % block
    head = np.array([len(blocks), block, last, *map(len, packed)], number).tobytes()
    body = b"".join(packed)
    return base64.b64encode(head) + base64.b64encode(body) if in_base64 else head + body


def file_of(
    arrays, form="ascii", order="<", header="UInt32", compressor="", in_base64=True, version="2.2", count=None
):
    """A .vtu file of one piece."""
    appended, texts = b"", {}
    for name, (kind, components, values) in arrays.items():
        values = np.asarray(values, dtype=CODES[kind])
        tag = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="{form}"'
        if form == "ascii":
            texts[name] = f"{tag}>{' '.join(map(repr, values.ravel().tolist()))}</DataArray>"
            continue
        data = encoded(values, form, order, header, compressor, in_base64)
        if form == "binary":
            texts[name] = f"{tag}>\n  {data.decode()}\n</DataArray>"
        else:
            texts[name] = f'{tag} offset="{len(appended)}"/>'
            appended += data
    n, m = count or (len(arrays["Points"][2]), len(arrays["types"][2]))
    end = {"<": "LittleEndian", ">": "BigEndian"}[order]
    packed = f' compressor="{compressor}"' if compressor else ""
    cells = "".join(texts[name] for name in ("connectivity", "offsets", "types"))
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="{version}" byte_order="{end}" '
        f'header_type="{header}"{packed}><UnstructuredGrid><Piece NumberOfPoints="{n}" NumberOfCells="{m}">'
        f"<Points>{texts['Points']}</Points><Cells>{cells}</Cells><PointData>{texts.get('u', '')}</PointData>"
        "</Piece></UnstructuredGrid>"
    ).encode()
    if form == "appended":
        way = "base64" if in_base64 else "raw"
        text += f'<AppendedData encoding="{way}">_'.encode() + appended + b"</AppendedData>"
    return text + b"</VTKFile>"


@pytest.fixture
def written(tmp_path):
    def write(*arguments, **options):
        path = tmp_path / "model.vtu"
        path.write_bytes(file_of(*arguments, **options))
        return path

    return write


# every form


@pytest.mark.parametrize("compressor", PACK)
@pytest.mark.parametrize(("form", "in_base64"), [("binary", True), ("appended", True), ("appended", False)])
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("header", ["UInt32", "UInt64"])
def test_every_encoding_holds_the_same(compressor, form, in_base64, order, header, written):
    path = written(SQUARE, form, order, header, compressor, in_base64)
    results = read_element_results(path, elasticity=MATERIAL)
    assert results.points.tolist() == [row[:2] for row in SQUARE["Points"][2]]
    assert results.u.tolist() == [row[:2] for row in SQUARE["u"][2]]
    assert results.cells["CPE4"].tolist() == [[0, 1, 2, 3]]


@pytest.mark.parametrize("version", ["0.1", "1.0", "2.0", "2.1", "2.2", "2.3"])
def test_every_version_is_read(version, written):
    assert read_displacements(written(SQUARE, version=version)).area() == pytest.approx(1)


def test_single_precision_and_short_numbers_are_read(written):
    kinds = {
        "Points": "Float32",
        "u": "Float32",
        "connectivity": "Int32",
        "offsets": "Int32",
        "types": "Int64",
    }
    arrays = {name: (kinds[name], *rest) for name, (_, *rest) in SQUARE.items()}
    assert read_displacements(written(arrays, "binary")).displacement(np.array([[1.0, 0.5]]))[
        0, 0
    ] == np.float32(1e-3)


@pytest.mark.parametrize(
    "name", sorted(path.name for path in VTK.iterdir() if path.stem not in ("plane_cells", "solid_cells"))
)
def test_files_of_vtk_itself_hold_the_same_mesh(name):
    if re.fullmatch(r"pieces_\d.vtu", name):
        pytest.skip("a part, read with pieces.pvtu")
    results = read_element_results(VTK / name, elasticity=MATERIAL)
    assert len(results.cells["CPE4"]) == 6 and len(results.points) == 12
    expected = 1e-3 * results.points @ np.array([[1.0, 0.2], [-0.4, 0.5]])
    assert results.u == pytest.approx(expected, abs=1e-15)
    assert set(results.region["CPE4"]) == {0, 1}
    x, y = results.points[results.cells["CPE4"]].mean(axis=1).T
    assert np.array_equal(results.region["CPE4"], (3 * (y - 0.5) + x - 0.5) % 2)


# every cell


def field(x, second):
    """The displacements in the files of all cells, see vtk_files.py there."""
    linear = 1e-3 * x @ np.array([[1.0, 0.2, 0.3], [-0.4, 0.5, 0.1], [0.2, -0.3, 0.7]])
    return linear + second * 1e-4 * np.stack([x[:, 0] * x[:, 1], x[:, 1] ** 2, x[:, 2] * x[:, 0]], axis=1)


@pytest.mark.parametrize(("name", "d"), [("plane_cells.vtu", 2), ("solid_cells.vtu", 3)])
def test_cells_of_every_type_have_their_nodes_in_order(name, d):
    """In affine cells, whose nodes VTK itself has placed, displacements of their own degree are exact everywhere."""
    results = read_element_results(VTK / name, elasticity=MATERIAL)
    elements = [known.element for known in ELEMENT_TYPES.values()]
    assert set(results.cells) == {element.name for element in elements if element.dimension == d}
    for kind, nodes in results.cells.items():
        element = element_named(kind)
        second = len(element.nodes) > 8 or (d == 2 and len(element.nodes) in (6, 8))
        at = element.nodes[: element.corners].mean(axis=0) + 0.1 * np.array([0.3, -0.7, 0.5])[:d]
        shape = element.shape(np.stack([at, *element.points]))
        x = np.einsum("qn,enj->eqj", shape, results.points[nodes])
        u = np.einsum("qn,enj->eqj", shape, results.u[nodes])
        x = np.pad(x, ((0, 0), (0, 0), (0, 3 - d))).reshape(-1, 3)
        assert u.reshape(-1, d) == pytest.approx(field(x, second)[:, :d], abs=1e-12), kind


def test_both_commands_read_the_same_elements():
    plane = {kind for kind, known in ELEMENT_TYPES.items() if known.element.dimension == 2}
    assert plane == set(PLANE_ELEMENTS)
    assert set(FACES) < set(ELEMENT_TYPES)
    assert {kind for kind, _ in CELLS.values()} == set(ELEMENT_TYPES)
    plate = read_displacements(VTK / "plane_cells.vtu")
    results = read_element_results(VTK / "plane_cells.vtu", elasticity=MATERIAL)
    assert sum(map(len, plate.cells.values())) == sum(map(len, results.cells.values())) == 10


def test_bricks_of_second_order_had_two_edges_the_other_way_before_version_2_1(tmp_path):
    text = (VTK / "solid_cells.vtu").read_bytes()
    now = mesh_displacements(VTK / "solid_cells.vtu", -1).mesh.cells["hexahedron27"]
    (tmp_path / "former.vtu").write_bytes(re.sub(rb'version="2\.\d"', b'version="2.0"', text, count=1))
    former = mesh_displacements(tmp_path / "former.vtu", -1).mesh.cells["hexahedron27"]
    assert np.array_equal(former[0], now[0])  # no Lagrange cell
    assert np.array_equal(former[1][[18, 19]], now[1][[19, 18]])


@pytest.mark.parametrize(
    ("kind", "name"), [(14, "pyramid"), (77, "Bezier quadrilateral"), (34, "biquadratic")]
)
def test_cells_that_are_not_read_are_named(kind, name, written):
    with pytest.raises(ValueError, match=f"cell 0 is a {name}.*VTK's type {kind}"):
        read_displacements(written(SQUARE | {"types": ("UInt8", 1, [kind])}))


# pieces


def test_all_pieces_of_a_file_are_one_mesh():
    results = read_element_results(CASES / "03-vtu-two-pieces" / "two.vtu", elasticity=MATERIAL)
    assert len(results.points) == 6 and len(results.cells["CPE4"]) == 2
    assert results.stress["CPE4"][..., 0, 0] == pytest.approx(
        np.full((2, 4), MATERIAL.stress(np.diag([1e-3, 0]))[0, 0])
    )


def test_a_piece_may_be_empty(tmp_path):
    text = file_of(SQUARE).decode()
    empty = '<Piece NumberOfPoints="0" NumberOfCells="0"><Points><DataArray type="Float32" NumberOfComponents="3"/>'
    empty += "</Points><Cells>" + "".join(
        f'<DataArray type="Int64" Name="{name}"/>' for name in ("connectivity", "offsets", "types")
    )
    (tmp_path / "two.vtu").write_text(text.replace("<Piece", empty + "</Cells></Piece><Piece", 1))
    assert read_displacements(tmp_path / "two.vtu").area() == pytest.approx(1)


# damage


def changed(name, values=None, kind=None):
    old = SQUARE[name]
    return SQUARE | {name: (kind or old[0], old[1], old[2] if values is None else values)}


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (
            changed("connectivity", [0, 1, 2, 4]),
            "connectivity: cell 0 names node 4: nodes are numbered from 0 to 3",
        ),
        (changed("connectivity", [0, 1, -2, 3]), "connectivity: cell 0 names node -2"),
        (changed("connectivity", [0, 1, 2]), "array connectivity: has"),
        (changed("connectivity", [0, 1, 2, 3, 3]), "array connectivity: has"),
        (changed("connectivity", [0.0, 1, 2, 3], "Float64"), "array connectivity: must hold whole numbers"),
        (changed("offsets", [-4]), "array offsets: cell 0 ends at -4, before it begins"),
        (changed("offsets", [2**60]), "array connectivity: "),
        (changed("types", [9, 9]), "array types|array offsets"),
        (changed("u", [[0, 0, 0]] * 3), "array u: has"),
        (changed("Points", [[0, 0, 0]] * 5), "array Points: has|array u"),
    ],
)
@pytest.mark.parametrize("form", ["ascii", "binary"])
def test_arrays_that_do_not_fit_are_named(arrays, message, form, written):
    path = written(arrays, form, count=(4, 1))
    for read in (read_displacements, lambda path: read_element_results(path, elasticity=MATERIAL)):
        with pytest.raises(ValueError, match=message) as refusal:
            read(path)
        assert str(refusal.value).startswith(f"{path}: ")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("m.vtu", "cell 0 names node 99"),
        ("m_negative.vtu", "cell 0 names node -3"),
        ("m_offsets.vtu", "cell 1 ends at 4, before it begins"),
        ("m_type999.vtu", "VTK's type 999"),
    ],
)
def test_the_numbers_that_passed_are_refused(name, message):
    path = CASES / "r05-vtu-index-out-of-range" / name
    for read in (read_displacements, lambda path: read_element_results(path, elasticity=MATERIAL)):
        with pytest.raises(ValueError, match=message):
            read(path)


@pytest.mark.parametrize("compressor", [name for name in PACK if name])
@pytest.mark.parametrize(
    ("header", "message"),
    [
        ([2**31, 16, 0, 5], "compressed blocks"),
        ([1, 2**40, 0, 5], "after decompression"),
        ([1, 96, 96, 10**12], "is cut off"),
        ([2, 0, 96, 0, 60], "after decompression"),
    ],
)
def test_a_block_that_says_it_is_huge_is_not_decompressed(compressor, header, message, written):
    text = file_of(SQUARE, "appended", "<", "UInt64", compressor, False)
    at = text.index(b'<AppendedData encoding="raw">_') + 30
    (tmp := written(SQUARE)).write_bytes(text[:at] + np.array(header, "<u8").tobytes() + text[at + 32 :])
    with pytest.raises(ValueError, match=f"array Points: .*{message}"):
        read_displacements(tmp)


def bomb(compressor, true_size, told):
    """A square whose points are a block that unpacks to more than its header tells."""
    packed = PACK[compressor](bytes(true_size))
    head = np.array([1, told, told, len(packed)], "<u4").tobytes()
    data = base64.b64encode(head) + base64.b64encode(packed)
    text = file_of(SQUARE, "ascii", compressor=compressor).decode()
    start = text.index('format="ascii"')
    end = text.index("</DataArray>", start)
    return text[:start] + f'format="binary">{data.decode()}' + text[end:]


@pytest.mark.parametrize("compressor", [name for name in PACK if name])
def test_a_block_that_unpacks_to_more_than_it_says_is_refused(compressor, tmp_path):
    (tmp_path / "bomb.vtu").write_text(bomb(compressor, 200_000_000, 96))
    with pytest.raises(ValueError, match=r"array Points: .*(decompressed|96 bytes)"):
        read_displacements(tmp_path / "bomb.vtu")


def test_a_count_beyond_memory_is_refused(written):
    path = written(SQUARE, count=(10**10, 1))
    with pytest.raises(
        ValueError, match=f"array Points: 30000000000 numbers: .* more than {LARGEST >> 30} GB"
    ):
        read_displacements(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('type="UnstructuredGrid"', 'type="PolyData"', "polygons of surfaces"),
        ('type="UnstructuredGrid"', 'type="ImageData"', "holds an image"),
        ('version="2.2"', 'version="3.0"', "version '3.0'"),
        ('byte_order="LittleEndian"', 'byte_order="Middle"', "byte_order = 'Middle'"),
        ('header_type="UInt32"', 'header_type="Int8"', "header_type = 'Int8'"),
        ('header_type="UInt32"', 'header_type="UInt32" compressor="vtkBzip2"', "compressor = 'vtkBzip2'"),
        ("<VTKFile", "<!DOCTYPE x [<!ENTITY a 'b'>]><VTKFile", "document type"),
        ("</Cells>", "", "no XML"),
        ('Name="types"', 'Name="kinds"', "array types is missing"),
        ('NumberOfPoints="4"', 'NumberOfPoints="-4"', "NumberOfPoints = '-4'"),
        ('NumberOfPoints="4"', 'NumberOfPoints="' + 5000 * "4" + '"', "NumberOfPoints = '4444"),
        ("0 1 2 3<", "0 1 two 3<", "array connectivity: has a word that is no number of type Int64"),
        (">9<", ">900<", "array types: has a word that is no number of type UInt8"),
        (
            '<DataArray type="Float64" Name="u"',
            '<DataArray TimeStep="0" type="Float64" Name="u"',
            "several time steps",
        ),
        ('Name="u" NumberOfComponents="3"', 'Name="u" NumberOfComponents="0"', "NumberOfComponents = 0"),
    ],
)
def test_what_a_file_says_of_itself_is_checked(old, new, message, written):
    path = written(SQUARE)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ValueError, match=message) as refusal:
        read_displacements(path)
    assert len(str(refusal.value)) < 500


def test_elements_within_each_other_have_an_end(written):
    path = written(SQUARE)
    path.write_text("<VTKFile>" + 200_000 * "<a>")
    with pytest.raises(ValueError, match="within each other more than 50 times"):
        read_displacements(path)


@given(data=st.data())
@pytest.mark.parametrize(
    ("form", "compressor", "in_base64"),
    list(itertools.product(["binary"], PACK, [True])) + list(itertools.product(["appended"], PACK, [False])),
)
def test_damaged_bytes_are_refused_or_are_another_mesh(form, compressor, in_base64, data, tmp_path_factory):
    text = bytearray(file_of(SQUARE, form, "<", "UInt32", compressor, in_base64))
    for _ in range(data.draw(st.integers(1, 3))):
        text[data.draw(st.integers(0, len(text) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.getbasetemp() / "damaged.vtu"
    path.write_bytes(bytes(text[: data.draw(st.integers(len(text) - 300, len(text)))]))
    try:
        read_displacements(path)
    except ValueError as error:
        assert str(error).startswith(f"{path}: ")
