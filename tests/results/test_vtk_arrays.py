"""Arrays of VTK's files hold the same in every encoding; those that do not fit, or are too large, are named."""

import base64
import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from vtu_file import PACK, SQUARE, file_of

from slmm.mechanics.elasticity import Elasticity
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements
from slmm.results.vtk_arrays import LARGEST

MATERIAL = Elasticity(1e3, 0.3)


@pytest.mark.parametrize("compressor", PACK)
@pytest.mark.parametrize(("form", "in_base64"), [("binary", True), ("appended", True), ("appended", False)])
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("header", ["UInt32", "UInt64"])
def test_every_encoding_holds_the_same(compressor, form, in_base64, order, header, vtu_of):
    path = vtu_of(SQUARE, form, order, header, compressor, in_base64)
    results = read_element_results(path, elasticity=MATERIAL)
    assert results.points.tolist() == [row[:2] for row in SQUARE["Points"][2]]
    assert results.u.tolist() == [row[:2] for row in SQUARE["u"][2]]
    assert results.cells["CPE4"].tolist() == [[0, 1, 2, 3]]


def test_single_precision_and_short_numbers_are_read(vtu_of):
    kinds = {
        "Points": "Float32",
        "u": "Float32",
        "connectivity": "Int32",
        "offsets": "Int32",
        "types": "Int64",
    }
    arrays = {name: (kinds[name], *rest) for name, (_, *rest) in SQUARE.items()}
    assert read_displacements(vtu_of(arrays, "binary")).displacement(np.array([[1.0, 0.5]]))[
        0, 0
    ] == np.float32(1e-3)


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
def test_arrays_that_do_not_fit_are_named(arrays, message, form, vtu_of):
    path = vtu_of(arrays, form, count=(4, 1))
    for read in (read_displacements, lambda path: read_element_results(path, elasticity=MATERIAL)):
        with pytest.raises(ValueError, match=message) as refusal:
            read(path)
        assert str(refusal.value).startswith(f"{path}: ")


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
def test_a_block_that_says_it_is_huge_is_not_decompressed(compressor, header, message, vtu_of):
    text = file_of(SQUARE, "appended", "<", "UInt64", compressor, False)
    at = text.index(b'<AppendedData encoding="raw">_') + 30
    (tmp := vtu_of(SQUARE)).write_bytes(text[:at] + np.array(header, "<u8").tobytes() + text[at + 32 :])
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


def test_a_count_beyond_memory_is_refused(vtu_of):
    path = vtu_of(SQUARE, count=(10**10, 1))
    with pytest.raises(
        ValueError, match=f"array Points: 30000000000 numbers: .* more than {LARGEST >> 30} GB"
    ):
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
